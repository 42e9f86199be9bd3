// The metric explorer: one body, three metrics, one pull. Needs theme.js, camera.js, body.js,
// metric_explorer_algebra.js and metric_explorer_draw.js before it. Everything is computed here
// from the traits, so it works the same with a kernel and in a page with stored state.

const WEIGHTS = { low: 0.01, high: 1000 }; // of w_kin beyond 0
const RIDGES = { low: 0.001, high: 100 };
const TICKS = 200; // steps of a logarithmic slider
const FRONT = { yaw: 0, pitch: 0, orthographic: true };

/** A slider over powers of ten; position 0 is the value 0 if `zero` is set. */
function logSlider(name, { low, high }, zero, onchange) {
  const input = element("input", { type: "range", min: 0, max: TICKS, step: 1, "aria-label": name });
  const first = zero ? 1 : 0;
  const toValue = (tick) =>
    tick < first ? 0 : +(low * (high / low) ** ((tick - first) / (TICKS - first))).toPrecision(2);
  const toTick = (value) =>
    value < low ? 0 : first + (Math.log(value / low) / Math.log(high / low)) * (TICKS - first);
  input.addEventListener("input", () => onchange(toValue(+input.value)));
  const show = (value) => {
    input.value = Math.round(toTick(value));
    input.setAttribute("aria-valuetext", short(value));
  };
  return { input, show };
}

/** Three digits, without the noise of binary fractions. */
function short(value) {
  return String(+value.toPrecision(3));
}

function plain(name) {
  return name.replaceAll("_", " ");
}

/** "left elbow–wrist", or both names in full where they are not on one side. */
function boneName(names, joint) {
  const [a, b] = [plain(names[PARENTS[joint]]), plain(names[joint])];
  const [side] = a.split(" ");
  return /^(left|right) /.test(a) && b.startsWith(`${side} `) ? `${a}–${b.slice(side.length + 1)}` : `${a}–${b}`;
}

function buildExplorer(root, view, names) {
  const canvas = element("canvas", { tabindex: 0, role: "application", "aria-roledescription": "three bodies" });
  const captions = [0, 1, 2].map(() => element("div", { class: "pf-caption" }));
  const stage = element("div", { class: "pf-stage" }, canvas, element("div", { class: "pf-captions" }, ...captions));
  const table = buildTable(names, view);
  const joint = element("select", { "aria-label": "Pulled joint", onchange: () => view.pick(+joint.value) },
    ...names.map((name, value) => element("option", { value }, plain(name))));
  const weight = logSlider("Weight of the bones, w", WEIGHTS, true, (w_kin) => view.save({ w_kin }));
  const ridge = logSlider("Ridge, lambda", RIDGES, false, (value) => view.save({ ridge: value }));
  const values = { w: element("span", { class: "pf-readout" }), ridge: element("span", { class: "pf-readout" }) };
  const front = button("Front", () => view.front(), { title: "Look from the front (drag the ground to turn)" });
  const release = button("Let go", () => view.save({ pull: [0, 0, 0] }), { title: "No pull (Escape)" });
  const spoken = element("span", { class: "pf-hidden", "aria-live": "polite" });
  root.append(
    element("div", { class: "pf-explorer-row" }, stage, table.node),
    element("div", { class: "pf-bar" },
      element("label", {}, "pull the", joint),
      element("label", { class: "pf-wide" }, element("i", {}, "w"), weight.input, values.w),
      element("label", { class: "pf-wide" }, element("i", {}, "λ"), ridge.input, values.ridge),
      element("span", { class: "pf-group pf-last" }, release, front)),
    element("div", { class: "pf-bar pf-scale" }, element("span", {}, `bone shorter by ${FULL_STRETCH * 100} %`),
      element("span", { class: "pf-ramp", "aria-hidden": "true" }), element("span", {}, "longer"),
      element("span", { class: "pf-pull pf-readout pf-last" })),
    spoken);
  const pull = root.querySelector(".pf-pull");
  return { root, stage, canvas, captions, table, joint, weight, ridge, values, front, release, pull, spoken };
}

/** Every joint's share of the pull under each metric: a number with a bar behind it. */
function buildTable(names, view) {
  const heads = [0, 1, 2].map(() => element("th", { scope: "col" }));
  const rows = names.map((name, joint) => {
    const cells = [0, 1, 2].map(() => element("td", {}));
    const row = element("tr", { onclick: () => view.pick(joint) },
      element("th", { scope: "row" }, plain(name)), ...cells);
    return { row, cells };
  });
  const table = element("table", { class: "pf-shares" },
    element("caption", {}, "moves per metre of pull"),
    element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "joint"), ...heads)),
    element("tbody", {}, ...rows.map(({ row }) => row)));
  return { node: element("div", { class: "pf-beside" }, table), heads, rows };
}

class ExplorerView {
  constructor(model, el) {
    this.model = model;
    this.camera = new OrbitCamera();
    Object.assign(this.camera, FRONT);
    this.L = laplacian(PARENTS);
    this.names = model.get("names");
    this.ui = buildExplorer(makeRoot(el, "explorer", "Metric explorer"), this, this.names);
    this.ctx = context2d(this.ui.canvas);
    this.ui.stage.style.height = `${model.get("height")}px`;
    this.stops = [
      onTraits(model, ["joint", "pull", "w_kin", "ridge", "own", "own_name", "rest"], () => this.change()),
      watchTheme(() => this.recolour()),
      fitCanvas(this.ui.canvas, (width, height, ratio) => this.resize(width, height, ratio)),
      listenToPull(this),
      listenToPullKeys(this),
    ];
    this.change();
  }

