"""What the study of GMD compares: priors, ways to lead them, keyframes and obstacles."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from data_synth import Clips, held_out
from projflow_lite.constraints import Wish, pin
from projflow_lite.prior import Prior
from projflow_lite.prior.emphasis import EmphasisedPrior, load_emphasised
from projflow_lite.prior.trajectory import TrajectoryModel, load_trajectory_model
from projflow_lite.samplers import Avoid, ProjectionStep, euler, flow_times, projflow
from projflow_lite.samplers.gmd import Metres, draw_noise, gmd
from projflow_lite.samplers.gmd_imputation import GROUND, Imputation
from projflow_lite.samplers.gmd_keyframes import gmd_keyframes
from projflow_lite.skeleton import N_JOINTS
from projflow_lite.studies.keyframes import FRAMES, keyframes

STEPS = 25
DENSITIES, QUICK_DENSITIES = (1, 2, 5, 15, FRAMES), (5, FRAMES)
"""Keyframes of 60: one, two, five, 25 % and 100 %."""

TAUS, QUICK_TAUS = (0.0, 0.25, 0.5, 0.75, 1.0), (0.0, 0.5, 1.0)
SCALES, QUICK_SCALES = (10.0, 20.0, 40.0, 80.0), (10.0, 40.0)

WALKS = ("walk", "jog", "walk_and_carry", "walk_and_wave")
POST, MARGIN, FAR = 0.3, 0.05, 1.4
"""Radius of the obstacle, how far to stay away, and how far a walk leads at least; metres."""


class Models(NamedTuple):
    """The priors of the study.

    Attributes:
        plain: on motions in metres.
        emphasised: on projected motions, by c.
        planner: of trajectories.
    """

    plain: Prior
    emphasised: dict[float, EmphasisedPrior]
    planner: TrajectoryModel


def load_models(plain: Prior) -> Models:
    """The shipped priors beside a plain one: c = 10, and c = 1 if it is shipped as well."""
    emphasised = {10.0: load_emphasised(c=10)}
    with contextlib.suppress(FileNotFoundError):
        emphasised[1.0] = load_emphasised(c=1)
    return Models(plain, emphasised, load_trajectory_model())


class How(NamedTuple):
    """One method.

    Attributes:
        c: emphasis of the prior; 0 for the plain one.
        pull: strength of the guidance towards keyframes, see `gmd`.
        plan: what the second stage follows: nothing, straight "lines", or the "model" of
            trajectories, which the lines lead before tau.
        along: whether bodies go along with an imputed pelvis; None: if the prior's features say so.
    """

    c: float = 0.0
    pull: float = 0.0
    plan: str = ""
    along: bool | None = None


PULL = {0: 20.0, 10: 5.0}
"""Strength of the guidance towards keyframes, by c. Under emphasis 20 overshoots: sixteen walks,
`walks(16, 2500)`, miss five keyframes by 12.2 cm without, by 5.5, 5.4 and 8.2 cm at 5, 10, 20."""

FREE, PROJFLOW = "no control", "ProjFlow"
TWO_STAGES = "emphasis, guidance, two stages"
HOWS = {
    FREE: How(),
    "imputation": How(),
    "imputation, body along": How(along=True),
    "imputation and guidance": How(pull=PULL[0]),
    "mixing (c = 1)": How(c=1),
    "emphasis": How(c=10),
    "emphasis, guidance": How(c=10, pull=PULL[10]),
    "emphasis, guidance, lines": How(c=10, pull=PULL[10], plan="lines"),
    TWO_STAGES: How(c=10, pull=PULL[10], plan="model"),
    PROJFLOW: How(),
}
"""What every way with keyframes may be. All but the last impute."""


class Way(NamedTuple):
    """One way to meet some keyframes, perhaps around an obstacle: a line of the table."""

    task: str
    method: str
    keys: int
    tau: float = 0.5
    scale: float = 0.0

    @property
    def name(self) -> str:
        """A name for files."""
        parts = (self.task, self.method, self.keys, self.tau, self.scale)
        return "_".join(str(part) for part in parts).replace(", ", "-").replace(" ", "-")


def all_ways(models: Models, quick: bool = False) -> list[Way]:
    """Everything that is measured: over density, over tau, and around obstacles."""
    methods = [name for name, how in HOWS.items() if not how.c or how.c in models.emphasised]
    led = [name for name in methods if name != FREE]
    densities = QUICK_DENSITIES if quick else DENSITIES
    ways = [Way("keyframes", FREE, keys) for keys in densities[-1:]]
    ways += [Way("keyframes", name, keys) for keys in densities for name in led]
    for name in ("emphasis, guidance, lines", TWO_STAGES):
        if not quick or name == TWO_STAGES:
            ways += [Way("tau", name, 5, tau) for tau in (QUICK_TAUS if quick else TAUS)]
    ways += [Way("obstacle", PROJFLOW, 1)]
    for name in ("imputation and guidance", "emphasis, guidance", TWO_STAGES):
        ways += [
            Way("obstacle", name, 1, scale=scale) for scale in (QUICK_SCALES if quick else SCALES)
        ]
    return ways


def frames_of(way: Way) -> NDArray[np.int64]:
    """Which frames are pinned: with an obstacle the last one."""
    return np.array([FRAMES - 1]) if way.task == "obstacle" else keyframes(way.keys)


def walks(clips: int, seed: int) -> Clips:
    """Held-out walks that lead far enough for an obstacle to stand in the middle."""
    made = held_out(4 * clips, FRAMES, seed, actions=WALKS)
    track = made.positions[:, :, 0][..., GROUND]
    far = np.linalg.norm(track[:, -1] - track[:, 0], axis=-1) > FAR
    far &= (post_of(made).depth(made.positions)[:, [0, -1]] == 0).all(1).numpy()
    chosen = np.flatnonzero(far)[:clips]
    if len(chosen) < clips:
        raise ValueError(f"gmd_table: only {len(chosen)} of {clips} walks lead far enough")
    return Clips(
        made.positions[chosen],
        [made.captions[k] for k in chosen],
        [made.actions[k] for k in chosen],
        {},
    )


def post_of(clips: Clips) -> Avoid:
    """A post in the way of every clip, where its pelvis is in the middle of its time."""
    middle = torch.as_tensor(clips.positions[:, FRAMES // 2, 0][..., GROUND])

    def distance(points: torch.Tensor) -> torch.Tensor:
        """Distance of ``(clips, frames, 2)`` to the clip's own post."""
        away = points - middle.unsqueeze(1).to(points)
        return torch.linalg.vector_norm(away, dim=-1) - POST

    return Avoid(distance, MARGIN)


