// What a board draws: one painter for each kind of layer. `xy` holds x, y, x, y, …

const BOARD_PAINTERS = {
  // One path for each dot: stamping an image was measured slower, one path for all much slower.
  points(ctx, map, palette, layer, xy) {
    ctx.fillStyle = palette[layer.color];
    ctx.globalAlpha = layer.opacity;
    for (let i = 0; i < xy.length; i += 2) {
      ctx.beginPath();
      ctx.arc(...map.toPixels(xy[i], xy[i + 1]), layer.size, 0, 2 * Math.PI);
      ctx.fill();
    }
  },

  line(ctx, map, palette, layer, xy) {
    ctx.strokeStyle = palette[layer.color];
    ctx.lineWidth = layer.width;
    ctx.setLineDash(layer.dash ? [3 * layer.width, 2.5 * layer.width] : []);
    ctx.beginPath();
    let down = false; // is the pen on the paper?
    for (let i = 0; i < xy.length; i += 2) {
      const known = !Number.isNaN(xy[i] + xy[i + 1]);
      if (known) ctx[down ? "lineTo" : "moveTo"](...map.toPixels(xy[i], xy[i + 1]));
      down = known;
    }
    ctx.stroke();
  },

  ellipse(ctx, map, palette, layer, [x, y, ax, ay, bx, by]) {
    ctx.strokeStyle = ctx.fillStyle = palette[layer.color];
    ctx.lineWidth = 1.75;
    const sides = 72;
    for (const deviation of layer.deviations) {
      ctx.beginPath();
      for (let i = 0; i <= sides; i++) {
        const c = deviation * Math.cos((2 * Math.PI * i) / sides);
        const s = deviation * Math.sin((2 * Math.PI * i) / sides);
        ctx.lineTo(...map.toPixels(x + c * ax + s * bx, y + c * ay + s * by));
      }
      ctx.globalAlpha = 0.1;
      ctx.fill();
      ctx.globalAlpha = 1;
      ctx.stroke();
    }
  },

  arrow(ctx, map, palette, layer, [x1, y1, x2, y2]) {
    const start = map.toPixels(x1, y1);
    const end = map.toPixels(x2, y2);
    const length = Math.hypot(end[0] - start[0], end[1] - start[1]);
    if (length < 1) return;
    const head = Math.min(12, 0.6 * length);
    ctx.strokeStyle = ctx.fillStyle = palette[layer.color];
    ctx.lineWidth = 2.5;
    ctx.translate(...end);
    ctx.rotate(Math.atan2(end[1] - start[1], end[0] - start[0]));
    ctx.beginPath();
    ctx.moveTo(-length, 0);
    ctx.lineTo(-0.7 * head, 0);
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(0, 0);
    ctx.lineTo(-head, 0.45 * head);
    ctx.lineTo(-head, -0.45 * head);
    ctx.fill();
  },

  text(ctx, map, palette, layer, [x, y]) {
    const lines = layer.words.split("\n");
    ctx.font = `12px ${palette.font}`;
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    ctx.lineWidth = 4;
    ctx.strokeStyle = palette.paper;
    ctx.fillStyle = layer.color === "quiet" ? palette.muted : palette[layer.color];
    const half = Math.max(...lines.map((line) => ctx.measureText(line).width)) / 2 + 3;
    const [px, py] = map.toPixels(x, y);
    const inside = Math.max(map.frame.x + half, Math.min(map.frame.x + map.frame.width - half, px));
    lines.forEach((line, i) => {
      const at = py + (i - (lines.length - 1) / 2) * 15;
      ctx.strokeText(line, inside, at);
      ctx.fillText(line, inside, at);
    });
  },
};

/** All layers in their order, inside the frame; words may stand on its edge. */
function drawLayers(ctx, map, palette, layers, values) {
  const { x, y, width, height } = map.frame;
  for (const layer of layers) {
    const xy = values.subarray(2 * layer.start, 2 * (layer.start + layer.count));
    if (!xy.length) continue;
    ctx.save();
    if (layer.kind !== "text") {
      ctx.beginPath();
      ctx.rect(x, y, width, height);
      ctx.clip();
    }
    ctx.lineCap = layer.dash ? "butt" : "round";
    ctx.lineJoin = "round";
    BOARD_PAINTERS[layer.kind](ctx, map, palette, layer, xy);
    ctx.restore();
  }
}

/** A small picture of each kind, for the legend. */
const BOARD_KEYS = {
  points: '<circle cx="10" cy="6" r="4" fill="currentColor"/>',
  line: '<path d="M1 6h18" stroke="currentColor" stroke-width="2.5"/>',
  dashed: '<path d="M1 6h18" stroke="currentColor" stroke-width="2.5" stroke-dasharray="4.5 2.5"/>',
  ellipse: '<ellipse cx="10" cy="6" rx="8" ry="4.5" stroke="currentColor" stroke-width="1.75" fill="currentColor" fill-opacity=".15"/>',
  arrow: '<path d="M1 6h12" stroke="currentColor" stroke-width="2.5"/><path d="M20 6l-8-4.5v9z" fill="currentColor"/>',
};

function boardKey(layer) {
  const key = element("span", { class: "pf-board-key" });
  const kind = layer.dash ? "dashed" : layer.kind;
  key.innerHTML = `<svg viewBox="0 0 20 12" aria-hidden="true" style="color: var(--pf-role-${layer.color})">${BOARD_KEYS[kind]}</svg>`;
  key.append(layer.label);
  return key;
}
