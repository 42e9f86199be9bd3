"""What the shipped prior generates: one row of poses for every action, and one for a wish."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from data_synth import ACTIONS, held_out
from projflow_lite.constraints import Wish, pin
from projflow_lite.exchange.pictures import contact_sheet, film
from projflow_lite.motion import Motion
from projflow_lite.prior import Prior
from projflow_lite.samplers import sample

SHOWN = (
    "walk", "run", "sneak", "walk_turn", "jump", "hop", "sit", "lunge", "kick", "throw", "wave",
    "walk_and_carry",
)  # fmt: skip
"""Actions on the small sheet."""


def heart(frames: int, centre: tuple[float, float] = (-0.38, 1.28), size: float = 0.2) -> NDArray:
    """A heart in the x-y plane, ``(frames, 2)`` metres, drawn once."""
    s = np.linspace(0, 2 * np.pi, frames)
    x = np.sin(s) ** 3
    y = (13 * np.cos(s) - 5 * np.cos(2 * s) - 2 * np.cos(3 * s) - np.cos(4 * s)) / 16
    return np.stack([centre[0] + size * x, centre[1] + size * y], axis=1)


def heart_wish(frames: int = 60) -> Wish:
    """The right wrist draws a heart in front of the body; its depth is left free."""
    return pin("right_wrist", None, heart(frames), axes="xy")


def run(prior: Prior, folder: Path, frames: int = 60, seed: int = 0) -> list[Path]:
    """Draw every action, generated and synthetic, a dozen of them, and a wish.

    The files are ``all_actions.png`` (generated), ``data.png`` (synthetic), ``actions.png`` (the
    generated ones of `SHOWN`) and ``heart.gif``.

    Args:
        prior: what generates.
        folder: where the pictures go.
        frames: length of every motion.
        seed: of the samples; nothing is picked by hand.
    """
    folder.mkdir(parents=True, exist_ok=True)
    prompts, data = [], []
    for number, action in enumerate(ACTIONS):
        clip = held_out(1, frames, number, [action])
        prompts.append(clip.captions[0])
        data.append(Motion(clip.positions[0], clip.captions[0]))
    batch = sample(prior, prompt=prompts, frames=frames, batch=len(prompts), seed=seed)
    wished = sample(
        prior, heart_wish(frames), "a person waves with the right hand", frames, seed=seed
    )
    prompts.append(f"{wished.prompt}; its wrist is pinned to a heart (dots)")
    made = [*batch, wished]
    contact_sheet(made, folder / "all_actions.png", titles=prompts, columns=2)
    few = [ACTIONS.index(name) for name in SHOWN]
    titles = [prompts[k] for k in few]
    contact_sheet([made[k] for k in few], folder / "actions.png", titles=titles, columns=2)
    contact_sheet(data, folder / "data.png", columns=2)
    film(wished, folder / "heart.gif", yaw=15, trail="right_wrist")
    names = ("actions.png", "all_actions.png", "data.png", "heart.gif")
    return [folder / name for name in names]
