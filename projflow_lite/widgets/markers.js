// Constraint markers of the viewer: what was asked for, and how nearly it was met.
// A record holds: joint, frame, x, y, z (NaN where free), standard deviation, residual (metres).

const RECORD = 7;
const MET = 1e-5; // metres: far below what can be seen, above the rounding of float32
const CLEARLY_MISSED = 0.05; // metres: from here on the colour is fully that of a miss

/** Unpack the markers; a free axis takes the joint's own coordinate, for something to draw. */
function readMarkers(values, scene) {
  const markers = [];
  for (let i = 0; i + RECORD <= values.length; i += RECORD) {
    const [joint, frame, x, y, z, std, residual] = values.subarray(i, i + RECORD);
    const own = (frame * scene.joints + joint) * 3;
    const free = [x, y, z].map(Number.isNaN);
    const at = [x, y, z].map((value, axis) => (free[axis] ? scene.data[own + axis] : value));
    markers.push({ joint, frame, at, free, std, residual, met: residual <= Math.max(MET, 2 * std) });
  }
  markers.sort((a, b) => a.joint - b.joint || a.frame - b.frame);
  markers.forEach((marker, i) => {
    const near = (other) => other && other.joint === marker.joint && Math.abs(other.frame - marker.frame) <= 2;
    marker.alone = !near(markers[i - 1]) && !near(markers[i + 1]);
  });
  return markers;
}

/** From green (met) to red (missed) on a logarithmic scale, because residuals span decades. */
function markerColour(palette, { residual, met }) {
  if (met) return palette.met;
  const share = (Math.log10(residual) - Math.log10(MET)) / Math.log10(CLEARLY_MISSED / MET);
  return mix(palette.met, palette.missed, Math.min(1, Math.max(0.35, share)));
}

/** A length in the unit a person would use. */
function metresText(value) {
  if (value >= 0.995) return `${value.toFixed(2)} m`;
  if (value >= 0.001) return `${(value * 100).toFixed(value >= 0.01 ? 0 : 1)} cm`;
  return `${value.toExponential(0)} m`;
}

/** All markers faintly: a dotted path for each joint, a ring for a key frame that stands alone. */
function drawMarkerPaths(ctx, camera, palette, markers) {
  ctx.lineCap = "round";
  let previous = null;
  ctx.beginPath();
  for (const marker of markers) {
    const [x, y, depth] = camera.project(...marker.at);
    marker.x = x;
    marker.y = y;
    marker.hidden = depth < NEAR;
    if (marker.hidden) continue;
    const joined = previous && previous.joint === marker.joint && marker.frame - previous.frame <= 2;
    if (joined) {
      ctx.moveTo(previous.x, previous.y);
      ctx.lineTo(x, y);
    }
    previous = marker;
  }
  ctx.strokeStyle = palette.muted;
  ctx.globalAlpha = 0.35;
  ctx.lineWidth = 1;
  ctx.stroke();
  ctx.globalAlpha = 0.8;
  for (const marker of markers) {
    if (marker.hidden) continue;
    const colour = markerColour(palette, marker);
    if (!marker.alone) {
      disc(ctx, marker.x, marker.y, 2, colour);
    } else {
      symbol(ctx, palette, marker, 4.5, colour, false);
    }
  }
  ctx.globalAlpha = 1;
}

/** The markers of one frame, large, with the distance that is left where one was missed. */
function drawMarkersAt(ctx, camera, palette, markers, frame, pose) {
  for (const marker of markers) {
    if (marker.hidden || Math.abs(marker.frame - frame) > (marker.alone ? 2 : 0)) continue;
    const now = marker.frame === frame;
    const colour = markerColour(palette, marker);
    drawFreeAxes(ctx, camera, palette, marker);
    if (marker.std > 0) drawTolerance(ctx, camera, marker, colour);
    const j = marker.joint * 3;
    if (now && !marker.met) {
      const [x, y] = camera.project(pose[j], pose[j + 1], pose[j + 2]);
      ctx.beginPath();
      ctx.moveTo(x, y);
      ctx.lineTo(marker.x, marker.y);
      ctx.strokeStyle = colour;
      ctx.lineWidth = 2;
      ctx.stroke();
    }
    symbol(ctx, palette, marker, now ? 9 : 6.5, colour, true);
    if (now && !marker.met) {
      ctx.textAlign = "left";
      label(ctx, palette, `${metresText(marker.residual)} off`, marker.x + 14, marker.y - 2, colour);
    }
  }
}

/** Met: a disc with a tick. Missed: an open diamond. The shape says it without the colour. */
function symbol(ctx, palette, { x, y, met }, radius, colour, filled) {
  ctx.lineJoin = ctx.lineCap = "round";
  ctx.beginPath();
  if (met) {
    ctx.arc(x, y, radius, 0, 2 * Math.PI);
  } else {
    const reach = radius * 1.25;
    ctx.moveTo(x, y - reach);
    ctx.lineTo(x + reach, y);
    ctx.lineTo(x, y + reach);
    ctx.lineTo(x - reach, y);
    ctx.closePath();
  }
  ctx.lineWidth = filled ? 5 : 3.5;
  ctx.strokeStyle = palette.paper;
  ctx.stroke();
  if (met && filled) {
    ctx.fillStyle = colour;
    ctx.fill();
    ctx.beginPath();
    ctx.moveTo(x - radius * 0.45, y + radius * 0.05);
    ctx.lineTo(x - radius * 0.1, y + radius * 0.4);
    ctx.lineTo(x + radius * 0.5, y - radius * 0.35);
    ctx.strokeStyle = palette.paper;
    ctx.lineWidth = 2;
  } else {
    ctx.strokeStyle = colour;
    ctx.lineWidth = 2.25;
  }
  ctx.stroke();
}

/** Short bars along the axes a constraint leaves free. */
function drawFreeAxes(ctx, camera, palette, { at, free }) {
  ctx.beginPath();
  for (let axis = 0; axis < 3; axis++) {
    if (!free[axis]) continue;
    const shifted = (step) => at.map((value, i) => (i === axis ? value + step : value));
    const ends = camera.segment(shifted(-0.16), shifted(0.16));
    if (!ends) continue;
    ctx.moveTo(ends[0][0], ends[0][1]);
    ctx.lineTo(ends[1][0], ends[1][1]);
  }
  ctx.strokeStyle = palette.muted;
  ctx.lineWidth = 1.5;
  ctx.stroke();
}

/** A soft wish: a dashed ring of one standard deviation. */
function drawTolerance(ctx, camera, marker, colour) {
  const scale = camera.project(...marker.at)[3];
  ctx.beginPath();
  ctx.arc(marker.x, marker.y, Math.max(12, marker.std * scale), 0, 2 * Math.PI);
  ctx.setLineDash([4, 4]);
  ctx.strokeStyle = colour;
  ctx.lineWidth = 1.5;
  ctx.stroke();
  ctx.setLineDash([]);
}
