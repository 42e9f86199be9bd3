"""Every action by name.

To add one: write a function ``(random, n, frames, bones)`` that returns a `Pose` and a dict of
``(n,)`` parameters, add it to `MAKERS`, and give it captions in captions.py.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from data_synth import combined, hands, hopping, in_place, jumping, locomotion, turning
from data_synth.body import Made

Maker = Callable[[np.random.Generator, int, int, NDArray], Made]

MAKERS: dict[str, Maker] = {
    "walk": locomotion.walk,
    "run": locomotion.run,
    "jog": locomotion.jog,
    "sneak": locomotion.sneak,
    "walk_backward": locomotion.walk_backward,
    "sidestep": locomotion.sidestep,
    "walk_curve": turning.walk_curve,
    "walk_turn": turning.walk_turn,
    "walk_start": locomotion.walk_start,
    "walk_stop": locomotion.walk_stop,
    "march": locomotion.march,
    "turn": turning.turn_on_spot,
    "jump": jumping.jump,
    "hop": hopping.hop,
    "squat": in_place.squat,
    "sit": in_place.sit,
    "bow": in_place.bow,
    "lunge": in_place.lunge,
    "kick": in_place.kick,
    "balance": in_place.balance,
    "wave": hands.wave,
    "reach": hands.reach,
    "point": hands.point,
    "clap": hands.clap,
    "throw": hands.throw,
    "punch": hands.punch,
    "carry": hands.carry,
    "draw": hands.draw,
    "raise_arms": hands.raise_arms,
    "walk_and_wave": combined.walk_and_wave,
    "walk_and_point": combined.walk_and_point,
    "walk_and_carry": combined.walk_and_carry,
    "sway": in_place.sway,
    "idle": in_place.idle,
}
"""Name of each action and what makes it; the order is part of what a seed means."""
