"""How a sampler goes through flow time: in how many steps, at which times, and by which solver."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import torch

from projflow_lite.samplers.euler import multistep
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.skeleton import number_array, shown


class Pace(NamedTuple):
    """What a method does if nobody says how many steps, or which.

    Attributes:
        steps: how many.
        power: of the spacing, see `flow_times`.
        solver: a name of `SOLVERS`.
        eta: share of fresh noise, for a method that mixes some; None for the method's own.
    """

    steps: int = 25
    power: int = 2
    solver: str = "euler"
    eta: float | None = None

    def times(self, steps: int | Sequence[float] | None = None) -> list[float]:
        """Flow times of so many steps, or of as many as usual; or the given times."""
        return flow_times(self.steps if steps is None else steps, self.power)


QUICK = Pace(10, 3, "multistep", eta=0.0)
"""Ten calls of the network that keep the quality of a hundred, without a wish and with one, and no
fresh noise: see ``projflow-lite reproduce fewer-steps``, which compares spacings, solvers and
noise."""

SOLVERS: dict[str, Callable[[Velocity, Sequence[float]], Velocity]] = {
    "euler": lambda velocity, times: velocity,
    "multistep": multistep,
}
"""From a velocity field and the times of the steps to the field whose Euler steps are made."""


def flow_times(steps: int | Sequence[float], power: int = 2) -> list[float]:
    r"""Flow times from 0 to 1: the given ones, or :math:`t_k = 1 - (1 - k/T)^p` for T steps.

    The noise is a metre wide and a body's details are millimetres, so most is decided late:
    `projflow-lite reproduce fewer-steps` compares these times with even ones.

    Args:
        steps: how many steps, or all times.
        power: 1 spaces times evenly; the higher, the shorter the last steps.

    Raises:
        ValueError: if times do not rise from 0 to 1.
    """
    whole = isinstance(steps, int | np.integer) and not isinstance(steps, bool)
    if whole and int(steps) >= 1:  # type: ignore[arg-type]
        even = torch.linspace(0, 1, int(steps) + 1, dtype=torch.float64)  # type: ignore[arg-type]
        return (1 - (1 - even).pow(power)).tolist()
    given = number_array(steps, "sample: steps") if np.ndim(steps) == 1 else np.zeros(0)
    times = given.astype(float).tolist()
    rising = all(a < b for a, b in itertools.pairwise(times))
    if len(times) < 2 or times[0] != 0 or times[-1] != 1 or not rising:
        raise ValueError("sample: steps is a whole number, or flow times that rise from 0 to 1")
    return times


def check_solver(solver: str | None, method: str, pace: Pace) -> None:
    """Refuse a solver that is none, or that a method does not know."""
    if solver is not None and (not isinstance(solver, str) or solver not in SOLVERS):
        raise ValueError(f"sample: solver is one of {', '.join(SOLVERS)}, not {shown(solver)}")
    if solver not in (None, "euler", pace.solver):
        raise ValueError(
            f"sample: {method} makes Euler's steps and has no use for solver='{solver}'; leave it "
            "out, or take projflow"
        )
