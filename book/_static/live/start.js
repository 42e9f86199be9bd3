// Bring a page to life: read the stored state, build every view, say what needs a kernel.

{
  const { element } = Live;
  const imported = new Map();

  /** A widget's own ES module, the same that runs in JupyterLab. */
  function load(code) {
    if (!imported.has(code)) {
      const address = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
      imported.set(code, import(address));
    }
    return imported.get(code);
  }

  const styled = new Set();
  function addStyle(css) {
    if (!css || styled.has(css)) return;
    styled.add(css);
    document.head.append(element("style", {}, css));
  }

  function anywidget(model) {
    const el = element("div", { class: "live-anywidget" });
    const source = (name) => Live.modules[model.get(name)?.module] ?? model.get(name);
    addStyle(source("_css"));
    load(source("_esm")).then(async ({ default: exported }) => {
      const widget = typeof exported === "function" ? await exported() : exported;
      await widget.initialize?.({ model });
      await widget.render?.({ model, el });
    }).catch((error) => {
      el.append(element("p", { class: "live-note live-failed" }, `This widget could not start: ${error.message}`));
      console.error(error);
    });
    return el;
  }

  /** ipywidgets' layout, for example {flex_flow: "row wrap", width: "240px"}, as CSS. */
  function lay(node, layout) {
    for (const [name, value] of Object.entries(layout?.state ?? {})) {
      if (!name.startsWith("_") && value !== null) node.style.setProperty(name.replaceAll("_", "-"), value);
    }
  }

  Live.view = (model) => {
    const make = "figure" in model.state ? Live.figureView
      : Live.controls[model.name] ?? (model.get("_esm") ? anywidget : unknown);
    const node = make(model);
    node.dataset.model = model.id;
    lay(node, model.linked(model.get("layout")));
    return node;
  };

  function unknown(model) {
    console.error(`the book has no ${model.name}: add it to book/_static/live/controls.js`);
    return element("p", { class: "live-note live-failed" }, `This page cannot show a ${model.name}; run the notebook.`);
  }

  /** The models of a view, from the outermost inwards. */
  function family(model) {
    return [model, ...(model.get("children") ?? []).flatMap((child) => family(model.linked(child)))];
  }

  /** One line beside a view whose controls called Python. */
  function note(model) {
    const all = family(model);
    const silent = all.filter((each) => Live.records.isSilent(each));
    const recorded = all.some((each) => Live.records.recordings.some(({ control }) => control === each.id));
    const words = [];
    if (recorded) words.push("No Python runs in this page: it plays back answers recorded when the book was built, one control at a time.");
    if (silent.length) words.push(`${silentNames(silent)} need${silent.length === 1 ? "s" : ""} Python, which does not run in this page.`);
    if (all.some(lacksPlaces)) words.push("Greyed entries of a menu were not recorded.");
    if (!words.length) return [];
    const link = element("a", { href: Live.runningPage }, "Run the notebook");
    return [element("p", { class: "live-note" }, `${words.join(" ")} `, link, " for everything.")];
  }

  /** Were only some entries of a menu recorded? */
  function lacksPlaces(model) {
    const labels = model.get("_options_labels");
    const recorded = labels && Live.records.stopsOf(model.id, "index");
    return Boolean(recorded) && recorded.length < labels.length;
  }

  function silentNames(models) {
    const named = (model) => model.get("description") || (model.get("path_data") !== undefined ? "drawing"
      : model.get("fps") !== undefined ? "what follows the viewer" : "dragging");
    const names = models.map(named);
    const unique = [...new Set(names)].map((name) => `“${name}”`);
    return unique.length > 1 ? `${unique.slice(0, -1).join(", ")} and ${unique.at(-1)}` : unique[0];
  }

  const read = (selector) => {
    const node = document.querySelector(selector);
    return node ? JSON.parse(node.textContent) : null;
  };

  function start() {
    const here = document.documentElement.dataset.content_root ?? "./";
    Live.runningPage = `${here}running.html`;
    Live.readModels(read('script[type="application/vnd.jupyter.widget-state+json"]') ?? { state: {} });
    Live.records = new Live.Records(read("script.live-records") ?? {});
    Live.records.begin();
    for (const model of Live.models.values()) if (/^(Directional)?LinkModel$/.test(model.name)) Live.link(model);
    for (const place of document.querySelectorAll('script[type="application/vnd.jupyter.widget-view+json"]')) {
      const model = Live.models.get(JSON.parse(place.textContent).model_id);
      if (model) place.after(element("div", { class: "live-view" }, Live.view(model), ...note(model)));
    }
    for (const place of document.querySelectorAll("script.live-figure")) {
      Live.drawFigure(place.parentElement, JSON.parse(place.textContent));
    }
    document.documentElement.dataset.live = Live.models.size;
  }

  if (document.readyState === "loading") addEventListener("DOMContentLoaded", start);
  else start();
}
