// Drawing in the viewer: ground, shadow, bodies, trails. Every function takes the drawing
// surface, the camera and the palette, and reads positions in metres.

const PARENTS = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19];
const HEAD = 15;
const NECK = 12;
/** 0 the spine, 1 left, 2 right: the side of the joint at the far end of each bone. */
const SIDES = [0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 1, 2, 1, 2];
/** Bones drawn as limbs, by the joint they end in; the others are part of the torso. */
const LIMBS = [4, 5, 7, 8, 10, 11, 18, 19, 20, 21];
/** How thick to draw them, metres: shapes, not measurements. */
const THICKNESS = { 4: 0.125, 5: 0.125, 7: 0.1, 8: 0.1, 10: 0.075, 11: 0.075, 18: 0.09, 19: 0.09, 20: 0.072, 21: 0.072 };
const SPINE_MIDDLE = 6;
const HEAD_RADIUS = 0.105;
const GRID = 0.5; // metres
const APART = 0.6; // metres between two pelvises

/** Ground lines every half metre, every metre stronger, under everything that moves. */
function drawGround(ctx, camera, palette, box) {
  const low = [0, 2].map((i) => Math.floor(box.low[i] - 0.75));
  const high = [0, 2].map((i) => Math.ceil(box.high[i] + 0.75));
  for (const strong of [false, true]) {
    ctx.beginPath();
    const add = (from, to) => {
      const ends = camera.segment(from, to);
      if (!ends) return;
      ctx.moveTo(ends[0][0], ends[0][1]);
      ctx.lineTo(ends[1][0], ends[1][1]);
    };
    for (let x = low[0]; x <= high[0]; x += GRID) {
      if (Number.isInteger(x) === strong) add([x, 0, low[1]], [x, 0, high[1]]);
    }
    for (let z = low[1]; z <= high[1]; z += GRID) {
      if (Number.isInteger(z) === strong) add([low[0], 0, z], [high[0], 0, z]);
    }
    ctx.strokeStyle = strong ? palette["grid-strong"] : palette.grid;
    ctx.lineWidth = 1;
    ctx.stroke();
  }
}

/** Small x, y, z arrows in the corner, and how long a cell of the grid is. */
function drawAxes(ctx, camera, palette) {
  const [x0, y0, length] = [36, camera.height - 52, 20];
  ctx.font = `11px ${palette.font}`;
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.lineWidth = 1.75;
  ctx.strokeStyle = palette.muted;
  ctx.fillStyle = palette.muted;
  const axes = [0, 1, 2].sort((a, b) => camera.back[a] - camera.back[b]);
  for (const axis of axes) {
    const [dx, dy] = [camera.right[axis] * length, -camera.up[axis] * length];
    ctx.beginPath();
    ctx.moveTo(x0, y0);
    ctx.lineTo(x0 + dx, y0 + dy);
    ctx.stroke();
    const reach = Math.hypot(dx, dy);
    if (reach > 6) ctx.fillText("xyz"[axis], x0 + dx * (1 + 9 / reach), y0 + dy * (1 + 9 / reach));
  }
  ctx.textAlign = "left";
  if (camera.width >= 480) ctx.fillText("grid 0.5 m", 12, camera.height - 14); // else numbers stand there
}

/** The pose of one body at a time between two frames, into `out` (22 × 3, metres). */
function poseAt(scene, body, time, out) {
  const size = scene.joints * 3;
  const frame = Math.min(Math.floor(time), scene.frames - 1);
  const start = (body * scene.frames + frame) * size;
  const share = time - frame;
  const next = share > 1e-6 && frame + 1 < scene.frames ? size : 0;
  for (let i = 0; i < size; i++) {
    const value = scene.data[start + i];
    out[i] = value + (scene.data[start + next + i] - value) * share;
  }
  return out;
}

