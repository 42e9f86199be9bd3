// The board: a picture in a plane, and handles to drag on it. Needs theme.js, board_axes.js and
// board_layers.js before it. Python owns where handles are; the page says where they were dragged.

const BOARD_ROLES = ["data", "noise", "wish", "prediction", "projected", "flow", "quiet"];
// Milliseconds between two messages while a handle is dragged. No line forms before a busy Python:
// ipywidgets keeps back all but the newest until the last one was answered.
const SEND_EVERY = 16;

function buildBoard(root, model) {
  const title = element("span", { class: "pf-board-title" });
  const legend = element("span", { class: "pf-board-legend" });
  const canvas = element("canvas", { role: "img" });
  const stage = element("div", { class: "pf-stage" }, canvas);
  stage.style.height = `${model.get("height")}px`;
  const problem = element("div", { class: "pf-board-problem", role: "alert" });
  const spoken = element("span", { class: "pf-hidden", "aria-live": "polite" });
  root.append(element("div", { class: "pf-board-head" }, title, legend), stage, problem, spoken);
  return { root, title, legend, canvas, stage, problem, spoken };
}

class BoardView {
  constructor(model, el) {
    this.model = model;
    this.ui = buildBoard(makeRoot(el, "board", "Board"), model);
    this.ctx = context2d(this.ui.canvas);
    this.handles = new Map(); // name → { at, node, … }
    this.unseen = new Map(); // name → [x, y, count]: dragged here, not yet heard by Python
    this.pictures = 0;
    this.stops = [
      onTraits(model, ["layers", "data", "title", "labels", "x", "y", "equal"], () => this.readLayers()),
      onTraits(model, ["handles", "seen"], () => this.readHandles()),
      onTraits(model, ["drag"], () => this.readDrag()),
      onTraits(model, ["problem"], () => this.readProblem()),
      watchTheme(() => this.recolour()),
      fitCanvas(this.ui.canvas, (width, height, ratio) => {
        this.size = { width, height, ratio };
        this.recolour();
        this.draw(); // at once: a resized canvas is blank
      }),
    ];
    this.readLayers();
    this.readHandles();
    this.readProblem();
  }

  stop() {
    this.stopped = true;
    if (this.timer) this.flush();
    cancelAnimationFrame(this.request);
    clearTimeout(this.speaking);
    this.stops.forEach((stop) => stop());
    this.handles.forEach(({ node }) => node.remove());
  }

  recolour() {
    this.palette = readPalette(this.ui.root);
    const style = getComputedStyle(this.ui.root); // after readPalette, which tells light from dark
    for (const role of BOARD_ROLES) this.palette[role] = style.getPropertyValue(`--pf-role-${role}`).trim();
    this.redraw();
  }

  readLayers() {
    const { model, ui } = this;
    this.layers = model.get("layers");
    this.values = floats(model.get("data"));
    const labelled = this.layers.filter(({ label }) => label);
    const legend = JSON.stringify(labelled.map(({ label, color, kind, dash }) => [label, color, kind, dash]));
    if (legend !== this.legend) {
      this.legend = legend;
      ui.legend.replaceChildren(...labelled.map(boardKey));
    }
    const title = model.get("title");
    if (ui.title.textContent !== title) ui.title.textContent = title;
    const shown = labelled.map(({ label }) => label).join(", ");
    const told = `${title || "Plane"}, axes ${model.get("labels").join(" and ")}. ${shown && `Shown: ${shown}.`}`;
    if (ui.canvas.getAttribute("aria-label") !== told) ui.canvas.setAttribute("aria-label", told);
    this.redraw();
  }

  readProblem() {
    this.ui.problem.textContent = this.model.get("problem");
  }

  /** Python's places win, except where a hand here is ahead of it. */
  readHandles() {
    const seen = this.model.get("seen");
    for (const [name, [, , count]] of this.unseen) if (count <= seen) this.unseen.delete(name);
    const wanted = this.model.get("handles");
    const names = new Set(wanted.map(({ name }) => name));
    for (const [name, { node }] of this.handles) {
      if (names.has(name)) continue;
      node.remove();
      this.handles.delete(name);
      this.unseen.delete(name);
    }
    for (const state of wanted) {
      const handle = this.handles.get(state.name) ?? this.addHandle(state.name);
      const ahead = this.unseen.has(state.name) && !state.led;
      Object.assign(handle, state, ahead ? { at: handle.at } : {});
      this.showHandle(handle);
    }
  }

  /** Another view of the same model moved a handle. */
  readDrag() {
    for (const [name, [x, y, count]] of Object.entries(this.model.get("drag").moves ?? {})) {
      const handle = this.handles.get(name);
      if (!handle || handle.held || count <= this.model.get("seen")) continue;
      this.unseen.set(name, [x, y, count]);
      handle.at = [x, y];
      this.showHandle(handle);
    }
  }

  addHandle(name) {
    const label = element("span", { class: "pf-handle-label" });
    const node = element("button", { type: "button", class: "pf-handle", "data-name": name }, label);
    const handle = { name, node, label_node: label };
    listenToHandle(this, handle);
    this.ui.stage.append(node);
    this.handles.set(name, handle);
    return handle;
  }

