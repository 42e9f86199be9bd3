"""How many threads torch should use: measured, for two on a busy machine are slower than one.

The threads of one operation wait for each other. Where another program has one of the processors,
all wait for the thread that shares it, several times in every layer of a network. So the number of
cores says little; a few milliseconds of trial say what holds now.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable

import torch
from torch.nn import functional

WORTH_IT = 0.85
"""More threads are taken only if they need less than this share of the time of fewer."""


def use_fastest_threads(work: Callable[[], object] | None = None) -> int:
    """Find out how many threads are fastest now, and let torch use that many.

    Where the variable ``OMP_NUM_THREADS`` is set, somebody has chosen: it is left at that.

    Args:
        work: what should be fast; None for convolutions of the size of the prior's.

    Returns:
        The number of threads that torch uses from now on.
    """
    if "OMP_NUM_THREADS" not in os.environ:
        torch.set_num_threads(fastest_threads(work or convolutions()))
    return torch.get_num_threads()


def fastest_threads(
    work: Callable[[], object], most: int | None = None, turns: int = 7, longest: float = 0.5
) -> int:
    """Number of threads with which `work` is fastest: 1, 2, 4 and so on.

    Numbers take turns, and each is judged by its median: it is the usual wait that people feel.
    In doubt fewer win, for they leave the other processors alone.

    Args:
        work: what should be fast; a few milliseconds at most.
        most: largest number to try; None for the number of cores.
        turns: how often each is tried.
        longest: seconds after which no new turn begins.
    """
    before = torch.get_num_threads()
    most = most or os.cpu_count() or 1
    numbers = [n for n in (1, 2, 4, 8, 16) if n <= most]
    seconds: dict[int, list[float]] = {n: [] for n in numbers}
    end = time.perf_counter() + longest
    try:
        for _ in range(turns):
            for n in numbers:
                torch.set_num_threads(n)
                work()  # wakes the threads up
                start = time.perf_counter()
                work()
                seconds[n].append(time.perf_counter() - start)
            if time.perf_counter() > end:
                break
    finally:
        torch.set_num_threads(before)
    return choose({n: statistics.median(times) for n, times in seconds.items()})


def choose(seconds: dict[int, float]) -> int:
    """The number of threads to take, given the time of each, fewest first."""
    best = min(seconds)
    for n in sorted(seconds):
        if seconds[n] < WORTH_IT * seconds[best]:
            best = n
    return best


def convolutions() -> Callable[[], object]:
    """A few convolutions over time as the prior has them, to be timed: about a millisecond."""
    x, weight = torch.zeros(1, 192, 30), torch.zeros(192, 192, 5)

    def work() -> torch.Tensor:
        y = x
        with torch.inference_mode():
            for _ in range(4):
                y = functional.conv1d(y, weight, padding=2)
        return y

    return work
