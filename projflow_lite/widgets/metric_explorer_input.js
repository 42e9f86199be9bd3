// How a person pulls: mouse, touch and keys. Needs metric_explorer.js before it.

const KEY_PULL = 0.01; // metres an arrow key pulls
const LONGEST_PULL = 2; // metres along each axis, as Python allows

/** A pull with every axis kept between the longest allowed, in whole tenths of a millimetre. */
function limited(pull) {
  return pull.map((value) => {
    const inside = Math.min(LONGEST_PULL, Math.max(-LONGEST_PULL, value));
    return Math.round(inside * 1e4) / 1e4;
  });
}

/** Press on a joint of any of the bodies and pull it; press elsewhere and turn the view. */
function listenToPull(view) {
  const { canvas } = view.ui;
  const { camera } = view;
  let held = null;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const nearest = ([x, y]) => {
    const panel = Math.min(2, Math.max(0, Math.floor(x / camera.width)));
    const found = view.bodies[panel].pose.map((point, joint) => {
      const [px, py] = camera.project(...point);
      const favour = joint === view.picked ? 8 : 0; // where joints overlap, keep the one in hand
      return { joint, distance: Math.hypot(px + panel * camera.width - x, py - y) - favour };
    });
    found.sort((a, b) => a.distance - b.distance);
    return found[0].distance < PICK_RADIUS ? found[0].joint : null;
  };
  const listeners = {
    pointerdown(event) {
      if (event.isPrimary === false || event.button > 0) return;
      const at = place(event);
      const joint = nearest(at);
      canvas.setPointerCapture(event.pointerId);
      if (joint !== null) view.pick(joint);
      held = { joint, from: at, pull: [...view.pull] };
    },
    pointermove(event) {
      const at = place(event);
      if (!held) {
        canvas.style.cursor = nearest(at) === null ? "move" : "grab";
        return;
      }
      const [dx, dy] = [at[0] - held.from[0], at[1] - held.from[1]];
      if (held.joint === null) {
        camera.orbit(dx, dy);
        held.from = at;
        view.redraw();
        return;
      }
      const metres = 1 / camera.scale(camera.distance);
      const moved = [0, 1, 2].map((i) => (dx * camera.right[i] - dy * camera.up[i]) * metres);
      view.save({ pull: limited(held.pull.map((value, i) => value + moved[i])) });
    },
    pointerup: () => (held = null),
    pointercancel: () => (held = null),
  };
  const entries = Object.entries(listeners);
  entries.forEach(([name, listener]) => canvas.addEventListener(name, listener));
  return () => entries.forEach(([name, listener]) => canvas.removeEventListener(name, listener));
}

/** Arrows pull in the plane of the picture, page keys towards the eye and away from it. */
function listenToPullKeys(view) {
  const { camera } = view;
  const pull = (axis, sign) => (size) =>
    view.save({ pull: limited(view.pull.map((value, i) => value + sign * size * camera[axis][i])) });
  const turn = (dx, dy) => () => {
    camera.orbit(dx, dy);
    view.redraw();
  };
  const step = (by) => () => view.pick((view.picked + by + view.names.length) % view.names.length);
  const keys = {
    ArrowRight: pull("right", 1), ArrowLeft: pull("right", -1), ArrowUp: pull("up", 1), ArrowDown: pull("up", -1),
    PageUp: pull("back", 1), PageDown: pull("back", -1), n: step(1), p: step(-1),
    a: turn(-12, 0), d: turn(12, 0), w: turn(0, 12), s: turn(0, -12),
    Escape: () => view.save({ pull: [0, 0, 0] }),
  };
  const listener = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key](KEY_PULL * (event.shiftKey ? 10 : 1));
  };
  view.ui.canvas.addEventListener("keydown", listener);
  return () => view.ui.canvas.removeEventListener("keydown", listener);
}

export default {
  render: guarded("metric explorer", ({ model, el }) => {
    const view = new ExplorerView(model, el);
    return () => view.stop();
  }),
};
