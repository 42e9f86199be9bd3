// The plane of a board: from its units to pixels and back, light ticks, the names of the axes.

const BOARD_MARGIN = { left: 46, right: 14, top: 12, bottom: 40 };

class BoardMap {
  constructor([left, right], [low, high], equal, width, height) {
    const inner = [
      Math.max(20, width - BOARD_MARGIN.left - BOARD_MARGIN.right),
      Math.max(20, height - BOARD_MARGIN.top - BOARD_MARGIN.bottom),
    ];
    let scale = [inner[0] / (right - left), inner[1] / (high - low)];
    if (equal) scale = [Math.min(...scale), Math.min(...scale)];
    const size = [scale[0] * (right - left), scale[1] * (high - low)];
    Object.assign(this, { left, right, low, high, scale });
    this.frame = {
      x: BOARD_MARGIN.left + (inner[0] - size[0]) / 2,
      y: BOARD_MARGIN.top + (inner[1] - size[1]) / 2,
      width: size[0],
      height: size[1],
    };
  }

  toPixels(x, y) {
    return [this.frame.x + (x - this.left) * this.scale[0], this.frame.y + (this.high - y) * this.scale[1]];
  }

  toPlane(px, py) {
    return [this.left + (px - this.frame.x) / this.scale[0], this.high - (py - this.frame.y) / this.scale[1]];
  }

  /** The nearest place inside the picture, in units of the plane. */
  clamp([x, y]) {
    return [Math.min(this.right, Math.max(this.left, x)), Math.min(this.high, Math.max(this.low, y))];
  }

  /** Distance between two ticks of each axis: 1, 2 or 5 times a power of ten. */
  steps() {
    return [56, 40].map((room, axis) => {
      const least = room / this.scale[axis];
      const power = 10 ** Math.floor(Math.log10(least));
      return [1, 2, 5, 10].find((step) => step * power >= least * (1 - 1e-9)) * power;
    });
  }
}

/** A number with as many digits as a step needs. */
function boardNumber(value, step) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? (0).toFixed(digits) : text).replace("-", "−");
}

function boardTicks(low, high, step) {
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => (first + i) * step);
}

function drawAxes(ctx, map, palette, labels) {
  const { frame } = map;
  const [across, up] = map.steps();
  const line = (value, x1, y1, x2, y2) => {
    ctx.beginPath();
    ctx.strokeStyle = Math.abs(value) < 1e-9 ? palette["grid-strong"] : palette.grid;
    ctx.lineWidth = Math.abs(value) < 1e-9 ? 1.5 : 1;
    ctx.moveTo(x1, y1);
    ctx.lineTo(x2, y2);
    ctx.stroke();
  };
  ctx.font = `11px ${palette.font}`;
  ctx.fillStyle = palette.muted;
  ctx.textAlign = "center";
  ctx.textBaseline = "top";
  for (const x of boardTicks(map.left, map.right, across)) {
    const [px] = map.toPixels(x, 0);
    line(x, px, frame.y, px, frame.y + frame.height);
    ctx.fillText(boardNumber(x, across), px, frame.y + frame.height + 5);
  }
  ctx.textAlign = "right";
  ctx.textBaseline = "middle";
  for (const y of boardTicks(map.low, map.high, up)) {
    const [, py] = map.toPixels(0, y);
    line(y, frame.x, py, frame.x + frame.width, py);
    ctx.fillText(boardNumber(y, up), frame.x - 6, py);
  }
  ctx.font = `12px ${palette.font}`;
  ctx.textAlign = "center";
  ctx.textBaseline = "bottom";
  ctx.fillText(labels[0], frame.x + frame.width / 2, frame.y + frame.height + 38);
  ctx.save();
  ctx.translate(Math.max(10, frame.x - 34), frame.y + frame.height / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.textBaseline = "middle";
  ctx.fillText(labels[1], 0, 0);
  ctx.restore();
}
