// The viewer: its controls, its clock and its picture. Needs theme.js, camera.js, body.js,
// markers.js and viewer_grab.js before it in the same module. Everything it shows is in the model's traits, so the
// same module runs in a notebook with a kernel and in a page with stored state.

const ICONS = {
  play: "M4 2.5v11l9-5.5z",
  pause: "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z",
};
const SPEEDS = [0.1, 0.25, 0.5, 1, 2];
const DRAW_EVERY = 1000 / 32; // milliseconds: at most 30 pictures a second, enough for 20 fps motion
const SCENE = ["data", "shape", "fps", "solid", "names", "markers", "residual"];

/** Everything the traits say about what to show. */
function readScene(model) {
  const [bodies = 0, frames = 0, joints = 0] = model.get("shape");
  const data = floats(model.get("data"));
  if (!bodies || data.length !== bodies * frames * joints * 3) return null;
  const scene = { bodies, frames, joints, data, fps: model.get("fps"), solid: model.get("solid") };
  scene.names = model.get("names");
  scene.markers = readMarkers(floats(model.get("markers")), scene);
  scene.residual = model.get("residual");
  scene.box = boundingBox(scene);
  return scene;
}

/** The smallest box around all bodies and markers, from the ground up. */
function boundingBox({ data, markers }) {
  const low = [Infinity, 0, Infinity];
  const high = [-Infinity, 1.8, -Infinity];
  const add = (values, start) => {
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], values[start + axis]);
      high[axis] = Math.max(high[axis], values[start + axis]);
    }
  };
  for (let i = 0; i < data.length; i += 3) add(data, i);
  for (const { at } of markers) add(at, 0);
  return { low, high };
}

/** Places that should be in the picture at the start: bodies now and then, markers. */
function placesOf({ data, frames, joints, bodies, markers }) {
  const places = markers.map(({ at }) => at);
  const step = Math.max(1, Math.floor(frames / 12));
  for (let body = 0; body < bodies; body++) {
    for (let frame = 0; frame < frames; frame += step) {
      for (let joint = 0; joint < joints; joint++) {
        const i = ((body * frames + frame) * joints + joint) * 3;
        places.push([data[i], data[i + 1] + (joint === HEAD ? 0.2 : 0), data[i + 2]]);
      }
    }
  }
  return places;
}

/** What stands above the picture: the name of the first body, and below it those of the thin ones. */
function captionOf(scene) {
  if (!scene) return ["no motion to show"];
  const thin = scene.names.slice(Math.max(1, scene.solid)).filter(Boolean);
  return [scene.names[0], thin.length ? `thin: ${thin.join(", ")}` : ""].filter(Boolean);
}

/** "3.1e-08", as Python writes it; an ordinary number where the eye can see the difference. */
function residualText(residual) {
  if (residual === 0 || residual >= 0.001) return residual === 0 ? "0" : residual.toFixed(3);
  return residual.toExponential(1).replace(/e-(\d)$/, "e-0$1");
}

/** Build the page elements; returns the ones that change. */
function buildViewer(root, view) {
  const canvas = element("canvas", { tabindex: 0, role: "img" });
  const note = element("p", { class: "pf-note" });
  const legend = element("div", { class: "pf-legend" },
    element("span", { class: "pf-key", style: "--key: var(--pf-left)" }, "left"),
    element("span", { class: "pf-key", style: "--key: var(--pf-right)" }, "right"));
  const exactness = element("div", { class: "pf-exactness pf-readout" });
  const stage = element("div", { class: "pf-stage" }, canvas, note, legend, exactness);
  const play = button("Play", () => view.setPlaying(!view.playing), { icon: ICONS.play });
  const slider = element("input", {
    type: "range", min: 0, step: 1, "aria-label": "Frame", oninput: () => view.scrub(+slider.value),
  });
  const speed = element("select", {
    "aria-label": "Speed", title: "Speed", onchange: () => view.save({ speed: +speed.value }),
  }, ...SPEEDS.map((value) => element("option", { value }, `${value}×`)));
  const follow = button("Follow", () => view.save({ follow: !view.model.get("follow") }),
    { title: "Keep the pelvis in the middle" });
  const flat = button("Flat", () => view.setCamera({ orthographic: !view.camera.orthographic }),
    { title: "No perspective (orthographic camera)" });
  const reset = button("Reset view", () => view.resetCamera(), { title: "Reset view (double-click)" });
  const where = element("span", { class: "pf-readout" });
  const spoken = element("span", { class: "pf-hidden", "aria-live": "polite" });
  root.append(stage,
    element("div", { class: "pf-bar" }, play, slider, where, speed,
      element("span", { class: "pf-group pf-last" }, follow, flat, reset)),
    spoken);
  return { root, stage, canvas, note, play, slider, speed, follow, flat, where, exactness, spoken };
}

