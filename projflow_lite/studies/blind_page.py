"""Can you tell? A page of moving stick figures, shuffled, whose origin only a second file knows.

Synthetic clips, generated ones and, if a file of them is given, recorded ones. The page is a single
file that needs no network; the key opens in the page itself, after one has guessed.
"""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from data_synth import held_out
from projflow_lite.samplers import sample
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.skeleton import EDGES, JOINTS, N_JOINTS

PAGE, KEY = "blind.html", "blind_key.json"


def run(
    prior: Velocity,
    folder: str | Path,
    real: str | Path | None = None,
    clips: int = 8,
    frames: int = 60,
    steps: int | None = None,
    seed: int = 0,
) -> list[Path]:
    """Write the page ``blind.html`` and its key ``blind_key.json``.

    Args:
        prior: what generates.
        folder: where the two files go.
        real: an ``.npz`` file of recorded motion, see `read_real`; None for a page without it.
        clips: how many of each kind.
        frames: length of every clip.
        steps: of sampling, see `sample`.
        seed: of the choice of clips, the noise and the order; nothing is picked by hand.

    Raises:
        ValueError: if the file of recorded motion has not enough clips of that length.
    """
    random = np.random.default_rng(seed)
    data, other = held_out(clips, frames, 2 * seed), held_out(clips, frames, 2 * seed + 1)
    made = sample(prior, None, other.captions, frames, steps, seed, batch=clips)
    kinds = {"synthetic": data.positions, "generated": made.positions}
    captions = {"synthetic": data.captions, "generated": other.captions}
    if real is not None:
        kinds["real"], captions["real"] = read_real(real, clips, frames, random), [""] * clips
    names = [(kind, k) for kind in kinds for k in range(clips)]
    shuffled = [names[k] for k in random.permutation(len(names))]
    key = {
        str(place + 1): {"kind": kind, "caption": captions[kind][k]}
        for place, (kind, k) in enumerate(shuffled)
    }
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    page, answers = folder / PAGE, folder / KEY
    bodies = np.stack([kinds[kind][k] for kind, k in shuffled])
    page.write_text(html(bodies, sorted(kinds)), encoding="utf-8")
    answers.write_text(json.dumps(key, indent=1) + "\n", encoding="utf-8")
    return [page, answers]


def read_real(
    path: str | Path, clips: int, frames: int, random: np.random.Generator
) -> NDArray[np.float32]:
    """Some clips of recorded motion, cut to `frames`.

    Args:
        path: an ``.npz`` file; its first array ``(n, at least frames, 22, 3)`` is taken, metres,
            20 frames a second, the joints in the order of `JOINTS`.
        clips: how many.
        frames: how long.
        random: what chooses them.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it has no such array, with enough clips in it.
    """
    with np.load(path, allow_pickle=False) as file:
        for name in file.files:
            x = file[name]
            if x.ndim == 4 and x.shape[1] >= frames and x.shape[2:] == (N_JOINTS, 3):
                if len(x) < clips:
                    raise ValueError(
                        f"blind_page: '{name}' in {path} has {len(x)} clips of {clips}"
                    )
                return x[random.choice(len(x), clips, replace=False), :frames]
    raise ValueError(f"blind_page: {path} has no array (clips, {frames} or more, {N_JOINTS}, 3)")


def html(positions: NDArray, kinds: list[str]) -> str:
    """The page, with ``(clips, frames, 22, 3)`` metres stored in it as millimetres."""
    x = np.array(positions, float)
    x[..., [0, 2]] -= x[:, :1, :1, [0, 2]]
    data = base64.b64encode(np.round(1000 * x).astype("<i2").tobytes()).decode()
    side = [1 if n.startswith("left") else 2 if n.startswith("right") else 0 for n in JOINTS]
    given = {"shape": x.shape, "edges": EDGES, "side": side, "kinds": kinds, "data": data}
    return TEMPLATE.replace("GIVEN", json.dumps(given))


