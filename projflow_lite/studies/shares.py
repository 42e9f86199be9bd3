"""Several processes share the cells of a study, on one machine or on several with one folder.

Torch's launcher starts them, as it does for training, and tells each who it is::

    torchrun --nproc-per-node=2 -m projflow_lite reproduce control

A cell belongs to one of them by its name. Each process measures its own, cell after cell, and then
waits for the files of the others; so all end with the same numbers, and the first one writes them.
"""

from __future__ import annotations

import os
import time
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

LOOK_AGAIN = 0.2
"""Seconds between two looks for a file that another process is to write."""


def processes() -> tuple[int, int]:
    """The number of this process, from 0, and how many there are."""
    return int(os.environ.get("RANK", 0)), int(os.environ.get("WORLD_SIZE", 1))


def is_first() -> bool:
    """Whether this process is the one that prints and writes what was found."""
    return processes()[0] == 0


def is_mine(path: Path) -> bool:
    """Whether a cell is measured by this process.

    Its name decides, not its place in a list: neighbours in a list are alike, and one process
    would get all the slow ones.
    """
    rank, count = processes()
    return zlib.crc32("/".join(path.parts[-3:]).encode()) % count == rank


def wait_for(path: Path) -> None:
    """Wait until another process has written a file."""
    while not path.exists():
        time.sleep(LOOK_AGAIN)


def take_share(jobs: Iterable[tuple[Path, Callable[[], Any]]]) -> None:
    """Do those of many jobs that are this process's own, before anybody waits for the others.

    A process that is alone has nothing to share: it does them as it comes to them.

    Args:
        jobs: the file of each, and what makes and writes it.
    """
    if processes()[1] == 1:
        return
    for path, work in jobs:
        if is_mine(path):
            work()
