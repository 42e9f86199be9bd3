"""Two things at once: walk, and do something with the hands."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data_synth.body import Made
from data_synth.curves import coin
from data_synth.hands import hold_with_both, point_with, wave_hands
from data_synth.locomotion import walk


def walk_and_wave(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk straight ahead and wave one hand."""
    pose, drawn = walk(random, n, frames, bones)
    side = coin(random, n)
    wave_hands(random, pose, side, frames, bones)
    return pose, {**drawn, "side": side[:, 0]}


def walk_and_point(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk straight ahead and point with one hand."""
    pose, drawn = walk(random, n, frames, bones)
    side = coin(random, n)
    kind = point_with(random, pose, side, frames, bones)
    return pose, {**drawn, "side": side[:, 0], "kind": kind}


def walk_and_carry(random: np.random.Generator, n: int, frames: int, bones: NDArray) -> Made:
    """Walk straight ahead and carry something with both hands."""
    pose, drawn = walk(random, n, frames, bones)
    hold_with_both(random, pose, bones)
    return pose, drawn
