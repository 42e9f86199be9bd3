// The drawing plane of the path pad: metres to pixels, grid, axis labels, the body behind.

/** What each plane shows. `flip`: the first coordinate grows to the left of the page. */
const PLANES = {
  xy: { axes: ["x", "y"], flip: false, title: "Front view", ends: ["right side", "left side"], up: "height y, m" },
  zy: { axes: ["z", "y"], flip: false, title: "Side view", ends: ["back", "forward"], up: "height y, m" },
  xz: { axes: ["x", "z"], flip: true, title: "From above", ends: ["left side", "right side"], up: "forward z, m" },
};
const MARGIN = { left: 50, right: 16, top: 32, bottom: 42 };

/** The largest scale at which `bounds` (u low, u high, v low, v high) fits; equal on both axes. */
class PlaneMap {
  constructor(plane, bounds, width, height) {
    const [uLow, uHigh, vLow, vHigh] = bounds;
    this.sign = PLANES[plane].flip ? -1 : 1;
    const innerWidth = Math.max(20, width - MARGIN.left - MARGIN.right);
    const innerHeight = Math.max(20, height - MARGIN.top - MARGIN.bottom);
    this.scale = Math.min(innerWidth / (uHigh - uLow), innerHeight / (vHigh - vLow)); // pixels/metre
    this.middle = [(uLow + uHigh) / 2, (vLow + vHigh) / 2];
    this.centre = [MARGIN.left + innerWidth / 2, MARGIN.top + innerHeight / 2];
    this.frame = { x: MARGIN.left, y: MARGIN.top, width: innerWidth, height: innerHeight };
  }

  toPixels([u, v]) {
    return [
      this.centre[0] + this.sign * (u - this.middle[0]) * this.scale,
      this.centre[1] - (v - this.middle[1]) * this.scale,
    ];
  }

  toMetres([x, y]) {
    return [
      this.middle[0] + (this.sign * (x - this.centre[0])) / this.scale,
      this.middle[1] - (y - this.centre[1]) / this.scale,
    ];
  }

  /** The same place, kept inside the frame. */
  clamp([x, y]) {
    const { frame } = this;
    return [
      Math.min(frame.x + frame.width, Math.max(frame.x, x)),
      Math.min(frame.y + frame.height, Math.max(frame.y, y)),
    ];
  }
}

/** Grid lines and labels: the finest step of 0.1, 0.25, 0.5, 1 or 2 m that leaves room for text. */
function drawPlane(ctx, map, palette, plane) {
  const { frame } = map;
  const { ends, title, up, axes } = PLANES[plane];
  const step = [0.1, 0.5, 1, 2, 5].find((value) => value * map.scale >= 34) ?? 10;
  const [c1, c2] = [[frame.x, frame.y + frame.height], [frame.x + frame.width, frame.y]].map((p) => map.toMetres(p));
  const ticks = (a, b, every) => {
    const from = Math.ceil(Math.min(a, b) / every - 1e-9);
    const to = Math.floor(Math.max(a, b) / every + 1e-9);
    return Array.from({ length: Math.max(0, to - from + 1) }, (_, i) => (from + i) * every);
  };
  const number = (value) => (Math.abs(value) < 1e-9 ? "0" : value.toFixed(1).replace("-", "−"));
  ctx.lineWidth = 1;
  ctx.font = `11px ${palette.font}`;
  ctx.fillStyle = palette.muted;
  const line = (weight, from, to) => {
    ctx.beginPath();
    ctx.moveTo(...from);
    ctx.lineTo(...to);
    ctx.strokeStyle = weight > 1 ? palette["grid-strong"] : palette.grid;
    ctx.lineWidth = weight;
    ctx.stroke();
  };
  const upright = (u, weight) => {
    const [x] = map.toPixels([u, 0]);
    line(weight, [x, frame.y], [x, frame.y + frame.height]);
    return x;
  };
  const level = (v, weight) => {
    const [, y] = map.toPixels([0, v]);
    line(weight, [frame.x, y], [frame.x + frame.width, y]);
    return y;
  };
  if (step === 0.5) { // a thin line every 10 cm
    ticks(c1[0], c2[0], 0.1).forEach((u) => upright(u, 0.5));
    ticks(c1[1], c2[1], 0.1).forEach((v) => level(v, 0.5));
  }
  ctx.textAlign = "center";
  ctx.textBaseline = "top";
  for (const u of ticks(c1[0], c2[0], step)) {
    ctx.fillText(number(u), upright(u, Math.abs(u) < 1e-9 ? 2 : 1.1), frame.y + frame.height + 5);
  }
  ctx.textAlign = "right";
  ctx.textBaseline = "middle";
  for (const v of ticks(c1[1], c2[1], step)) {
    ctx.fillText(number(v), frame.x - 6, level(v, Math.abs(v) < 1e-9 ? 2 : 1.1));
  }
  drawPlaneNames(ctx, frame, palette, { ends, title, up, axes });
}

