"""Every study behind one door: ``projflow-lite reproduce NAME``.

A study prints its table and returns its numbers. Pictures go to ``pictures/`` in the given folder,
and records of comparisons to ``results/``, where the book finds them.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from projflow_lite.prior import Prior, load_prior
from projflow_lite.studies import (
    ablations,
    contact_sheet,
    control,
    data_card,
    equal_time,
    errata,
    fewer_steps,
    gmd_table,
    lifting,
    posterior,
    real_wishes,
    sensitivity,
)
from projflow_lite.studies.cells import records_text
from projflow_lite.studies.shares import is_first


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


def run_ablations(wanted: Wanted) -> dict[str, Any]:
    """Do the parts of ProjFlow earn their place? Table 3, Table 6 and Figure 7."""
    return compared("ablations", ablations, wanted)


def run_lifting(wanted: Wanted) -> dict[str, Any]:
    """From a drawing to a motion. Table 2 of ProjFlow."""
    return compared("lifting", lifting, wanted)


def run_sensitivity(wanted: Wanted) -> dict[str, Any]:
    """How much does each constant matter? Those of Table 5 of ProjFlow."""
    return compared("sensitivity", sensitivity, wanted)


def run_errata(wanted: Wanted) -> dict[str, Any]:
    """Which errata of ProjFlow matter to its motions?"""
    return compared("errata", errata, wanted)


def run_equal_time(wanted: Wanted) -> dict[str, Any]:
    """What does each method make of the time that ProjFlow takes?"""
    return compared("equal-time", equal_time, wanted)


def run_real_wishes(wanted: Wanted) -> dict[str, Any]:
    """What becomes of every method on keyframes of recorded people?"""
    return compared("real-wishes", real_wishes, wanted, wanted.real)


def compared(name: str, study: Any, wanted: Wanted, *given: Any) -> dict[str, Any]:
    """Run a comparison of methods: its table, its picture and its records."""
    prior = load_prior(wanted.prior)
    rows = study.run(prior, *given, study.QUICK if wanted.quick else None)
    return shown(name, study, rows, wanted, prior)


def shown(
    name: str, study: Any, rows: Any, wanted: Wanted, prior: Prior | None = None
) -> dict[str, Any]:
    """Print the table of a study, draw its picture, and keep its records if they are of a prior.

    Of several processes the first one does it.
    """
    if not is_first():
        return {"rows": rows}
    print(study.table(rows))
    kept = {} if prior is None else {"results": str(records(name, rows, wanted, prior))}
    if not hasattr(study, "figure"):
        return kept | {"rows": rows}
    pictures = wanted.out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    picture = study.figure(rows, pictures / f"{name}.png")
    return kept | {"picture": str(picture), "rows": rows}


def records(name: str, rows: Any, wanted: Wanted, prior: Prior) -> Path:
    """Write the records of a study, the prior that they are of, and whether it was a quick look."""
    path = wanted.out / "results" / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(records_text(prior, rows, quick=wanted.quick), encoding="utf-8")
    return path


def run_fewer_steps(wanted: Wanted) -> dict[str, Any]:
    """How few steps keep the quality of a hundred?"""
    prior = load_prior(wanted.prior)
    return shown("fewer-steps", fewer_steps, fewer_steps.run(prior, wanted.quick), wanted, prior)


def run_gmd_table(wanted: Wanted) -> dict[str, Any]:
    """GMD beside ProjFlow: the same clips, the same keyframes, from one to all."""
    prior = load_prior(wanted.prior)
    rows = gmd_table.run(gmd_table.load_models(prior), wanted.quick)
    return shown("gmd-table", gmd_table, rows, wanted, prior)


def run_data_card(wanted: Wanted) -> dict[str, Any]:
    """What the synthetic motion is like, beside recorded motion if its file is given."""
    return data_card.run(wanted.out, wanted.real, wanted.quick)


STUDIES: dict[str, Callable[[Wanted], dict[str, Any]]] = {
    "ablations": run_ablations,
    "contact-sheet": run_contact_sheet,
    "control": run_control,
    "data-card": run_data_card,
    "equal-time": run_equal_time,
    "errata": run_errata,
    "fewer-steps": run_fewer_steps,
    "gmd-table": run_gmd_table,
    "lifting": run_lifting,
    "posterior": run_posterior,
    "real-wishes": run_real_wishes,
    "sensitivity": run_sensitivity,
}

UNSHARED = ("posterior", "data-card", "contact-sheet")
"""Studies without cells: of several processes only the first one runs them."""
