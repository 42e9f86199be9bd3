"""Every action by name.

To add one: write a function ``(random, n, frames, bones)`` that returns a `Pose` and a dict of
``(n,)`` parameters, add it to `MAKERS`, and give it captions in captions.py.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from data_synth import in_place, jumping, locomotion
from data_synth.body import Made

Maker = Callable[[np.random.Generator, int, int, NDArray], Made]

MAKERS: dict[str, Maker] = {
    "walk": locomotion.walk,
    "run": locomotion.run,
    "walk_curve": locomotion.walk_curve,
    "walk_backward": locomotion.walk_backward,
    "sidestep": locomotion.sidestep,
    "walk_and_wave": locomotion.walk_and_wave,
    "jump": jumping.jump,
    "squat": in_place.squat,
    "wave": in_place.wave,
    "reach": in_place.reach,
    "idle": in_place.idle,
}
"""Name of each action and what makes it; the order is part of what a seed means."""