function drawPlaneNames(ctx, frame, palette, { ends, title, up, axes }) {
  const below = frame.y + frame.height + 21;
  ctx.fillStyle = palette.muted;
  ctx.textBaseline = "top";
  ctx.textAlign = "left";
  ctx.fillText(`← ${ends[0]}`, frame.x, below);
  ctx.textAlign = "right";
  ctx.fillText(`${ends[1]} →`, frame.x + frame.width, below);
  ctx.textAlign = "center";
  ctx.fillText(`${axes[0]}, m`, frame.x + frame.width / 2, below);
  ctx.textBaseline = "middle";
  ctx.save();
  ctx.translate(11, frame.y + frame.height / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.fillText(up, 0, 0);
  ctx.restore();
  ctx.textAlign = "left";
  ctx.font = `600 12px ${palette.font}`;
  ctx.fillStyle = palette.ink;
  ctx.fillText(title, 12, 16);
}

/** The body behind the drawing, and the path its joint takes now. */
function drawReference(ctx, map, palette, { lines, jointPath, name }) {
  ctx.lineCap = ctx.lineJoin = "round";
  ctx.beginPath();
  for (const line of lines) {
    line.forEach((point, i) => (i ? ctx.lineTo(...map.toPixels(point)) : ctx.moveTo(...map.toPixels(point))));
  }
  ctx.strokeStyle = palette["grid-strong"];
  ctx.lineWidth = Math.max(3, 0.05 * map.scale);
  ctx.globalAlpha = 0.75;
  ctx.stroke();
  ctx.globalAlpha = 1;
  if (!jointPath.length) return;
  ctx.beginPath();
  jointPath.forEach((point) => ctx.lineTo(...map.toPixels(point)));
  ctx.strokeStyle = palette.muted;
  ctx.lineWidth = 1.5;
  ctx.setLineDash([2, 4]);
  ctx.stroke();
  ctx.setLineDash([]);
  const [x, y] = map.toPixels(jointPath[0]);
  ctx.beginPath();
  ctx.arc(x, y, 4, 0, 2 * Math.PI);
  ctx.fillStyle = palette.muted;
  ctx.fill();
  if (!name) return;
  const { frame } = map;
  ctx.font = `11px ${palette.font}`;
  const left = x + 12 + ctx.measureText(name).width > frame.x + frame.width;
  ctx.textAlign = left ? "right" : "left";
  ctx.textBaseline = "middle";
  ctx.lineWidth = 3;
  ctx.strokeStyle = palette.paper;
  ctx.strokeText(name, x + (left ? -9 : 9), y + 12);
  ctx.fillText(name, x + (left ? -9 : 9), y + 12);
}

/** The path: a line, a dot for each sample, a disc where it starts and an arrow where it ends. */
function drawPath(ctx, map, palette, path, stroke) {
  ctx.lineCap = ctx.lineJoin = "round";
  const line = (points) => {
    ctx.beginPath();
    points.forEach((point) => ctx.lineTo(...map.toPixels(point)));
    ctx.stroke();
  };
  ctx.strokeStyle = palette.muted; // what the hand drew, before smoothing
  ctx.globalAlpha = 0.45;
  ctx.lineWidth = 1;
  line(stroke);
  ctx.globalAlpha = 1;
  ctx.strokeStyle = palette.left;
  ctx.lineWidth = 2.5;
  line(path);
  const pixels = path.map((point) => map.toPixels(point));
  ctx.fillStyle = palette.left;
  for (const [x, y] of pixels) {
    ctx.beginPath();
    ctx.arc(x, y, 2.6, 0, 2 * Math.PI);
    ctx.fill();
  }
  drawEnds(ctx, palette, pixels);
}

function drawEnds(ctx, palette, pixels) {
  const [x0, y0] = pixels[0];
  ctx.beginPath();
  ctx.arc(x0, y0, 6.5, 0, 2 * Math.PI);
  ctx.fillStyle = palette.paper;
  ctx.strokeStyle = palette.left;
  ctx.lineWidth = 3;
  ctx.fill();
  ctx.stroke();
  const [x, y] = pixels.at(-1);
  const before = pixels.findLast(([px, py]) => Math.hypot(px - x, py - y) > 3);
  if (!before) return;
  ctx.save();
  ctx.translate(x, y);
  ctx.rotate(Math.atan2(y - before[1], x - before[0]));
  ctx.beginPath();
  ctx.moveTo(6, 0);
  ctx.lineTo(-8, 7);
  ctx.lineTo(-8, -7);
  ctx.closePath();
  ctx.fillStyle = palette.left;
  ctx.strokeStyle = palette.paper;
  ctx.lineWidth = 1.5;
  ctx.fill();
  ctx.stroke();
  ctx.restore();
}
