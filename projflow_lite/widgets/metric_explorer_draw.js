// Drawing in the metric explorer: one body for each metric, bones coloured by how much they
// stretch. Needs body.js (PARENTS, disc, label, drawGround) and theme.js before it.

const FULL_STRETCH = 0.5; // at this relative change of length the colour is at its strongest
const PICK_RADIUS = 26; // pixels: how near a press must be to take a joint

/** The pose with every joint moved by its share of the pull; `rest` and the result are 22 × 3. */
function pulledPose(rest, shares, pull) {
  return rest.map((point, joint) => point.map((value, axis) => value + shares[joint] * pull[axis]));
}

/** Relative change of length of every bone, by the joint it ends in; 0 for the pelvis. */
function stretches(rest, pose) {
  const length = (points, joint) => {
    const parent = points[PARENTS[joint]];
    return Math.hypot(...points[joint].map((value, axis) => value - parent[axis]));
  };
  return PARENTS.map((parent, joint) => (parent < 0 ? 0 : length(pose, joint) / length(rest, joint) - 1));
}

/** The joint whose bone changed most, and by how much. */
function worstBone(stretch) {
  const joint = stretch.reduce((best, value, i) => (Math.abs(value) > Math.abs(stretch[best]) ? i : best), 1);
  return { joint, stretch: stretch[joint] };
}

/** Blue for shorter, grey for unchanged, orange for longer. */
function stretchColour(palette, stretch) {
  const share = Math.min(1, Math.abs(stretch) / FULL_STRETCH);
  return mix(palette.core, stretch < 0 ? palette.left : palette.right, share ** 0.7);
}

/** "+35 %" with a real minus sign. */
function percent(value) {
  const rounded = Math.round(value * 100);
  return `${rounded > 0 ? "+" : rounded < 0 ? "−" : ""}${Math.abs(rounded)} %`;
}

/** One panel: the body at rest as a thin line, the pulled body above it, the pull as an arrow. */
function drawPulled(ctx, camera, palette, rest, body, picked) {
  const before = rest.map((point) => camera.project(...point));
  const after = body.pose.map((point) => camera.project(...point));
  drawGround(ctx, camera, palette, { low: [-0.6, 0, -0.4], high: [0.6, 2, 0.4] });
  ctx.lineCap = ctx.lineJoin = "round";
  strokeBones(ctx, before, palette["grid-strong"], 2);
  const thickness = Math.max(4, 0.05 * camera.scale(camera.distance));
  const order = PARENTS.map((_, joint) => joint).slice(1);
  order.sort((a, b) => after[b][2] - after[a][2]);
  for (const joint of order) {
    const [from, to] = [after[PARENTS[joint]], after[joint]];
    strokeLine(ctx, from, to, palette.paper, thickness + 3);
    strokeLine(ctx, from, to, stretchColour(palette, body.stretch[joint]), thickness);
  }
  after.forEach(([x, y], joint) => joint !== HEAD && disc(ctx, x, y, 2, palette.paper));
  const [hx, hy, , scale] = camera.project(...skull(body.pose.flat()));
  disc(ctx, hx, hy, HEAD_RADIUS * scale + 1.5, palette.paper);
  disc(ctx, hx, hy, HEAD_RADIUS * scale, palette.core);
  drawPull(ctx, palette, before[picked], after[picked]);
  drawWorst(ctx, camera, palette, body, after);
}

function strokeLine(ctx, from, to, colour, width) {
  ctx.beginPath();
  ctx.moveTo(from[0], from[1]);
  ctx.lineTo(to[0], to[1]);
  ctx.strokeStyle = colour;
  ctx.lineWidth = width;
  ctx.stroke();
}

function strokeBones(ctx, points, colour, width) {
  for (let joint = 1; joint < PARENTS.length; joint++) {
    strokeLine(ctx, points[PARENTS[joint]], points[joint], colour, width);
  }
}

/** Where the joint was, where it is now, and a ring around what can be pulled. */
function drawPull(ctx, palette, from, to) {
  const reach = Math.hypot(to[0] - from[0], to[1] - from[1]);
  disc(ctx, from[0], from[1], 3.5, palette.ink);
  if (reach > 14) {
    const end = [0, 1].map((axis) => to[axis] - ((to[axis] - from[axis]) * 9) / reach);
    ctx.setLineDash([4, 4]);
    strokeLine(ctx, from, end, palette.ink, 1.5);
    ctx.setLineDash([]);
  }
  ctx.beginPath();
  ctx.arc(to[0], to[1], 9, 0, 2 * Math.PI);
  ctx.strokeStyle = palette.paper;
  ctx.lineWidth = 5;
  ctx.stroke();
  ctx.strokeStyle = palette.ink;
  ctx.lineWidth = 2.5;
  ctx.stroke();
}

/** The percentage of the worst bone beside it, so that colour is not the only sign. */
function drawWorst(ctx, camera, palette, body, after) {
  const { joint, stretch } = worstBone(body.stretch);
  if (Math.abs(stretch) < 0.005) return;
  const [a, b] = [after[PARENTS[joint]], after[joint]];
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(dx, dy) || 1;
  const side = dy >= 0 ? 1 : -1; // a bone that hangs has its text on the right of it
  let x = (a[0] + b[0]) / 2 + (side * dy * 14) / length;
  const y = (a[1] + b[1]) / 2 - (side * dx * 14) / length;
  const text = percent(stretch);
  const room = text.length * 7.5 + 4;
  ctx.textAlign = Math.abs(dy) > 0.5 * Math.abs(dx) ? "left" : "center";
  if (ctx.textAlign === "left" && x + room > camera.width) x = camera.width - room;
  label(ctx, palette, text, x, y, palette.ink);
}