def make(models: Models, way: Way, clips: Clips, seed: int) -> tuple[NDArray, float]:
    """A motion for every clip, from its prompt and its keyframes.

    The noise of the start depends on the seed and the prior alone.

    Returns:
        ``(clips, frames, 22, 3)`` metres, and the seconds that one motion took.
    """
    how = HOWS[way.method]
    flow: Any = models.emphasised[how.c] if how.c else models.plain
    space = flow if how.c else Metres()
    generator = torch.Generator().manual_seed(seed)
    x0 = draw_noise(space, flow.noise_std, clips.positions.shape, torch.float32, generator)
    times, text = flow_times(STEPS), clips.captions
    start = time.perf_counter()
    with torch.no_grad():
        if way.method == FREE:
            x1 = euler(flow, x0, times, text)
        elif way.method == PROJFLOW:
            x1 = projflow(
                flow, projected(clips, way), x0, times, generator, text, noise_std=flow.noise_std
            )
        else:
            sampler, options = led(models, way, clips)
            options |= {"space": space, "noise_std": flow.noise_std}
            x1 = sampler(flow, known(clips, way), x0, times, generator, text, **options)
    return x1.numpy(), (time.perf_counter() - start) / len(x0)


def led(models: Models, way: Way, clips: Clips) -> tuple[Callable[..., Any], dict[str, Any]]:
    """The sampler of GMD that a way takes, and its options."""
    how = HOWS[way.method]
    options: dict[str, Any] = {"pull": how.pull, "scale": way.scale, "along": how.along}
    options["goal"] = post_of(clips) if way.scale else None
    if not how.plan:
        return gmd, options
    planner = models.planner if how.plan == "model" else None
    return gmd_keyframes, options | {"trajectory_model": planner, "switch": way.tau}


def known(clips: Clips, way: Way) -> Imputation:
    """The keyframes of every clip, x and z of its pelvis."""
    mask = torch.zeros(FRAMES, N_JOINTS, 3, dtype=torch.bool)
    for axis in GROUND:
        mask[frames_of(way), 0, axis] = True
    return Imputation(mask, torch.as_tensor(clips.positions))


def projected(clips: Clips, way: Way) -> ProjectionStep:
    """The same keyframes as rows to project onto."""
    targets = clips.positions[:, frames_of(way), 0][..., GROUND]
    step = ProjectionStep(wish_of(clips.positions[0], way), FRAMES)
    return step.aimed_at(targets.reshape(len(targets), -1))


def wish_of(positions: NDArray, way: Way) -> Wish:
    """The keyframes of one clip ``(frames, 22, 3)``."""
    frames = frames_of(way)
    return pin("pelvis", frames, positions[frames, 0][:, GROUND], axes="xz")


def targets_of(positions: NDArray, clips: Clips, way: Way) -> NDArray:
    """Where every motion should be, as `control_errors` takes it; its own height is right."""
    targets = np.full(positions.shape, np.nan)
    frames = frames_of(way)
    targets[:, frames, 0] = clips.positions[:, frames, 0]
    targets[:, frames, 0, 1] = positions[:, frames, 0, 1]
    return targets
