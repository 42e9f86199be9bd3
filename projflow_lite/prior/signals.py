"""An interruption never falls into the middle of a training step."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def undivided() -> Iterator[None]:
    """Finish the block before a Ctrl+C, or a request to terminate, counts.

    Half a step would be worse than none: some weights moved, others not, and no run could go on
    from there exactly. Signals reach the main thread only; in another one nothing is to be done.

    Raises:
        KeyboardInterrupt: at the end, if Ctrl+C was pressed meanwhile.
        SystemExit: at the end, if the process was asked to terminate meanwhile.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []

    def remember(number: int, frame: FrameType | None) -> None:
        came.append(number)

    before = {one: signal.signal(one, remember) for one in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for one, handler in before.items():
            signal.signal(one, handler or signal.SIG_DFL)
    for number in map(signal.Signals, came):
        # By default a request to terminate ends Python at once; leave time to store the run.
        if number == signal.SIGTERM and before[number] == signal.SIG_DFL:
            raise SystemExit(128 + number)
        signal.raise_signal(number)