class ViewerView {
  constructor(model, el) {
    this.model = model;
    this.camera = new OrbitCamera();
    this.ui = buildViewer(makeRoot(el, "viewer", "Motion viewer"), this);
    this.ctx = context2d(this.ui.canvas);
    this.pose = new Float32Array(66);
    this.clock = model.get("frame");
    this.playing = model.get("playing") && !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.visible = true;
    this.ratio = 1;
    this.ui.stage.style.height = `${model.get("height")}px`;
    this.tick = this.tick.bind(this);
    this.drawn = { since: performance.now(), count: 0 };
    this.loadScene();
    this.stops = this.listen();
    this.showState();
  }

  listen() {
    const { model, ui } = this;
    const watcher = new IntersectionObserver((entries) => {
      this.visible = entries.at(-1).isIntersecting; // off screen: leave the processor to others
      this.redraw();
    });
    watcher.observe(ui.stage);
    return [
      onTraits(model, SCENE, () => this.loadScene()),
      onTraits(model, ["playing"], () => {
        if (model.get("playing") !== this.playing) this.setPlaying(model.get("playing"));
      }),
      onTraits(model, ["frame"], () => this.moveTo(model.get("frame"))),
      onTraits(model, ["camera"], () => this.readCamera()),
      onTraits(model, ["speed", "follow", "trail_joints", "height"], () => this.showState()),
      watchTheme(() => this.recolour()),
      fitCanvas(ui.canvas, (width, height, ratio) => this.resize(width, height, ratio)),
      () => watcher.disconnect(),
      listenToPointer(this),
      listenToKeys(this),
    ];
  }

  stop() {
    this.stopped = true;
    this.stops.forEach((stop) => stop());
  }

  save(state) {
    for (const [name, value] of Object.entries(state)) this.model.set(name, value);
    this.model.save_changes();
  }

  /** New positions replace the old ones in place; camera, clock and play state stay. */
  loadScene() {
    const scene = readScene(this.model);
    this.scene = scene;
    this.ui.note.replaceChildren(...captionOf(scene).map((line) => element("span", {}, line)));
    const names = scene ? scene.names.filter(Boolean).join("; ") : "";
    this.ui.canvas.setAttribute("aria-label", scene
      ? `Animated skeleton, ${scene.bodies} bod${scene.bodies > 1 ? "ies" : "y"}, ${scene.frames} frames. ${names} ` +
        "Space plays, arrow keys step, w a s d turn the view."
      : "No motion to show");
    if (!scene) return this.redraw();
    this.clock = Math.min(this.clock, scene.frames - 1);
    this.ui.slider.max = scene.frames - 1;
    if (!this.touched && !inside(scene.box, this.fitted)) this.fitCamera();
    this.showExactness();
    this.speak();
    this.redraw();
  }

  fitCamera() {
    if (!this.scene || !this.sized) return;
    this.camera.shift = [0, 0, 0];
    this.camera.fit(this.model.get("follow") ? this.bodyPoints() : placesOf(this.scene));
    this.fitted = this.scene.box;
  }

