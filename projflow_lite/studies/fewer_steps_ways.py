"""The ways to sample that the study of fewer steps compares."""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

import torch
from numpy.typing import NDArray

from data_synth import Clips
from projflow_lite.prior import Prior
from projflow_lite.prior.model import Text
from projflow_lite.samplers.euler import euler, multistep
from projflow_lite.samplers.projflow import Velocity, projflow
from projflow_lite.studies.keyframes import through_keyframes

STEPS, QUICK_STEPS = (5, 10, 15, 25, 50, 100), (5, 10, 50)

WISHES = (("pelvis", 5), ("left_wrist", 1))
"""Joint and number of keyframes."""


class Reading(NamedTuple):
    """What a step with a wish does beside the flow: the noise it mixes, and how it projects.

    Attributes:
        noise, eta: see `projflow_lite.samplers.projflow`.
        metric: "kinematic", with guides, or "moving", see `projflow_lite.samplers.sample`.
    """

    noise: str = ""
    eta: str | float = ""
    metric: str = ""


PARAMETERS = inspect.signature(projflow).parameters
DEFAULT = Reading(PARAMETERS["noise"].default, PARAMETERS["eta"].default, "kinematic")
READINGS = (
    DEFAULT, DEFAULT._replace(metric="moving"), DEFAULT._replace(eta="ddpm"),
    DEFAULT._replace(eta=0.0), DEFAULT._replace(noise="original"),
)  # fmt: skip
"""What is compared; as in the paper first."""


def heun(velocity: Velocity, times: Sequence[float]) -> Velocity:
    """The mean of the velocities at both ends of a step; the last step, up to 1, is Euler's."""
    following = dict(itertools.pairwise(times))

    def field(x_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
        v, t_next = velocity(x_t, t, text), following[t]
        if t_next == 1:
            return v
        return (v + velocity(x_t + (t_next - t) * v, t_next, text)) / 2

    return field


def midpoint(velocity: Velocity, times: Sequence[float]) -> Velocity:
    """The velocity in the middle of a step."""
    following = dict(itertools.pairwise(times))

    def field(x_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
        half = (following[t] - t) / 2
        return velocity(x_t + half * velocity(x_t, t, text), t + half, text)

    return field


SCHEDULES: dict[str, Callable[[float], float]] = {
    "even": lambda u: u,
    "quadratic": lambda u: 1 - (1 - u) ** 2,
    "cubic": lambda u: 1 - (1 - u) ** 3,
}
"""Flow time after the share `u` of all steps."""

SOLVERS: dict[str, Callable[[Velocity, Sequence[float]], Velocity]] = {
    "Euler": lambda velocity, times: velocity,
    "multistep": multistep,
    "Heun": heun,
    "midpoint": midpoint,
}
"""From a velocity field and the times of the steps to a field whose Euler steps are better."""


class Way(NamedTuple):
    """One way to sample. Without a joint there is no wish, and eq. 9 plays no part."""

    schedule: str
    solver: str
    steps: int
    joint: str = ""
    keyframes: int = 0
    noise: str = ""
    eta: str | float = ""
    metric: str = ""

    @property
    def times(self) -> list[float]:
        """Flow times from 0 to 1."""
        return [SCHEDULES[self.schedule](k / self.steps) for k in range(self.steps + 1)]

    @property
    def calls(self) -> int:
        """How often the network is asked."""
        return {"Heun": 2 * self.steps - 1, "midpoint": 2 * self.steps}.get(self.solver, self.steps)

    @property
    def task(self) -> str:
        """What is asked for, in words."""
        plural = "" if self.keyframes == 1 else "s"
        return f"{self.joint}, {self.keyframes} keyframe{plural}" if self.joint else "no wish"


FINE = Way("cubic", "midpoint", 100)
"""As close to the flow as is affordable."""


TO_THE_END = (DEFAULT, DEFAULT._replace(metric="moving"), DEFAULT._replace(eta=0.0))
"""Readings that are taken to the largest number of steps, and with other solvers than Euler's."""


def all_ways(quick: bool = False) -> list[Way]:
    """Everything that is measured; only Euler's steps are taken to the largest number.

    Without a wish: every spacing, with solvers of one call a step; those of two with cubic times.
    With one: quadratic times, as the other tables have; for three readings cubic ones as well.
    """
    steps = QUICK_STEPS if quick else STEPS
    twice = [count for count in steps if 4 * count <= steps[-1]]
    one_call: dict[str, Sequence[int]] = {"Euler": steps, "multistep": steps[:-1]}
    two_calls: dict[str, Sequence[int]] = {"Heun": twice, "midpoint": twice}
    found = [Way(*how) for how in crossed(SCHEDULES, one_call) + crossed(["cubic"], two_calls)]
    for wish, reading in itertools.product(WISHES[:1] if quick else WISHES, READINGS):
        told = reading in TO_THE_END
        counts: dict[str, Sequence[int]] = one_call if told else {"Euler": steps[:-1]}
        hows = crossed(["quadratic"], counts | (two_calls if reading == DEFAULT else {}))
        if reading in TO_THE_END:
            hows += crossed(["cubic"], dict.fromkeys(one_call, twice))
        found += [Way(*how, *wish, *reading) for how in hows]
    return found


def crossed(
    schedules: Iterable[str], counts: Mapping[str, Sequence[int]]
) -> list[tuple[str, str, int]]:
    """Every schedule with every solver, at the numbers of steps given for that solver."""
    return [(s, solver, count) for s in schedules for solver in counts for count in counts[solver]]


class Counted:
    """A velocity field that counts how often it is asked."""

    def __init__(self, velocity: Velocity) -> None:
        self.velocity, self.calls = velocity, 0

    def __call__(self, x_t: torch.Tensor, t: float, text: Text = None) -> torch.Tensor:
        """Velocity at ``(batch, frames, 22, 3)``."""
        self.calls += 1
        return self.velocity(x_t, t, text)


def make(prior: Prior, way: Way, clips: Clips, seed: int) -> tuple[NDArray, int]:
    """A motion for every clip, from its prompt and, if there is a wish, its keyframes.

    The noise of the start depends on the seed alone, and so is the same for all ways.

    Returns:
        ``(clips, frames, 22, 3)`` metres, and the number of network calls.
    """
    network = Counted(prior)
    velocity = SOLVERS[way.solver](network, way.times)
    generator = torch.Generator().manual_seed(seed)
    x0 = prior.noise_std * torch.randn(clips.positions.shape, generator=generator)
    with torch.inference_mode():
        if not way.joint:
            x1 = euler(velocity, x0, way.times, clips.captions)
        else:
            project = through_keyframes(clips.positions, way.joint, way.keyframes, way.metric)
            x1 = projflow(
                velocity, project, x0, way.times, generator, clips.captions,
                noise=way.noise, eta=way.eta, noise_std=prior.noise_std,
            )  # fmt: skip
    return x1.numpy(), network.calls
