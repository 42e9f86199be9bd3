"""A walk from a dozen numbers: footsteps planned, the body carried over them, and what follows."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from data_synth.angles import joint_angles
from data_synth.body import TOE_HEIGHT, assemble, sample_bones, standing_height
from data_synth.gait import MARGIN, Gait, Path, path_of, walk_over
from projflow_lite.scores import foot_skating
from projflow_lite.skeleton import FEET, FPS

FRAMES = 60
PHASE = 0.1
"""Where in the cycle of its left foot a walk begins: that foot has just come down."""
PELVIS, LEFT, RIGHT = 0, 0, 1


class Slider(NamedTuple):
    """What a slider offers, and what it is called."""

    low: float
    high: float
    step: float
    name: str


SLIDERS = {
    "speed": Slider(0.3, 3.6, 0.1, "speed, m/s"),
    "cadence": Slider(0.9, 3.2, 0.01, "cadence, steps/s"),
    "stride": Slider(0.3, 2.4, 0.01, "stride, m"),
    "duty": Slider(0.28, 0.66, 0.01, "stance, share"),
    "lift": Slider(2, 30, 1, "foot lift, cm"),
    "width": Slider(4, 24, 1, "step width, cm"),
    "crouch": Slider(0, 25, 1, "crouch, cm"),
    "lean": Slider(-5, 35, 1, "lean, °"),
    "bob": Slider(0, 12, 0.5, "bob, cm"),
    "sway": Slider(0, 10, 0.5, "sway, cm"),
    "arms": Slider(0, 60, 1, "arm swing, °"),
    "slip": Slider(0, 40, 5, "slip, %"),
}

PRESETS: dict[str, Settings] = {
    "walk": {
        "speed": 1.2, "cadence": 1.8, "duty": 0.58, "lift": 7, "width": 10, "crouch": 1,
        "lean": 2, "bob": 2, "sway": 4, "arms": 10,
    },
    "stroll": {
        "speed": 0.6, "cadence": 1.3, "duty": 0.62, "lift": 6, "width": 12, "crouch": 1,
        "lean": 0, "bob": 1.5, "sway": 5, "arms": 6,
    },
    "run": {
        "speed": 3.0, "cadence": 2.7, "duty": 0.33, "lift": 22, "width": 12, "crouch": 9,
        "lean": 10, "bob": 9, "sway": 1.5, "arms": 16,
    },
    "sneak": {
        "speed": 0.5, "cadence": 1.15, "duty": 0.63, "lift": 15, "width": 14, "crouch": 18,
        "lean": 26, "bob": 2, "sway": 4, "arms": 6,
    },
}  # fmt: skip
"""Numbers that belong together; without slip, and with the stride that follows."""


Settings = dict[str, float]
"""Places of the sliders, by the names of `SLIDERS`."""


class Walk(NamedTuple):
    """A walk made from the sliders.

    Attributes:
        positions: ``(frames, 22, 3)`` metres.
        stands: ``(frames, 2)`` whether the plan has the left and the right foot on the floor.
        lowered: how far the pelvis is below what was asked for, metres: legs have a length.
    """

    positions: NDArray[np.float64]
    stands: NDArray[np.bool_]
    lowered: float


def make_walk(settings: Settings, phase: float = PHASE, frames: int = FRAMES) -> Walk:
    """Make a straight walk.

    Args:
        settings: the numbers of `SLIDERS`, in their units; the stride follows from the others.
        phase: where in the cycle of the left foot it begins, 0..1.
        frames: its length.
    """
    x = walks(settings, np.array([phase]), frames)[0]
    asked = standing_height(one_body())[0] - settings["crouch"] / 100
    stands = cycle_of(settings, phase, frames) < settings["duty"]
    return Walk(x, stands, float(asked - x[:, PELVIS, 1].mean()))


def walks(settings: Settings, phases: NDArray, frames: int = FRAMES) -> NDArray[np.float64]:
    """The same walk begun at different places of its cycle, ``(n, frames, 22, 3)`` metres."""
    bones = np.repeat(one_body(), len(phases), axis=0)
    slip = settings.get("slip", 0.0) / 100
    path = straight((1 - slip) * settings["speed"], len(phases), frames)
    x = assemble(walk_over(gait_of(settings, phases), path, bones), bones)
    # The mistake: the body, feet and all, goes further than its steps carry it.
    x[..., 2] += slip * settings["speed"] * np.arange(frames)[:, None] / FPS
    return x


def one_body() -> NDArray[np.float64]:
    """Bones of one body, ``(1, 22, 3)``, always the same."""
    return sample_bones(np.random.default_rng(0), 1)


def gait_of(settings: Settings, phases: NDArray) -> Gait:
    """The sliders as the generator takes them; what no slider moves suits the speed."""
    running, speed = settings["duty"] < 0.5, settings["speed"]
    given: dict[str, Any] = {
        "cadence": settings["cadence"],
        "duty": settings["duty"],
        "width": settings["width"] / 100,
        "lift": settings["lift"] / 100,
        "bob": settings["bob"] / 200,
        "sway": settings["sway"] / 200,
        "surge": 0.007 if running else 0.0095 * speed,
        "jolt": 0.005 if running else 0.0045 * speed,
        "pitch": 0.9 if running else min(0.5 + 0.45 * speed, 1.2),
        "swing": np.radians(settings["arms"]),
        "elbow": 1.4 if running else 0.4,
        "arms_out": 0.12,
        "lean": np.radians(settings["lean"]),
        "crouch": settings["crouch"] / 100,
    }
    each: dict[str, Any] = {k: np.full(len(phases), value) for k, value in given.items()}
    gait = Gait(**each, phase=phases)
    gait.running = running
    return gait


def straight(speed: float, count: int, frames: int) -> Path:
    """Straight paths at a constant speed, m/s."""
    still = np.zeros((count, frames + 2 * MARGIN))
    return path_of(still + speed, still, still)


def cycle_of(settings: Settings, phase: float, frames: int) -> NDArray[np.float64]:
    """Where in their cycles, 0..1, the left and the right foot are, ``(frames, 2)``."""
    cycles = phase + np.arange(frames) / FPS * settings["cadence"] / 2
    return (cycles[:, None] + [0.0, 0.5]) % 1.0


def toe_speed(positions: NDArray) -> NDArray[np.float64]:
    """How fast each toe goes over the ground, ``(frames - 1, 2)`` m/s."""
    return np.linalg.norm(np.diff(positions[:, FEET][..., [0, 2]], axis=0), axis=-1) * FPS


def toe_down(positions: NDArray) -> NDArray[np.bool_]:
    """Steps from one frame to the next with a toe on the floor at both ends, ``(frames - 1, 2)``.

    At heel strike a foot stands on its heel: its toe comes down a frame or two later.
    """
    down = positions[:, FEET, 1] < TOE_HEIGHT + 0.0005
    return down[:-1] & down[1:]


def averaged(settings: Settings, spread: float, count: int = 60) -> NDArray[np.float64]:
    """The mean of walks that begin at different places of their cycle, ``(frames, 22, 3)``.

    Args:
        settings: as for `make_walk`.
        spread: over which share of the cycle the beginnings are spread, 0..1.
        count: how many walks.
    """
    phases = PHASE + spread * (np.arange(count) + 0.5) / count
    return walks(settings, phases).mean(axis=0)


def facts_of(walk: Walk, settings: Settings) -> dict[str, float]:
    """What follows from the sliders."""
    speeds, down = toe_speed(walk.positions), toe_down(walk.positions)
    duty = settings["duty"]
    return {
        "both": max(0.0, 2 * duty - 1),
        "none": max(0.0, 1 - 2 * duty),
        "stance": 2 * duty / settings["cadence"],
        "slide": float(speeds[down].max(initial=0.0)),
        "skating": float(foot_skating(walk.positions)),
        "lowered": walk.lowered,
        "knee": float(joint_angles(walk.positions)["knee"].max()),
    }