  /** Room for one person around the pelvis: what to fit while the camera follows it. */
  bodyPoints() {
    const [x, , z] = this.scene.data;
    return [[x - 0.6, 0, z], [x + 0.6, 0, z], [x, 0, z - 0.6], [x, 0, z + 0.6], [x, 1.8, z]];
  }

  readCamera() {
    const state = this.model.get("camera");
    if (JSON.stringify(state) === this.savedCamera) return; // our own change, come back
    this.touched = Object.keys(state).length > 0;
    if (this.touched) Object.assign(this.camera, state);
    else Object.assign(this.camera, { yaw: 0.6, pitch: 0.2, orthographic: false });
    this.camera.aim();
    if (!state.distance) this.fitCamera();
    this.showState();
  }

  setCamera(change) {
    Object.assign(this.camera, change);
    this.camera.aim();
    this.touched = true;
    this.showState();
    this.saveCamera();
  }

  saveCamera() {
    const state = this.camera.state();
    this.savedCamera = JSON.stringify(state);
    this.save({ camera: state });
  }

  resetCamera() {
    this.savedCamera = undefined;
    this.save({ camera: {} });
    this.readCamera();
  }

  recolour() {
    this.palette = readPalette(this.ui.root);
    this.redraw();
  }

  resize(width, height, ratio) {
    const first = !this.sized;
    this.palette = readPalette(this.ui.root); // not before: outside the page there are no styles
    this.sized = true;
    this.ratio = ratio;
    this.camera.resize(width, height);
    if (first) this.readCamera();
    else if (!this.touched) this.fitCamera();
    this.draw(); // at once: a resized canvas is blank
  }

  setPlaying(playing) {
    if (playing && this.scene && !this.model.get("loop") && this.clock >= this.scene.frames - 1) this.clock = 0;
    this.playing = playing;
    this.last = undefined;
    if (!playing) this.clock = Math.round(this.clock);
    this.save(playing ? { playing } : { playing, frame: this.clock });
    setIcon(this.ui.play, playing ? ICONS.pause : ICONS.play);
    this.ui.play.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.speak();
    this.redraw();
  }

  /** Go to a frame without telling the kernel. */
  moveTo(frame) {
    if (!this.scene) return;
    this.clock = Math.min(Math.max(0, frame), this.scene.frames - 1);
    this.redraw();
  }

  /** A person moved to a frame: stop there, and tell the kernel. */
  scrub(frame) {
    this.moveTo(frame);
    this.playing = true;
    this.setPlaying(false);
  }

  showState() {
    const { ui, model } = this;
    ui.stage.style.height = `${model.get("height")}px`;
    ui.speed.value = SPEEDS.reduce((a, b) =>
      (Math.abs(b - model.get("speed")) < Math.abs(a - model.get("speed")) ? b : a));
    ui.follow.setAttribute("aria-pressed", model.get("follow"));
    ui.flat.setAttribute("aria-pressed", this.camera.orthographic);
    setIcon(ui.play, this.playing ? ICONS.pause : ICONS.play);
    ui.play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    if (!model.get("follow")) this.camera.shift = [0, 0, 0];
    this.redraw();
  }

  showExactness() {
    const { markers, residual } = this.scene;
    const { exactness, root } = this.ui;
    const met = markers.filter((marker) => marker.met).length;
    root.dataset.met = met;
    root.dataset.markers = markers.length;
    exactness.replaceChildren();
    if (residual === null) return;
    exactness.append(`max |A x − y| = ${residualText(residual)} m`);
    if (!markers.length) return;
    const all = met === markers.length;
    exactness.append("  ·  ", element("span", { class: all ? "pf-met" : "pf-missed" },
      `${all ? "✓" : "◇"} ${met} of ${markers.length} markers met`));
  }