  showHandle(handle) {
    if (!this.map) return;
    const { node, at, along, label } = handle;
    const inside = this.map.clamp(at);
    const [px, py] = this.map.toPixels(...inside);
    // What is written again, even if it is the same, is laid out again.
    const { map, size, model } = this;
    const state = JSON.stringify([px, py, at, along, label, handle.color, map, size.width, model.get("labels")]);
    if (state === handle.shown) return;
    handle.shown = state;
    node.style.transform = `translate(${px}px, ${py}px)`;
    node.style.setProperty("--key", `var(--pf-role-${handle.color})`);
    node.classList.toggle("pf-outside", inside[0] !== at[0] || inside[1] !== at[1]);
    node.classList.toggle("pf-leftwards", px > this.size.width - 70);
    node.dataset.along = along ?? "";
    handle.label_node.textContent = label;
    describeHandle(handle, this.map, this.model.get("labels"));
  }

  /** A hand or a key wants a handle at a place. Python may decide on another one. */
  moveHandle(handle, wanted) {
    const [x, y] = this.map.clamp(wanted);
    const at = [handle.along === "y" ? handle.at[0] : x, handle.along === "x" ? handle.at[1] : y];
    this.count = Math.max(this.count ?? 0, this.model.get("seen"), ...[...this.unseen.values()].map((move) => move[2])) + 1;
    this.unseen.set(handle.name, [...at, this.count]);
    if (!handle.led) handle.at = at;
    this.showHandle(handle);
    if (this.timer) return;
    const wait = SEND_EVERY - (performance.now() - (this.sentAt ?? -Infinity));
    if (wait <= 0) this.flush();
    else this.timer = setTimeout(() => this.flush(), wait);
  }

  /** Send all that Python has not heard: a message that waits is replaced by the next one. */
  flush() {
    clearTimeout(this.timer);
    this.timer = 0;
    this.sentAt = performance.now();
    this.model.set("drag", { moves: Object.fromEntries(this.unseen) });
    this.model.save_changes();
  }

  /** For a screen reader, once a handle rests. */
  speak(handle) {
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      this.ui.spoken.textContent = `${handle.label}: ${handle.where}`;
    }, 400);
  }

  redraw() {
    if (this.request || this.stopped) return;
    this.request = requestAnimationFrame(() => this.draw());
  }

  draw() {
    cancelAnimationFrame(this.request);
    this.request = 0;
    if (!this.size || this.stopped) return;
    const { ctx, model, palette, size } = this;
    this.map = new BoardMap(model.get("x"), model.get("y"), model.get("equal"), size.width, size.height);
    ctx.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    ctx.fillStyle = palette.paper;
    ctx.fillRect(0, 0, size.width, size.height);
    drawAxes(ctx, this.map, palette, model.get("labels"));
    drawLayers(ctx, this.map, palette, this.layers, this.values);
    this.handles.forEach((handle) => this.showHandle(handle));
    this.ui.root.dataset.pictures = ++this.pictures;
  }
}

/** What a screen reader says of a handle. One that moves along an axis is a slider. */
function describeHandle(handle, map, labels) {
  const { node, at, along, label } = handle;
  const steps = map.steps();
  const number = (axis) => boardNumber(at[axis], steps[axis] / 100);
  handle.where = along === "x" || along === "y"
    ? `${labels["xy".indexOf(along)]} ${number("xy".indexOf(along))}`
    : `${labels[0]} ${number(0)}, ${labels[1]} ${number(1)}`;
  if (along) {
    const axis = "xy".indexOf(along);
    const [low, high] = axis ? [map.low, map.high] : [map.left, map.right];
    const value = { role: "slider", "aria-label": label, "aria-valuenow": at[axis], "aria-valuemin": low,
      "aria-valuemax": high, "aria-valuetext": handle.where, "aria-orientation": axis ? "vertical" : "horizontal" };
    for (const [name, text] of Object.entries(value)) node.setAttribute(name, text);
  } else {
    node.setAttribute("aria-roledescription", "point to drag");
    node.setAttribute("aria-label", `${label}: ${handle.where}. Arrow keys move it.`);
  }
}

/** Mouse, touch and keys of one handle. They end with the handle: all listeners are its own. */
function listenToHandle(view, handle) {
  const { node } = handle;
  let grip = null; // from the pointer to the middle of the handle, so that it does not jump
  const place = (event) => {
    const box = view.ui.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  node.addEventListener("pointerdown", (event) => {
    if (event.button > 0) return;
    node.setPointerCapture(event.pointerId);
    node.focus({ preventScroll: true });
    event.preventDefault();
    const [px, py] = place(event);
    const [x, y] = view.map.toPixels(...view.map.clamp(handle.at));
    grip = [x - px, y - py];
    Object.assign(handle, { held: true, led: false });
    node.classList.add("pf-held");
  });
  node.addEventListener("pointermove", (event) => {
    if (!grip) return;
    const [px, py] = place(event);
    view.moveHandle(handle, view.map.toPlane(px + grip[0], py + grip[1]));
  });
  const release = () => {
    if (!grip) return;
    grip = null;
    handle.held = false;
    node.classList.remove("pf-held");
    view.speak(handle);
  };
  node.addEventListener("pointerup", release);
  node.addEventListener("pointercancel", release);
  const keys = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  node.addEventListener("keydown", (event) => {
    if (!(event.key in keys) || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const size = event.shiftKey ? 1 : 0.1;
    const shift = view.map.steps().map((step, axis) => step * size * keys[event.key][axis]);
    view.moveHandle(handle, [handle.at[0] + shift[0], handle.at[1] + shift[1]]);
    view.speak(handle);
  });
}

export default {
  render: guarded("board", ({ model, el }) => {
    const view = new BoardView(model, el);
    return () => view.stop();
  }),
};
