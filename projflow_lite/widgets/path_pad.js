// The path pad: draw a path in a metric plane. Needs theme.js, curve.js and plane.js before it.
// A stroke is what the hand drew; the path is the stroke smoothed and resampled. Only the path is
// a trait: `path_data` holds it, `version` counts the strokes that were finished.

const MODES = {
  draw: "Draw a new path",
  move: "Drag the whole path",
  bend: "Pull the nearest point of the path",
};
const PAD_ICONS = {
  undo: "M6.5 2.5 2 6.5l4.5 4V8H10a2.5 2.5 0 0 1 0 5H6v1.8h4a4.3 4.3 0 0 0 0-8.6H6.5z",
  clear: "M6 1.5h4l.7 1.2H14v1.6H2V2.7h3.3zM3 5.5h10l-.8 9H3.8zm3 1.6.3 5.8h1L7 7.1zm3 0-.3 5.8h1l.3-5.8z",
};
const NUDGE = 0.01; // metres an arrow key moves the path

function buildPad(root, view) {
  const canvas = element("canvas", { tabindex: 0, role: "application", "aria-roledescription": "drawing area" });
  const hint = element("p", { class: "pf-note pf-hint" });
  const facts = element("span", { class: "pf-legend pf-readout" });
  const stage = element("div", { class: "pf-stage" }, canvas, hint, facts);
  const modes = Object.entries(MODES).map(([mode, title]) =>
    button(mode[0].toUpperCase() + mode.slice(1), () => view.setMode(mode), { title }));
  const preset = element("select", {
    "aria-label": "Preset shape", class: "pf-preset", title: "Start from a shape",
    onchange: () => view.usePreset(preset.value),
  }, element("option", { value: "" }, "Shape…"), ...Object.keys(PRESETS).map((name) => element("option", {}, name)));
  const undo = button("Undo", () => view.undo(), { title: "Undo (Ctrl+Z)", icon: PAD_ICONS.undo });
  const clear = button("Clear", () => view.clear(), { title: "Clear (Delete)", icon: PAD_ICONS.clear });
  const smoothing = element("input", {
    type: "range", min: 0, max: 0.2, step: 0.005, "aria-label": "Smoothing in metres",
    oninput: () => view.setSmoothing(+smoothing.value, false), onchange: () => view.setSmoothing(+smoothing.value, true),
  });
  const timing = element("select", {
    "aria-label": "Timing along the path", title: "How time runs along the path",
    onchange: () => view.setTiming(timing.value),
  }, element("option", { value: "even" }, "even speed"), element("option", { value: "drawn" }, "as drawn"));
  const spoken = element("span", { class: "pf-hidden", "aria-live": "polite" });
  root.append(stage,
    element("div", { class: "pf-bar pf-open" },
      element("span", { class: "pf-group", role: "group", "aria-label": "Mouse" }, ...modes),
      preset, element("span", { class: "pf-group pf-last" }, undo, clear)),
    element("div", { class: "pf-bar" },
      element("label", { class: "pf-wide" }, "Smooth", smoothing), timing),
    spoken);
  return { root, stage, canvas, hint, modes, preset, undo, clear, smoothing, timing, facts, spoken };
}

class PadView {
  constructor(model, el) {
    this.model = model;
    this.mode = "draw";
    this.stroke = { points: [], times: [] };
    this.history = [];
    this.ui = buildPad(makeRoot(el, "pad", "Path pad"), this);
    this.ctx = context2d(this.ui.canvas);
    this.ui.stage.style.height = `${model.get("height")}px`;
    this.stops = [
      onTraits(model, ["path_data"], () => this.readPath()),
      onTraits(model, ["plane", "bounds", "reference", "joint_path", "joint_name", "smoothing", "timing", "samples"],
        () => this.refresh()),
      watchTheme(() => this.refresh()),
      fitCanvas(this.ui.canvas, (width, height, ratio) => {
        this.size = { width, height, ratio };
        this.refresh(); // reads the colours too: outside the page there are no styles
      }),
      listenToPen(this),
      listenToPadKeys(this),
    ];
    this.readPath();
  }

  stop() {
    clearTimeout(this.committing);
    this.stops.forEach((stop) => stop());
  }