/** A soft shadow straight below the body. One stroke for all bones, so overlaps do not add up. */
function drawShadow(ctx, camera, palette, pose, strength) {
  ctx.beginPath();
  for (let joint = 1; joint < PARENTS.length; joint++) {
    const parent = PARENTS[joint];
    const a = [pose[parent * 3], 0, pose[parent * 3 + 2]];
    const b = [pose[joint * 3], 0, pose[joint * 3 + 2]];
    const ends = camera.segment(a, b);
    if (!ends) continue;
    ctx.moveTo(ends[0][0], ends[0][1]);
    ctx.lineTo(ends[1][0], ends[1][1]);
  }
  const scale = camera.project(pose[0], 0, pose[2])[3];
  ctx.lineCap = ctx.lineJoin = "round";
  ctx.strokeStyle = palette.shadow;
  for (const [width, alpha] of [[0.34, 0.05], [0.28, 0.05], [0.22, 0.06], [0.16, 0.06], [0.1, 0.06]]) {
    ctx.globalAlpha = alpha * strength * (palette.dark ? 1.6 : 1);
    ctx.lineWidth = width * scale;
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

/** Where the middle of the skull is: a little beyond the head joint, seen from the neck. */
function skull(pose) {
  const direction = [0, 1, 2].map((i) => pose[HEAD * 3 + i] - pose[NECK * 3 + i]);
  const length = Math.hypot(...direction) || 1;
  return direction.map((value, i) => pose[HEAD * 3 + i] + (value / length) * 0.07);
}

/** One body with thick round limbs, the far ones first; a thin rim keeps crossing limbs apart. */
function drawBody(ctx, camera, palette, pose) {
  const points = projectPose(camera, pose);
  const head = camera.project(...skull(pose));
  if (Math.min(head[2], ...points.map((point) => point[2])) < NEAR) return; // the eye is inside it
  const pieces = [
    { depth: points[SPINE_MIDDLE][2], draw: (colour) => drawTorso(ctx, palette, points, colour), side: 0 },
    { depth: head[2], draw: (colour) => drawHead(ctx, palette, head, colour), side: 0 },
  ];
  for (const joint of LIMBS) {
    const [a, b] = [points[PARENTS[joint]], points[joint]];
    const width = Math.max(2, THICKNESS[joint] * 0.5 * (a[3] + b[3]));
    const draw = (colour) => strokeRimmed(ctx, palette, width, colour, () => {
      ctx.moveTo(a[0], a[1]);
      ctx.lineTo(b[0], b[1]);
    });
    pieces.push({ depth: (a[2] + b[2]) / 2, draw, side: SIDES[joint] });
  }
  pieces.sort((first, second) => second.depth - first.depth);
  const sides = [palette.core, palette.left, palette.right];
  for (const { depth, draw, side } of pieces) {
    // What is behind the pelvis fades into the paper a little: a cue for depth. In few steps,
    // so that the mixed colours are found again and not computed anew.
    const fade = Math.min(0.32, Math.max(0, 0.08 + (depth - points[0][2]) * 0.4));
    draw(mix(sides[side], palette.paper, Math.round(fade * 16) / 16));
  }
}

function projectPose(camera, pose) {
  return PARENTS.map((_, joint) =>
    camera.project(pose[joint * 3], pose[joint * 3 + 1], pose[joint * 3 + 2]));
}

function strokeRimmed(ctx, palette, width, colour, trace) {
  ctx.lineCap = ctx.lineJoin = "round";
  ctx.beginPath();
  trace();
  for (const [stroke, lineWidth] of [[palette.paper, width + 3], [colour, width]]) {
    ctx.strokeStyle = stroke;
    ctx.lineWidth = lineWidth;
    ctx.stroke();
  }
}

/** Spine, collars and hips as one shape, which bends where the joints do. */
function drawTorso(ctx, palette, points, colour) {
  const trace = (...joints) => joints.forEach((joint, i) =>
    (i ? ctx.lineTo(points[joint][0], points[joint][1]) : ctx.moveTo(points[joint][0], points[joint][1])));
  strokeRimmed(ctx, palette, 0.115 * points[SPINE_MIDDLE][3], colour, () => {
    trace(1, 0, 2);
    trace(16, 13, 9, 14, 17);
    trace(0, 3, 6, 9, NECK);
    trace(16, 9, 17, 2, 0, 1, 16);
  });
  ctx.fillStyle = colour;
  ctx.fill();
  strokeRimmed(ctx, { paper: colour }, 0.07 * points[NECK][3], colour, () => trace(9, NECK, HEAD));
}

function drawHead(ctx, palette, [x, y, , scale], colour) {
  disc(ctx, x, y, HEAD_RADIUS * scale + 1.5, palette.paper);
  disc(ctx, x, y, HEAD_RADIUS * scale, colour);
}

/** Another body for comparison: thin, half transparent, one stroke for each side. */
function drawGhost(ctx, camera, palette, pose) {
  const colours = [palette.core, palette.left, palette.right];
  const points = projectPose(camera, pose);
  if (points[0][2] < 2 * NEAR) return;
  ctx.lineCap = ctx.lineJoin = "round";
  ctx.globalAlpha = palette.dark ? 0.5 : 0.42;
  for (let side = 0; side < 3; side++) {
    ctx.beginPath();
    for (let joint = 1; joint < PARENTS.length; joint++) {
      if (SIDES[joint] !== side) continue;
      ctx.moveTo(points[PARENTS[joint]][0], points[PARENTS[joint]][1]);
      ctx.lineTo(points[joint][0], points[joint][1]);
    }
    ctx.strokeStyle = colours[side];
    ctx.lineWidth = Math.max(1.5, 0.035 * points[0][3]);
    ctx.stroke();
  }
  const head = camera.project(...skull(pose));
  ctx.beginPath();
  ctx.arc(head[0], head[1], HEAD_RADIUS * head[3] * 0.9, 0, 2 * Math.PI);
  ctx.strokeStyle = palette.core;
  ctx.stroke();
  ctx.globalAlpha = 1;
}

/** Does a body stand apart from all others? A name above two that overlap would say nothing. */
function isAlone(pose, poses) {
  return poses.every((other) => other === pose || Math.hypot(other[0] - pose[0], other[2] - pose[2]) > APART);
}

/** Names above heads; one that would cover another moves up. */
function drawNames(ctx, camera, palette, named) {
  const placed = [];
  ctx.textAlign = "center";
  for (const { pose, name } of named) {
    const [x, top, depth, scale] = camera.project(...skull(pose));
    if (depth < NEAR) continue;
    let y = top - HEAD_RADIUS * scale - 11;
    const half = name.length * 3.6 + 4;
    for (const other of placed) {
      if (Math.abs(x - other.x) < half + other.half && Math.abs(y - other.y) < 15) y = other.y - 15;
    }
    placed.push({ x, y, half });
    label(ctx, palette, name, x, y, palette.muted);
  }
}

/** Text with a rim in the colour of the paper, readable on top of anything. */
function label(ctx, palette, text, x, y, colour) {
  ctx.font = `600 12px ${palette.font}`;
  ctx.textBaseline = "middle";
  ctx.lineJoin = "round";
  ctx.lineWidth = 3.5;
  ctx.strokeStyle = palette.paper;
  ctx.strokeText(text, x, y);
  ctx.fillStyle = colour;
  ctx.fillText(text, x, y);
}

function disc(ctx, x, y, radius, colour) {
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
  ctx.fillStyle = colour;
  ctx.fill();
}

/** The path of one joint: faint for the whole motion, strong for the last second. */
function drawTrail(ctx, camera, palette, scene, joint, time) {
  const colour = [palette.core, palette.left, palette.right][SIDES[joint]];
  const stroke = (from, to, width, alpha) => {
    ctx.beginPath();
    for (let frame = from; frame <= to; frame++) {
      const i = (frame * scene.joints + joint) * 3;
      const [x, y, depth] = camera.project(scene.data[i], scene.data[i + 1], scene.data[i + 2]);
      if (depth > NEAR) ctx.lineTo(x, y);
    }
    ctx.globalAlpha = alpha;
    ctx.lineWidth = width;
    ctx.stroke();
  };
  ctx.lineCap = ctx.lineJoin = "round";
  ctx.strokeStyle = colour;
  stroke(0, scene.frames - 1, 1.5, 0.35);
  const now = Math.round(time);
  stroke(Math.max(0, now - Math.round(scene.fps)), now, 3, 0.85);
  ctx.globalAlpha = 1;
}
