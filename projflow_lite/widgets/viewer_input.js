// How a person moves the viewer: mouse, touch, wheel and keys.

/** Drag turns, shift-drag (or the right button) shifts, wheel zooms, double-click resets. Where
 * joints may be grabbed, a drag that begins on one moves it. */
function listenToPointer(view) {
  const { canvas } = view.ui;
  let last = null;
  let armed = false; // has the pointer moved over the canvas since it came in?
  const changed = () => {
    view.touched = true;
    view.redraw();
  };
  const zoom = debounce(() => view.saveCamera(), 250);
  const listeners = {
    pointerdown(event) {
      if (event.isPrimary === false) return;
      last = [event.clientX, event.clientY];
      armed = true;
      canvas.setPointerCapture(event.pointerId);
      const held = event.shiftKey || event.button ? null : jointAt(view, event);
      if (held) takeHold(view, held);
    },
    pointermove(event) {
      armed ||= Boolean(event.movementX || event.movementY);
      if (!last) {
        canvas.style.cursor = jointAt(view, event) ? "grab" : "";
        return;
      }
      const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
      last = [event.clientX, event.clientY];
      if (!dx && !dy) return;
      if (view.held) return moveHeld(view, dx, dy);
      if (event.shiftKey || event.buttons & 2) view.camera.pan(dx, dy);
      else view.camera.orbit(dx, dy);
      view.moved = true;
      changed();
    },
    pointerup() {
      if (view.held) letGo(view);
      else if (last && view.moved) view.saveCamera();
      last = null;
      view.moved = false;
    },
    pointerleave: () => (armed = false),
    contextmenu: (event) => event.preventDefault(),
    dblclick: () => view.resetCamera(),
    wheel(event) {
      // A page that scrolls past under a resting pointer must go on scrolling.
      if (!armed && !event.ctrlKey) return;
      event.preventDefault();
      view.camera.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(0.3, Math.abs(event.deltaY) * 0.0012)));
      changed();
      zoom();
    },
  };
  listeners.pointercancel = listeners.pointerup;
  const entries = Object.entries(listeners);
  entries.forEach(([name, listener]) => canvas.addEventListener(name, listener, { passive: false }));
  return () => entries.forEach(([name, listener]) => canvas.removeEventListener(name, listener));
}

/** Space plays; arrows, Home and End move in time; w a s d turn, + − zoom, r resets. */
function listenToKeys(view) {
  const step = (frames) => () => view.scrub(Math.round(view.clock) + frames);
  const turn = (dx, dy) => () => {
    view.camera.orbit(dx, dy);
    view.setCamera({});
  };
  const zoom = (factor) => () => {
    view.camera.zoom(factor);
    view.setCamera({});
  };
  const keys = {
    " ": () => view.setPlaying(!view.playing),
    ArrowLeft: step(-1), ArrowRight: step(1), ArrowDown: step(-10), ArrowUp: step(10),
    Home: () => view.scrub(0), End: () => view.scrub(Infinity),
    a: turn(-12, 0), d: turn(12, 0), w: turn(0, 12), s: turn(0, -12),
    "+": zoom(0.9), "=": zoom(0.9), "-": zoom(1.1), r: () => view.resetCamera(),
  };
  const listener = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { tagName } = event.target;
    if (tagName === "SELECT" || tagName === "BUTTON") return; // these have keys of their own
    if (!(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  };
  view.ui.root.addEventListener("keydown", listener);
  return () => view.ui.root.removeEventListener("keydown", listener);
}

/** Call once things have been quiet for a while. */
function debounce(callback, milliseconds) {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(callback, milliseconds);
  };
}

export default {
  render: guarded("motion viewer", ({ model, el }) => {
    const view = new ViewerView(model, el);
    return () => view.stop();
  }),
};