  /** The path as the kernel has it, unless it is the one that this page sent. */
  readPath() {
    const values = floats(this.model.get("path_data"));
    if (this.sent && values.length === this.sent.length && values.every((v, i) => v === this.sent[i])) return;
    this.sent = values;
    const points = [];
    for (let i = 0; i + 1 < values.length; i += 2) points.push([values[i], values[i + 1]]);
    this.stroke = { points, times: points.map((_, i) => i) };
    this.fixed = points; // shown as it is: the kernel's points are not smoothed again
    if (!points.length) this.history = [];
    this.refresh();
  }

  refresh() {
    const { model, ui } = this;
    if (this.size) this.palette = readPalette(ui.root);
    ui.smoothing.value = model.get("smoothing");
    ui.timing.value = model.get("timing");
    this.setMode(this.mode);
    this.draw();
  }

  map() {
    return new PlaneMap(this.model.get("plane"), this.model.get("bounds"), this.size.width, this.size.height);
  }

  options() {
    const { model } = this;
    return { samples: model.get("samples"), smoothing: model.get("smoothing"), timing: model.get("timing") };
  }

  path() {
    return this.fixed ?? shapeStroke(this.stroke, this.options());
  }

  setMode(mode) {
    this.mode = mode;
    Object.keys(MODES).forEach((name, i) => this.ui.modes[i].setAttribute("aria-pressed", name === mode));
    this.ui.canvas.style.cursor = mode === "draw" ? "crosshair" : "move";
  }

  /** Remember the stroke as it is, for undo. */
  remember() {
    this.history.push({ stroke: this.stroke, fixed: this.fixed });
    if (this.history.length > 50) this.history.shift();
  }

  change(stroke) {
    this.stroke = stroke;
    this.fixed = null;
    this.draw();
  }

  /** Tell the kernel: a finished path raises `version`, an unfinished one only shows it live. */
  commit(finished = true) {
    clearTimeout(this.committing);
    const values = Float32Array.from(this.path().flat());
    this.sent = values;
    this.model.set("path_data", new DataView(values.buffer));
    if (finished) this.model.set("version", this.model.get("version") + 1);
    this.model.save_changes();
    if (finished) this.ui.spoken.textContent = `Path: ${this.ui.facts.textContent}`;
  }

  /** For keys that repeat: count the change as finished once they rest. */
  commitSoon() {
    clearTimeout(this.committing);
    this.committing = setTimeout(() => this.commit(), 350);
  }

  undo() {
    const last = this.history.pop();
    if (!last) return;
    Object.assign(this, last);
    this.draw();
    this.commit();
  }

  clear() {
    if (!this.stroke.points.length) return;
    this.remember();
    this.change({ points: [], times: [] });
    this.commit();
  }

  usePreset(name) {
    this.ui.preset.value = "";
    if (!name) return;
    const [uLow, uHigh, vLow, vHigh] = this.model.get("bounds");
    const start = this.model.get("joint_path")[0] ?? [(uLow + uHigh) / 2, (vLow + vHigh) / 2];
    const radius = 0.15 * Math.min(uHigh - uLow, vHigh - vLow);
    const hold = (value, low, high) => Math.min(high - 1.1 * radius, Math.max(low + 1.1 * radius, value));
    this.remember();
    this.change(presetStroke(name, [hold(start[0], uLow, uHigh), hold(start[1], vLow, vHigh)], radius));
    this.commit();
  }

  setSmoothing(metres, finished) {
    this.model.set("smoothing", metres);
    this.reshape(finished);
  }

  setTiming(timing) {
    this.model.set("timing", timing);
    this.reshape(true);
  }

  reshape(finished) {
    if (!this.stroke.points.length) return this.model.save_changes();
    this.fixed = null;
    this.draw();
    if (finished || this.model.get("live")) this.commit(finished);
    return undefined;
  }

  draw() {
    if (!this.size) return;
    const { ctx, palette, model, size, ui } = this;
    const map = this.map();
    ctx.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    ctx.fillStyle = palette.paper;
    ctx.fillRect(0, 0, size.width, size.height);
    drawPlane(ctx, map, palette, model.get("plane"));
    ctx.save();
    ctx.beginPath();
    ctx.rect(map.frame.x, map.frame.y, map.frame.width, map.frame.height);
    ctx.clip();
    const behind = { lines: model.get("reference"), jointPath: model.get("joint_path"), name: model.get("joint_name") };
    drawReference(ctx, map, palette, behind);
    ctx.restore();
    const path = this.path();
    if (path.length) drawPath(ctx, map, palette, path, this.fixed ? [] : this.stroke.points);
    this.showFacts(path);
    ui.undo.disabled = !this.history.length;
    ui.clear.disabled = !path.length;
  }

