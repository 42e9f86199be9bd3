// A flipbook: the slider turns pages that were drawn before. Needs theme.js before it.

/** Pages as they came, with their bytes where they belong: [[[model, state], …], …]. */
async function readPages(manager, { pages }, buffers) {
  const ids = Object.keys(pages[0] ?? {});
  const models = new Map(await Promise.all(ids.map(async (id) => [id, await manager.get_model(id)])));
  const whole = (value) => (value?.buffer === undefined ? value : buffers[value.buffer]);
  return pages.map((page) => Object.entries(page).map(([id, state]) => [
    models.get(id),
    Object.fromEntries(Object.entries(state).map(([name, value]) => [name, whole(value)])),
  ]));
}

export default {
  initialize({ model }) {
    const manager = model.widget_manager;
    let pages = [];
    let slider = null;
    // As if Python had said so: nothing is to be told to it.
    const turn = () => pages[slider?.get("value")]?.forEach(([shown, state]) => shown.set_state(state));
    const read = async (content, buffers) => {
      if (!content.pages) return;
      pages = await readPages(manager, content, buffers);
      turn();
    };
    model.on("msg:custom", read);
    manager.get_model(model.get("slider")).then((found) => {
      slider = found;
      slider.on("change:value", turn);
      model.send({ type: "open" });
    });
    return () => {
      model.off("msg:custom", read);
      slider?.off("change:value", turn);
    };
  },

  render({ model, el }) {
    const words = element("span", { class: "pf-readout" });
    makeRoot(el, "flipbook", "What is shown").append(words);
    const show = () => { words.textContent = model.get("words"); };
    show();
    return onTraits(model, ["words"], show);
  },
};