TEMPLATE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Can you tell?</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff; margin: 1.5rem; }
#clips { display: grid; grid-template-columns: repeat(auto-fill, minmax(200px, 1fr)); gap: 12px; }
figure { margin: 0; border: 1px solid #ccc; border-radius: 6px; padding: 6px; }
canvas { width: 100%; aspect-ratio: 1; cursor: grab; touch-action: none; }
figcaption { display: flex; justify-content: space-between; align-items: center; }
select, button, input { font: inherit; }
table { border-collapse: collapse; margin-top: 1rem; }
td, th { padding: 2px 12px; text-align: right; }
</style>
<h1>Can you tell?</h1>
<p>Every clip below is of one kind: <b id="names"></b>. Say what each one is. Drag to turn them all;
the lines on the floor are half a metre apart. Orange is the body's left, blue its right.</p>
<p><button id="pause">Pause</button></p>
<div id="clips"></div>
<p>When you have guessed:
<label>open the key <input type="file" id="key" accept=".json"></label></p>
<div id="result" aria-live="polite"></div>
<script>
const given = GIVEN;
const bytes = Uint8Array.from(atob(given.data), c => c.charCodeAt(0));
const mm = new Int16Array(bytes.buffer);
const [clips, frames, joints] = given.shape;
const colours = ["#4d4d4d", "#d55e00", "#0072b2"];
const at = (clip, frame, joint) => {
  const i = ((clip * frames + frame) * joints + joint) * 3;
  return [mm[i] / 1000, mm[i + 1] / 1000, mm[i + 2] / 1000];
};
let yaw = 0.7, playing = true, clock = 0, last = 0;
document.getElementById("names").textContent = given.kinds.join(", ");
const canvases = [], guesses = [];
for (let k = 0; k < clips; k++) {
  const figure = document.createElement("figure");
  const options = ["?", ...given.kinds].map(kind => `<option>${kind}</option>`).join("");
  figure.innerHTML = `<canvas width="300" height="300"></canvas><figcaption><b>${k + 1}</b>
    <select aria-label="clip ${k + 1}">${options}</select></figcaption>`;
  document.getElementById("clips").append(figure);
  canvases.push(figure.querySelector("canvas"));
  guesses.push(figure.querySelector("select"));
}
function draw(canvas, clip, frame) {
  const pen = canvas.getContext("2d"), size = canvas.width;
  const [px, , pz] = at(clip, frame, 0);
  const c = Math.cos(yaw), s = Math.sin(yaw), tilt = 0.2;
  const see = ([x, y, z]) => {
    const dx = x - px, dz = z - pz, toward = dx * s + dz * c;
    return [size * (0.5 + 0.4 * (dx * c - dz * s)), size * (0.88 - 0.4 * (y - tilt * toward))];
  };
  const line = (a, b, colour, width) => {
    pen.strokeStyle = colour; pen.lineWidth = width; pen.beginPath();
    pen.moveTo(...see(a)); pen.lineTo(...see(b)); pen.stroke();
  };
  pen.clearRect(0, 0, size, size);
  pen.lineCap = "round";
  const gx = Math.round(px * 2) / 2, gz = Math.round(pz * 2) / 2;
  for (let k = -1; k <= 1; k += 0.5) {
    line([gx + k, 0, gz - 1], [gx + k, 0, gz + 1], "#ddd", 1);
    line([gx - 1, 0, gz + k], [gx + 1, 0, gz + k], "#ddd", 1);
  }
  for (const [a, b] of given.edges) {
    line(at(clip, frame, a), at(clip, frame, b), colours[given.side[b]], 4);
  }
  const [hx, hy] = see(at(clip, frame, 15));
  pen.fillStyle = colours[0]; pen.beginPath(); pen.arc(hx, hy, 8, 0, 7); pen.fill();
}
function show(now) {
  if (playing) clock += Math.min(0.1, (now - last) / 1000);
  last = now;
  const frame = Math.floor(clock * 20) % frames;
  canvases.forEach((canvas, k) => draw(canvas, k, frame));
  document.body.dataset.frame = frame;
  requestAnimationFrame(show);
}
document.getElementById("clips").addEventListener("pointermove", event => {
  if (event.buttons && event.target.tagName === "CANVAS") yaw += event.movementX / 100;
});
document.getElementById("pause").onclick = event => {
  playing = !playing;
  event.target.textContent = playing ? "Pause" : "Play";
};
document.getElementById("key").onchange = async event => {
  const key = JSON.parse(await event.target.files[0].text());
  const called = (kind, guess) =>
    guesses.filter((g, k) => key[k + 1].kind === kind && g.value === guess).length;
  const head = ["?", ...given.kinds].map(kind => `<th>called ${kind}</th>`).join("");
  const rows = given.kinds.map(kind => `<tr><th>${kind}</th>` +
    ["?", ...given.kinds].map(guess => `<td>${called(kind, guess)}</td>`).join("") + "</tr>");
  document.getElementById("result").innerHTML = `<table><tr><th></th>${head}</tr>` +
    rows.join("") + "</table>";
  guesses.forEach((g, k) => { g.parentNode.title = key[k + 1].kind + " " + key[k + 1].caption; });
};
requestAnimationFrame(show);
</script>
</html>
"""