  stop() {
    this.stopped = true;
    clearTimeout(this.speaking);
    this.stops.forEach((stop) => stop());
  }

  save(state) {
    for (const [name, value] of Object.entries(state)) this.model.set(name, value);
    this.model.save_changes();
    this.change();
  }

  /** Take hold of another joint; the body goes back to rest. */
  pick(joint) {
    if (joint !== this.picked) this.save({ joint: this.names[joint], pull: [0, 0, 0] });
  }

  front() {
    Object.assign(this.camera, FRONT);
    this.camera.aim();
    this.fit();
    this.redraw();
  }

  /** Work out shares, poses and stretches of the three bodies from the traits. */
  change() {
    const { model } = this;
    const [w, ridge] = [model.get("w_kin"), model.get("ridge")];
    this.picked = Math.max(0, this.names.indexOf(model.get("joint")));
    this.rest = model.get("rest");
    this.pull = model.get("pull");
    const metrics = [jointMetric(this.L, 0, 1), jointMetric(this.L, w, ridge), model.get("own")];
    this.bodies = metrics.map((R) => {
      const shares = sharesOf(R, this.picked);
      const pose = pulledPose(this.rest, shares, this.pull);
      return { shares, pose, stretch: stretches(this.rest, pose) };
    });
    this.show([["Euclidean", "R = I"], ["kinematic", `R = ${short(w)} L + ${short(ridge)} I`],
      [model.get("own_name"), ""]]);
    this.redraw();
  }

  show(titles) {
    const { ui, model, names, bodies } = this;
    ui.joint.value = this.picked;
    ui.weight.show(model.get("w_kin"));
    ui.ridge.show(model.get("ridge"));
    ui.values.w.textContent = short(model.get("w_kin"));
    ui.values.ridge.textContent = short(model.get("ridge"));
    ui.release.disabled = this.pull.every((value) => value === 0);
    ui.pull.textContent = `pull ${this.pull.map((v) => v.toFixed(2).replace("-", "−")).join(", ")} m`;
    titles.forEach(([title, formula], i) => {
      const worst = worstBone(bodies[i].stretch);
      const result = Math.abs(worst.stretch) < 0.0005 ? "no bone changes"
        : `worst bone ${percent(worst.stretch)} (${boneName(names, worst.joint)})`;
      ui.captions[i].replaceChildren(element("b", {}, title), " ", element("span", {}, formula ?? ""), element("br"), result);
      ui.captions[i].dataset.worst = worst.stretch;
      ui.table.heads[i].textContent = ["Euclid", "kin.", "own"][i];
      ui.table.heads[i].title = title;
    });
    ui.table.rows.forEach(({ row, cells }, joint) => {
      row.classList.toggle("pf-picked", joint === this.picked);
      cells.forEach((cell, i) => showShare(cell, bodies[i].shares[joint]));
    });
    this.describe();
  }

  /** The picture in words; read out once things have been quiet for a while. */
  describe() {
    const { ui, names, picked } = this;
    const text = `${plain(names[picked])} pulled by ${Math.hypot(...this.pull).toFixed(2)} metres. ` +
      ui.captions.map((caption) => caption.textContent.replaceAll("−", "minus ")).join(". ");
    ui.canvas.setAttribute("aria-label", `${text}. Arrow keys pull by 1 centimetre, with shift by 10; ` +
      "page up and page down pull towards you and away; n and p take the next or previous joint; a, d, w and s turn the view.");
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => (ui.spoken.textContent = text), 500);
  }

  recolour() {
    this.palette = readPalette(this.ui.root);
    this.redraw();
  }

  resize(width, height, ratio) {
    this.palette = readPalette(this.ui.root); // not before: outside the page there are no styles
    this.size = { width, height, ratio };
    this.camera.resize(width / 3, height);
    this.fit();
    this.draw(); // at once: a resized canvas is blank
  }

  /** Room for the body at rest and a pull of a third of a metre to any side, below the captions. */
  fit() {
    const around = this.rest.flatMap(([x, y, z]) => [[x - 0.3, y, z], [x + 0.3, y, z]]);
    this.camera.fit([...around, [0, 0, 0], [0, 1.95, 0]]);
  }

  redraw() {
    if (this.request || this.stopped) return;
    this.request = requestAnimationFrame(() => {
      this.request = 0;
      this.draw();
    });
  }

  draw() {
    if (!this.size || this.stopped) return;
    const { ctx, camera, palette, size } = this;
    ctx.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    ctx.fillStyle = palette.paper;
    ctx.fillRect(0, 0, size.width, size.height);
    this.bodies.forEach((body, i) => {
      ctx.save();
      ctx.translate(i * camera.width, 0);
      ctx.beginPath();
      ctx.rect(0, 0, camera.width, camera.height);
      ctx.clip();
      drawPulled(ctx, camera, palette, this.rest, body, this.picked);
      ctx.restore();
      if (i) strokeLine(ctx, [i * camera.width, 0], [i * camera.width, size.height], palette["grid-strong"], 1);
    });
  }
}

/** A share as text, with a bar of its size: to the right, or hatched where it moves against. */
function showShare(cell, share) {
  cell.textContent = share.toFixed(2).replace("-", "−").replace("−0.00", "0.00");
  cell.dataset.share = share;
  cell.style.setProperty("--share", `${Math.min(1, Math.abs(share)) * 100}%`);
  cell.classList.toggle("pf-against", share < -0.005);
}