  showFacts(path) {
    const { ui, model } = this;
    const plane = PLANES[model.get("plane")];
    ui.hint.textContent = path.length ? "" : "Press here and draw a path";
    ui.facts.textContent = path.length
      ? `${arcLength(path).at(-1).toFixed(2)} m · ${path.length} points`
      : "no path yet";
    ui.canvas.setAttribute("aria-label",
      `${plane.title}, axes ${plane.axes.join(" and ")} in metres. ${ui.facts.textContent}. ` +
      "Choose a shape from the list below, or draw with the mouse; arrow keys move the path by 1 cm.");
  }
}

/** Mouse and touch: a stroke from pointer down to pointer up. */
function listenToPen(view) {
  const { canvas } = view.ui;
  let action = null;
  let lastLive = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    const map = view.map();
    return map.toMetres(map.clamp([event.clientX - box.left, event.clientY - box.top]));
  };
  const listeners = {
    pointerdown(event) {
      if (event.isPrimary === false || event.button > 0) return;
      const at = place(event);
      const has = view.stroke.points.length > 0;
      if (view.mode !== "draw" && !has) return;
      canvas.setPointerCapture(event.pointerId);
      view.remember();
      action = { from: at, stroke: view.stroke, index: has ? nearestPoint(view.stroke.points, at) : 0 };
      if (view.mode === "draw") view.change({ points: [at], times: [event.timeStamp] });
    },
    pointermove(event) {
      if (!action) return;
      if (view.mode === "draw") {
        const steps = event.getCoalescedEvents?.() ?? [];
        const { points, times } = view.stroke;
        for (const step of steps.length ? steps : [event]) {
          points.push(place(step));
          times.push(step.timeStamp);
        }
        view.change({ points, times });
      } else {
        const at = place(event);
        const shift = [at[0] - action.from[0], at[1] - action.from[1]];
        const reach = 0.15 * arcLength(action.stroke.points).at(-1);
        view.change(view.mode === "move"
          ? moveStroke(action.stroke, shift)
          : bendStroke(action.stroke, action.index, shift, reach || 1));
      }
      if (view.model.get("live") && event.timeStamp - lastLive > 80) {
        lastLive = event.timeStamp;
        view.commit(false);
      }
    },
    pointerup(event) {
      if (!action) return;
      if (view.mode === "draw") listeners.pointermove(event);
      action = null;
      view.commit();
    },
    pointercancel() {
      if (!action) return;
      Object.assign(view, view.history.pop());
      action = null;
      view.draw();
    },
  };
  const entries = Object.entries(listeners);
  entries.forEach(([name, listener]) => canvas.addEventListener(name, listener));
  return () => entries.forEach(([name, listener]) => canvas.removeEventListener(name, listener));
}

/** Arrows move the path by 1 cm (shift: 10 cm) on the page; Delete clears; Ctrl+Z undoes. */
function listenToPadKeys(view) {
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const listener = (event) => {
    if (event.target !== view.ui.canvas) return;
    const undo = event.key.toLowerCase() === "z" && (event.ctrlKey || event.metaKey);
    const erase = event.key === "Delete" || event.key === "Backspace";
    if (!undo && !erase && !(event.key in steps)) return;
    event.preventDefault();
    if (undo) return view.undo();
    if (erase) return view.clear();
    if (!view.stroke.points.length) return undefined;
    const size = NUDGE * (event.shiftKey ? 10 : 1);
    const [du, dv] = steps[event.key];
    if (!event.repeat) view.remember();
    view.change(moveStroke(view.stroke, [du * size * view.map().sign, dv * size]));
    view.commitSoon();
    return undefined;
  };
  view.ui.root.addEventListener("keydown", listener);
  return () => view.ui.root.removeEventListener("keydown", listener);
}

export default {
  render: guarded("path pad", ({ model, el }) => {
    const view = new PadView(model, el);
    return () => view.stop();
  }),
};
