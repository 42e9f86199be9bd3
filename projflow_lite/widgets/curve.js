// Curves in the plane of the path pad: arrays of [u, v] in metres. No drawing here.

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const between = (a, b, share) => [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share];

/** Arc length from the start to each point. */
function arcLength(points) {
  const along = [0];
  for (let i = 1; i < points.length; i++) along.push(along[i - 1] + distance(points[i - 1], points[i]));
  return along;
}

/** `count` points, evenly spaced in `along`, on the polyline through `points`. */
function resample(points, along, count) {
  const total = along.at(-1);
  const result = [];
  let i = 0;
  for (let k = 0; k < count; k++) {
    const wanted = count > 1 ? (total * k) / (count - 1) : 0;
    while (i < along.length - 2 && along[i + 1] < wanted) i++;
    const step = along[i + 1] - along[i];
    result.push(step > 0 ? between(points[i], points[i + 1], Math.min(1, (wanted - along[i]) / step)) : [...points[i]]);
  }
  return result;
}

/** Gaussian smoothing over `sigma` points. Beyond an end the curve goes on turned by 180°: so
 * both ends stay where they are, and a straight line stays the line it is. */
function smooth(points, sigma) {
  if (sigma < 0.3) return points;
  const last = points.length - 1;
  const reach = Math.min(last, Math.ceil(3 * sigma));
  const weights = Array.from({ length: reach + 1 }, (_, k) => Math.exp(-0.5 * (k / sigma) ** 2));
  const at = (i) => {
    if (i < 0) return points[-i].map((value, axis) => 2 * points[0][axis] - value);
    if (i > last) return points[2 * last - i].map((value, axis) => 2 * points[last][axis] - value);
    return points[i];
  };
  return points.map((_, i) => {
    let [u, v, sum] = [0, 0, 0];
    for (let k = -reach; k <= reach; k++) {
      const weight = weights[Math.abs(k)];
      const [pu, pv] = at(i + k);
      u += weight * pu;
      v += weight * pv;
      sum += weight;
    }
    return [u / sum, v / sum];
  });
}

/** From a stroke to the path that leaves the pad.
 * stroke: {points, times}; timing "even" walks it at constant speed, "drawn" as the hand did. */
function shapeStroke({ points, times }, { samples, smoothing, timing }) {
  if (!points.length) return [];
  const length = arcLength(points).at(-1);
  if (length === 0) return Array.from({ length: samples }, () => [...points[0]]);
  const dense = 400;
  const byHand = timing === "drawn" && times.at(-1) > times[0];
  const clock = byHand ? times.map((time) => time - times[0]) : arcLength(points);
  const smoothed = smooth(resample(points, clock, dense), (smoothing / length) * dense);
  const even = smoothed.map((_, i) => i);
  return resample(smoothed, byHand ? even : arcLength(smoothed), samples);
}

/** Shapes to start from, in a box of −1..1; `turns` goes from 0 to 1 along the curve. */
const PRESETS = {
  Circle: (turns) => [Math.sin(2 * Math.PI * turns), Math.cos(2 * Math.PI * turns)],
  "Figure eight": (turns) => [Math.sin(2 * Math.PI * turns), Math.sin(4 * Math.PI * turns) * 0.6],
  Heart: (turns) => {
    const angle = 2 * Math.PI * turns;
    const v = 13 * Math.cos(angle) - 5 * Math.cos(2 * angle) - 2 * Math.cos(3 * angle) - Math.cos(4 * angle);
    return [Math.sin(angle) ** 3, (v + 2.5) / 16];
  },
  Wave: (turns) => [2 * turns - 1, Math.sin(6 * Math.PI * turns) * 0.4],
  "S-curve": (turns) => [-Math.sin(2 * Math.PI * turns) * 0.6, 1 - 2 * turns],
};

function presetStroke(name, centre, radius) {
  const count = 121;
  const points = Array.from({ length: count }, (_, i) => {
    const [u, v] = PRESETS[name](i / (count - 1));
    return [centre[0] + radius * u, centre[1] + radius * v];
  });
  return { points, times: points.map((_, i) => i) };
}

/** Pull one point of a stroke; its neighbours within about `reach` metres come along. */
function bendStroke({ points, times }, index, shift, reach) {
  const along = arcLength(points);
  const bent = points.map(([u, v], i) => {
    const weight = Math.exp(-0.5 * ((along[i] - along[index]) / reach) ** 2);
    return [u + shift[0] * weight, v + shift[1] * weight];
  });
  return { points: bent, times };
}

function moveStroke({ points, times }, [du, dv]) {
  return { points: points.map(([u, v]) => [u + du, v + dv]), times };
}

function nearestPoint(points, place) {
  let best = 0;
  points.forEach((point, i) => {
    if (distance(point, place) < distance(points[best], place)) best = i;
  });
  return best;
}
