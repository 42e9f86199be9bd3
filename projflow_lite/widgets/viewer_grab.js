// Grab a joint of the body in focus and drag it in the plane of the view. The kernel answers.

const REACH = 16; // pixels around a joint

/** The joint under the pointer, as it is drawn now: the one nearest to the eye, or null. */
function jointAt(view, event) {
  const { scene, camera, clock, ui } = view;
  if (!scene || !view.model.get("grab")) return null;
  const frame = Math.min(scene.frames - 1, Math.round(clock));
  const box = ui.canvas.getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  let found = null;
  for (let joint = 0; joint < scene.joints; joint++) {
    const i = (frame * scene.joints + joint) * 3;
    const at = [...scene.data.subarray(i, i + 3)];
    const [u, v, depth] = camera.project(...at);
    const near = Math.hypot(u - x, v - y) < REACH;
    if (near && (!found || depth < found.depth)) found = { joint, frame, at, depth };
  }
  return found;
}

/** Take hold: playing stops, for a joint is grabbed in one frame. */
function takeHold(view, held) {
  view.held = held;
  view.clock = held.frame;
  if (view.playing) view.setPlaying(false);
  view.ui.canvas.style.cursor = "grabbing";
}

/** Move what is held by so many pixels, as deep in the picture as it was. */
function moveHeld(view, dx, dy) {
  const { held, camera } = view;
  const metres = 1 / camera.scale(held.depth);
  held.moved = true;
  for (let i = 0; i < 3; i++) held.at[i] += (dx * camera.right[i] - dy * camera.up[i]) * metres;
  view.redraw();
  if (held.waiting) return; // one message a picture is enough
  held.waiting = true;
  requestAnimationFrame(() => {
    held.waiting = false;
    if (view.held === held) tellPull(view, held, false);
  });
}

/** Let go. A click that moved nothing asks for nothing. */
function letGo(view) {
  if (view.held.moved) tellPull(view, view.held, true);
  view.held = null;
  view.ui.canvas.style.cursor = "";
  view.redraw();
}

function tellPull(view, { joint, frame, at }, done) {
  const count = (view.model.get("pull").count ?? 0) + 1;
  view.save({ pull: { joint, frame, at: [...at], done, count } });
}

/** A ring where the pointer holds the joint, and a line from where the joint is by now. */
function drawHeld({ ctx, camera, palette, held }, pose) {
  if (!held) return;
  const [x, y] = camera.project(...held.at);
  const [u, v] = camera.project(...pose.subarray(held.joint * 3, held.joint * 3 + 3));
  ctx.strokeStyle = palette.ink;
  ctx.lineWidth = 2;
  ctx.beginPath();
  ctx.moveTo(u, v);
  ctx.lineTo(x, y);
  ctx.stroke();
  ctx.beginPath();
  ctx.arc(x, y, 8, 0, 2 * Math.PI);
  ctx.stroke();
}