  /** For a screen reader, and only at rest: nobody wants twenty frames a second read out. */
  speak() {
    if (this.playing || !this.scene) return;
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      this.ui.spoken.textContent = `${this.ui.where.textContent}. ${this.ui.exactness.textContent}`;
    }, 400);
  }

  redraw() {
    this.dirty = true;
    if (this.request || this.stopped) return;
    this.request = requestAnimationFrame(this.tick);
  }

  tick(now) {
    this.request = 0;
    if (this.stopped || !this.visible) return;
    const running = this.playing && this.scene && this.scene.frames > 1;
    const due = this.last === undefined || now - this.last >= DRAW_EVERY - 4;
    if (running && due) {
      const passed = this.last === undefined ? 0 : Math.min(250, now - this.last);
      this.advance((passed / 1000) * this.scene.fps * this.model.get("speed"));
      this.last = now;
    }
    if (this.dirty || (running && due)) this.draw();
    if (running && this.playing) this.request = requestAnimationFrame(this.tick);
  }

  advance(frames) {
    const { scene } = this;
    this.clock += frames;
    if (this.clock < scene.frames) return; // the last frame is held for one frame, then again
    if (this.model.get("loop")) {
      this.clock %= scene.frames;
    } else {
      this.clock = scene.frames - 1;
      this.setPlaying(false);
    }
  }

  draw() {
    this.dirty = false;
    if (!this.sized) return;
    const { ctx, camera, palette, scene, ratio } = this;
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.fillStyle = palette.paper;
    ctx.fillRect(0, 0, camera.width, camera.height);
    if (!scene) return;
    const time = Math.min(this.clock, scene.frames - 1);
    drawScene(this, time);
    this.showTime(Math.min(scene.frames - 1, Math.round(time)));
  }

  showTime(frame) {
    const { ui, scene, drawn } = this;
    const seconds = (frame / scene.fps).toFixed(2);
    ui.slider.value = frame;
    ui.slider.setAttribute("aria-valuetext", `frame ${frame}, ${seconds} seconds`);
    ui.where.textContent = `frame ${frame} / ${scene.frames - 1}  ·  ${seconds} s`;
    drawn.count += 1;
    const passed = performance.now() - drawn.since;
    if (passed < 1000) return;
    ui.root.dataset.fps = ((drawn.count * 1000) / passed).toFixed(1);
    this.drawn = { since: performance.now(), count: 0 };
  }
}

/** Is a box inside another, up to half a metre? Then the camera need not move for it. */
function inside(box, outer) {
  if (!outer) return false;
  return [0, 1, 2].every((i) => box.low[i] >= outer.low[i] - 0.5 && box.high[i] <= outer.high[i] + 0.5);
}

/** One picture: ground, shadows, what was asked for, bodies from far to near, markers on top. */
function drawScene(view, time) {
  const { ctx, camera, palette, scene, model } = view;
  const frame = Math.min(scene.frames - 1, Math.round(time));
  const poses = Array.from({ length: scene.bodies }, (_, body) =>
    poseAt(scene, body, time, new Float32Array(scene.joints * 3)));
  if (model.get("follow")) {
    const [x, , z] = poses[0];
    camera.shift = [x - camera.target[0], 0, z - camera.target[2]];
  }
  drawGround(ctx, camera, palette, scene.box);
  poses.forEach((pose, body) => drawShadow(ctx, camera, palette, pose, body < scene.solid ? 1 : 0.4));
  drawMarkerPaths(ctx, camera, palette, scene.markers);
  model.get("trail_joints").forEach((joint) => drawTrail(ctx, camera, palette, scene, joint, time));
  const order = poses.map((pose, body) => ({ pose, body, depth: camera.see(pose[0], pose[1], pose[2])[2] }));
  order.sort((a, b) => b.depth - a.depth);
  for (const { pose, body } of order) {
    (body < scene.solid ? drawBody : drawGhost)(ctx, camera, palette, pose);
  }
  const named = order.map(({ pose, body }) => ({ pose, name: body > 0 && isAlone(pose, poses) ? scene.names[body] : "" }));
  drawNames(ctx, camera, palette, named.filter(({ name }) => name).reverse());
  drawMarkersAt(ctx, camera, palette, scene.markers, frame, poses[0]);
  drawHeld(view, poses[0]);
  drawAxes(ctx, camera, palette);
}
