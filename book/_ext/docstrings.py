"""Docstrings as readers see them: what reStructuredText would take for something else."""

from __future__ import annotations

import re
from typing import Any

LONE_LETTER = re.compile(r"^(\s*:\w+ [\w*]+: )([A-Za-z])\.\s*$")
ALIAS = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")


def readable(lines: list[str]) -> list[str]:
    """The same lines, with a parameter that is described by one letter kept from being a list.

    ``frames: N.`` would come out as the 14th item of an enumeration.
    """
    return [LONE_LETTER.sub(r"\1*\2*.", line) for line in lines]


def untyped(lines: list[str]) -> list[str]:
    """The lines of a constant, whose "Words: more" napoleon took for a type and a description."""
    kind = next((line for line in lines if line.startswith(":type: ")), "")
    told = "\n".join(line for line in lines if line != kind).strip()
    return f"{kind.removeprefix(':type: ')}: {told}".split("\n") if kind else lines


def named(text: str | None) -> str | None:
    """The same text, with NDArray for what autodoc writes of an alias inside a tuple."""
    return ALIAS.sub(r"\1", text) if text else text


def process(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Change a docstring in place, after napoleon made fields of its sections."""
    lines[:] = untyped(readable(lines)) if what in ("attribute", "data") else readable(lines)


def signature(
    app: Any,
    what: str,
    name: str,
    thing: Any,
    options: Any,
    arguments: str | None,
    result: str | None,
) -> tuple[str | None, str | None]:
    """Change the two texts of a signature."""
    return named(arguments), named(result)


def setup(app: Any) -> dict[str, Any]:
    """Connect to Sphinx."""
    app.connect("autodoc-process-docstring", process, priority=900)
    app.connect("autodoc-process-signature", signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
