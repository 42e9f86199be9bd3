"""How a wrong input has to be refused, for the tables in the tests beside this file."""

from __future__ import annotations

import re
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

import data_synth
import projflow_lite

HOMES = tuple(Path(package.__file__).parent for package in (projflow_lite, data_synth))
ANYTHING = "…"
LONGEST = 200


def check_refusal(make: Callable, message: str, kind: type[Exception] = ValueError) -> None:
    """One line that says what is wrong, raised by the package and not by what it stands on.

    Args:
        make: does what is wrong.
        message: the whole line; ANYTHING stands for any text, such as a path.
        kind: of the error: ValueError unless the docstring says otherwise.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # numpy, computing with it all the same
        with pytest.raises(kind) as caught:
            make()
    assert type(caught.value) is kind
    line = str(caught.value)
    assert re.fullmatch(re.escape(message).replace(re.escape(ANYTHING), ".+"), line), line
    assert len(line.splitlines()) == 1
    assert len(line) <= LONGEST
    innermost = Path(traceback.extract_tb(caught.tb)[-1].filename)
    assert any(innermost.is_relative_to(home) for home in HOMES), innermost
