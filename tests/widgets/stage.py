"""Helpers of the widget tests: a walking stick figure, a wish, and a page with a stub model."""

from __future__ import annotations

import base64
import json
from typing import NamedTuple

import numpy as np

from projflow_lite.motion import Motion
from projflow_lite.skeleton import JOINTS
from projflow_lite.widgets.standing import standing_pose

LIMBS = {  # joint it turns about, joints that turn with it, swing in radians
    "left_hip": (("left_knee", "left_ankle", "left_foot"), 0.45),
    "right_hip": (("right_knee", "right_ankle", "right_foot"), -0.45),
    "left_shoulder": (("left_elbow", "left_wrist"), -0.5),
    "right_shoulder": (("right_elbow", "right_wrist"), 0.5),
}


def walking(frames: int = 60, speed: float = 1.2, **fields) -> Motion:
    """A stiff-limbed walk along +z at `speed` metres a second."""
    positions = np.repeat(standing_pose(), frames, axis=0)
    phase = np.sin(2 * np.pi * np.arange(frames) / 20.0)
    for pivot, (followers, swing) in LIMBS.items():
        origin = positions[:, JOINTS.index(pivot)].copy()
        for name in followers:
            joint = JOINTS.index(name)
            y, z = np.moveaxis(positions[:, joint, 1:] - origin[:, 1:], -1, 0)
            c, s = np.cos(swing * phase), np.sin(swing * phase)
            positions[:, joint, 1:] = origin[:, 1:] + np.stack([c * y + s * z, c * z - s * y], -1)
    positions[..., 2] += speed * np.arange(frames)[:, None] / 20.0
    return Motion(positions, **fields)


class Markers(NamedTuple):
    joint: np.ndarray
    frame: np.ndarray
    target: np.ndarray
    std: np.ndarray


class StubWish:
    """Stands in for a wish: asks one joint to be at given places, and measures how near it is."""

    def __init__(self, joint, frames, target, std=0.0):
        k = len(frames)
        self._markers = Markers(
            np.full(k, JOINTS.index(joint)),
            np.asarray(frames),
            np.asarray(target, float),
            np.full(k, std),
        )

    def markers(self, frames):
        return self._markers

    def residual(self, positions):
        joint, frame, target, _ = self._markers
        return float(np.nanmax(np.abs(positions[..., frame, joint, :] - target)))


def wished(motion: Motion, joint="left_wrist", frames=None, off=0.0, free=(), std=0.0) -> Motion:
    """The motion with a wish for its own wrist path, missed by `off` metres along y."""
    frames = np.arange(motion.frames) if frames is None else np.asarray(frames)
    target = motion.joint(joint)[frames].copy()
    target[:, 1] += off
    target[:, list(free)] = np.nan
    return Motion(motion.positions, motion.prompt, StubWish(joint, frames, target, std))


STUB = """
class StubModel {
  constructor(state) { this.state = state; this.listeners = {}; this.saves = []; this.pending = {}; }
  get(name) { return this.state[name]; }
  set(name, value) {
    if (this.state[name] === value) return;
    this.state[name] = value;
    this.pending[name] = value;
    (this.listeners["change:" + name] ?? []).forEach((listener) => listener());
  }
  save_changes() {
    if (Object.keys(this.pending).length) this.saves.push(this.pending);
    this.pending = {};
  }
  on(name, listener) { (this.listeners[name] ??= []).push(listener); }
  off(name, listener) {
    this.listeners[name] = (this.listeners[name] ?? []).filter((other) => other !== listener);
  }
}
const decode = (text) => {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const padded = new Uint8Array(bytes.length + 3); // as in Jupyter: a view at an odd offset
  padded.set(bytes, 3);
  return new DataView(padded.buffer, 3);
};
const revive = (state) => Object.fromEntries(Object.entries(state).map(([name, value]) =>
  [name, value && value.base64 !== undefined ? decode(value.base64) : value]));
window.mount = async (code, state) => {
  const address = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
  const { default: widget } = await import(address);
  window.model = new StubModel(revive(state));
  window.unmount = await widget.render({ model: window.model, el: document.getElementById("here") });
};
window.update = (state) => {
  for (const [name, value] of Object.entries(revive(state))) window.model.set(name, value);
  window.model.pending = {};
};
window.sent = (name) => {
  const view = window.model.get(name);
  return Array.from(new Float32Array(view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength)));
};
"""
DARK = """
body { background: #111; --jp-layout-color0: #111111; --jp-layout-color1: #212121;
  --jp-ui-font-color1: rgba(255,255,255,1); --jp-ui-font-color2: rgba(255,255,255,.7);
  --jp-border-color1: #616161; --jp-brand-color1: #2196f3; }
"""


