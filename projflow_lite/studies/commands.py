"""Every study behind one door: ``projflow-lite reproduce NAME``.

A study prints its table and returns its numbers; pictures go to ``pictures/`` in the given folder.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from projflow_lite.prior import load_prior
from projflow_lite.studies import (
    contact_sheet,
    control,
    data_card,
    fewer_steps,
    gmd_table,
    lifting,
    noise_reading,
    posterior,
    sensitivity,
)


class Wanted(NamedTuple):
    """What was asked for: a checkpoint (None: the shipped one), where to, real clips, how long."""

    prior: Path | None
    out: Path
    real: Path | None
    quick: bool


def run_posterior(wanted: Wanted) -> dict[str, Any]:
    """Does projection sampling draw from p(x | y)?"""
    rows = posterior.run(wanted.quick)
    return shown("posterior", posterior, rows, wanted)


def run_contact_sheet(wanted: Wanted) -> dict[str, Any]:
    """The pictures of the README: what the prior makes, and what it learned from."""
    paths = contact_sheet.run(load_prior(wanted.prior), wanted.out / "pictures")
    return {"written": [str(path) for path in paths]}


def run_control(wanted: Wanted) -> dict[str, Any]:
    """Which method obeys, trained or not, and at which cost? Table 1 and 7 of ProjFlow."""
    return compared("control", control, wanted)


def run_lifting(wanted: Wanted) -> dict[str, Any]:
    """From a drawing to a motion. Table 2 of ProjFlow."""
    return compared("lifting", lifting, wanted)


def run_sensitivity(wanted: Wanted) -> dict[str, Any]:
    """How much does each constant matter? Those of Table 5 of ProjFlow."""
    return compared("sensitivity", sensitivity, wanted)


def compared(name: str, study: Any, wanted: Wanted) -> dict[str, Any]:
    """Run a comparison of methods: its table, its picture and its records."""
    rows = study.run(load_prior(wanted.prior), study.QUICK if wanted.quick else None)
    return shown(name, study, rows, wanted)


def shown(name: str, study: Any, rows: Any, wanted: Wanted) -> dict[str, Any]:
    """Print the table of a study and draw its picture."""
    print(study.table(rows))
    pictures = wanted.out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    picture = study.figure(rows, pictures / f"{name}.png")
    return {"picture": str(picture), "rows": rows}


def run_noise_reading(wanted: Wanted) -> dict[str, Any]:
    """Which noise should eq. 9 mix, and how much of it should be fresh?"""
    clips, seeds = (24, 2) if wanted.quick else (64, 3)
    rows = noise_reading.run(load_prior(wanted.prior), clips, seeds)
    print(noise_reading.table(rows))
    return {"rows": rows}


def run_fewer_steps(wanted: Wanted) -> dict[str, Any]:
    """How few steps keep the quality of a hundred?"""
    rows = fewer_steps.run(load_prior(wanted.prior), wanted.quick)
    return shown("fewer-steps", fewer_steps, rows, wanted)


def run_gmd_table(wanted: Wanted) -> dict[str, Any]:
    """GMD beside ProjFlow: the same clips, the same keyframes, from one to all."""
    rows = gmd_table.run(gmd_table.load_models(load_prior(wanted.prior)), wanted.quick)
    print(gmd_table.table(rows))
    pictures = wanted.out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    picture = gmd_table.figure(rows, pictures / "gmd-table.png")
    return {"picture": str(picture), "rows": rows}


def run_data_card(wanted: Wanted) -> dict[str, Any]:
    """What the synthetic motion is like, beside recorded motion if its file is given."""
    return data_card.run(wanted.out, wanted.real, wanted.quick)


STUDIES: dict[str, Callable[[Wanted], dict[str, Any]]] = {
    "contact-sheet": run_contact_sheet,
    "control": run_control,
    "data-card": run_data_card,
    "fewer-steps": run_fewer_steps,
    "gmd-table": run_gmd_table,
    "lifting": run_lifting,
    "noise-reading": run_noise_reading,
    "posterior": run_posterior,
    "sensitivity": run_sensitivity,
}
