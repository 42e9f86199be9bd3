"""What the commands of comparisons have in common: options, and what is done with the rows."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from projflow_lite.prior import load_prior
from projflow_lite.studies.cells import Rival, published
from projflow_lite.studies.shares import is_first


def options_of(description: str, folder: Path, usual: Any) -> argparse.ArgumentParser:
    """A parser with the options that every comparison has.

    Args:
        description: of the command.
        folder: for results as they are made.
        usual: the whole protocol: its ``clips``, ``seeds``, ``steps`` and ``joints`` are defaults.
    """
    parser = argparse.ArgumentParser(description=description)
    add = parser.add_argument
    add("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    add("--quick", action="store_true", help="minutes; wide intervals")
    for name, help_ in (("clips", "of a cell"), ("seeds", "repetitions"), ("steps", "of sampling")):
        value = getattr(usual, name)
        add(f"--{name}", type=int, default=value, help=f"{help_} (default {value})")
    joints = ", ".join(usual.joints)
    add("--joints", nargs="+", default=usual.joints, help=f"default: {joints}")
    add("--device", default="cpu", help="of the network: cpu or cuda")
    add("--folder", type=Path, default=folder, help="for results as they are made")
    add("--out", type=Path, help="folder for results/ and pictures/")
    return parser


def add_methods(parser: argparse.ArgumentParser, rivals: Sequence[Rival]) -> None:
    """The option that chooses some of the methods."""
    names = ", ".join(f'"{rival.name}"' for rival in rivals)
    parser.add_argument("--methods", nargs="+", metavar="NAME", help=f"of {names} (default: all)")


def chosen(rivals: Sequence[Rival], names: Sequence[str] | None) -> tuple[Rival, ...]:
    """The methods of these names, or all of them.

    Raises:
        ValueError: for a name that no method has.
    """
    known = {rival.name: rival for rival in rivals}
    for name in names or ():
        if name not in known:
            raise ValueError(f"methods: '{name}' is not one of {', '.join(known)}")
    return tuple(rival for rival in rivals if names is None or rival.name in names)


def asked_for(options: argparse.Namespace, usual: Any, quick: Any) -> Any:
    """The protocol that the options ask for, but for the methods."""
    if options.quick:
        return quick
    return usual._replace(
        clips=options.clips, seeds=options.seeds, steps=options.steps, joints=tuple(options.joints)
    )


def carry_out(
    name: str,
    options: argparse.Namespace,
    protocol: Any,
    run: Callable[..., list[dict[str, Any]]],
    table: Callable[[Any], str],
    draw: Callable[[Any, Path], Any],
) -> None:
    """Run a comparison as asked for: print the table, and write records and picture if wanted."""
    prior = load_prior(options.prior)
    rows = run(prior, protocol, options.folder, options.device)
    if not is_first():
        return
    print(table(rows))
    if options.out:
        published(name, prior, rows, draw, options.out)
