"""The loss of a run, step by step: a text file with a line of JSON for every fifty steps."""

from __future__ import annotations

import json
import re
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

EVERY = 50
"""Steps between two lines."""


class LossLog:
    """A log that goes on after an interruption as if there had been none.

    Args:
        path: the file.
        step: steps that the run has made; lines beyond are dropped, for these steps come again.
    """

    def __init__(self, path: Path, step: int = 0) -> None:
        self.path = path
        if path.exists():
            lines = [line for line in path.read_text().splitlines() if is_up_to(line, step)]
            path.write_text("".join(line + "\n" for line in lines))

    def note(self, step: int, loss: float) -> None:
        """Write a line if one is due.

        Args:
            step: steps made.
            loss: smoothed over the last fifty or so.
        """
        if step % EVERY == 0:
            with self.path.open("a") as file:
                file.write(json.dumps({"step": step, "loss": loss}) + "\n")


def is_up_to(line: str, step: int) -> bool:
    """Whether a line is whole and belongs to one of the first steps."""
    try:
        return json.loads(line)["step"] <= step
    except ValueError:
        return False


def stored_runs() -> list[str]:
    """Names of the recipes whose loss curves are stored in the package."""
    names = (file.name for file in files("projflow_lite.prior").iterdir())
    found = (re.fullmatch(r"loss_(\w+)\.jsonl", name) for name in names)
    return sorted(match[1] for match in found if match)


def read_loss(path: str | Path) -> NDArray[np.float64]:
    """The loss curve of a run, ``(lines, 2)``: steps made and the smoothed loss.

    Args:
        path: ``loss.jsonl`` of a run, or one of `stored_runs`.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it is no log of a run.
    """
    stored = files("projflow_lite.prior") / f"loss_{path}.jsonl"
    source = stored if path in stored_runs() else Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"read_loss: there is no log at {source}")
    try:
        rows = [json.loads(line) for line in source.read_text().splitlines()]
        return np.array([(row["step"], row["loss"]) for row in rows], float).reshape(-1, 2)
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"read_loss: {source} is not the log of a run ({error!r})") from error