def encode(state: dict) -> dict:
    """The public traits as JSON, bytes as base64: what a page with stored state would hold."""
    plain = {}
    for name, value in state.items():
        if not name.startswith("_") and name not in {"layout", "comm", "keys", "log"}:
            is_bytes = isinstance(value, bytes | memoryview)
            plain[name] = {"base64": base64.b64encode(value).decode()} if is_bytes else value
    return json.loads(json.dumps(plain, default=str))


def mount(page, widget, dark: bool = False, padding: int = 10) -> None:
    """Show a widget in a blank page, without Jupyter."""
    style = f"<style>{widget._css}\nbody {{ margin: {padding}px; }}{DARK if dark else ''}</style>"
    page.set_content(
        f"<!doctype html><html lang='en'><title>widget</title>{style}<div id='here'></div>"
    )
    page.evaluate(f"{STUB}; undefined")
    page.evaluate(
        "([code, state]) => mount(code, state)", [widget._esm, encode(widget.get_state())]
    )
    page.wait_for_timeout(120)


def update(page, widget, *names: str) -> None:
    """Send the named traits to the page, as one message from the kernel would."""
    page.evaluate("(state) => update(state)", encode({n: getattr(widget, n) for n in names}))
    page.wait_for_timeout(80)


def picture(page) -> list[int]:
    """The pixels of the canvas, thinned out, to see whether the picture changed."""
    return page.evaluate(
        """() => { const canvas = document.querySelector("canvas");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return Array.from(data).filter((_, i) => i % 4 === 1 && (i >> 2) % 7 === 0); }"""
    )


def changed(before: list[int], after: list[int]) -> int:
    """How many of the sampled pixels differ clearly."""
    assert len(before) == len(after)
    return sum(abs(a - b) > 12 for a, b in zip(before, after, strict=True))


def count_colour(page, colour: tuple[int, int, int], tolerance: int = 6) -> int:
    """How many pixels of the canvas have a colour."""
    return page.evaluate(
        """([colour, tolerance]) => { const canvas = document.querySelector("canvas");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let count = 0;
        for (let i = 0; i < data.length; i += 4) {
          if (colour.every((value, k) => Math.abs(data[i + k] - value) <= tolerance)) count += 1;
        }
        return count; }""",
        [list(colour), tolerance],
    )


CONTRAST = """(node) => {
  const parse = (text) => text.match(/[0-9.]+/g).map(Number);
  const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const light = (rgb) => rgb.map((v) => linear(v / 255))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const text = parse(getComputedStyle(node).color);
  while (parse(getComputedStyle(node).backgroundColor)[3] === 0) node = node.parentElement;
  const back = parse(getComputedStyle(node).backgroundColor).slice(0, 3);
  const alpha = text[3] ?? 1;
  const seen = back.map((value, i) => text[i] * alpha + value * (1 - alpha));
  const [low, high] = [light(seen), light(back)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}"""


def contrast(page, selector: str) -> float:
    """WCAG contrast of an element's text against the first opaque background behind it."""
    return page.locator(selector).first.evaluate(CONTRAST)
