"""What widgets that answer with a motion share: when to begin, and where to say how it went."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Callable
from typing import Any


class Later:
    """Calls a function once things have settled: only the newest of many wishes is answered.

    While Python is busy, messages of the page wait in line. Each asks again, and each takes the
    place of the one before it; so however many there were, they make one motion.

    Args:
        seconds: how long nothing new must have come.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._waiting: asyncio.TimerHandle | None = None

    def call(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Call a function soon, instead of whatever still waits; without a loop at once."""
        try:
            loop = asyncio.get_running_loop()
        except RuntimeError:  # a plain script or a test: no loop to wait in
            function(*arguments)
            return
        self.forget()
        self._waiting = loop.call_later(self.seconds, function, *arguments)

    def forget(self) -> None:
        """Call nothing of what still waits."""
        if self._waiting is not None:
            self._waiting.cancel()


def status_line(text: str, kind: str = "") -> str:
    """A line below a widget, which screen readers read out: any text, as HTML.

    Args:
        text: what to say.
        kind: "pf-busy" or "pf-bad" for a colour.
    """
    return f'<div class="pf-status {kind}" role="status">{html.escape(text)}</div>'
