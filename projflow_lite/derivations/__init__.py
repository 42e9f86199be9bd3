"""Every equation of ProjFlow derived again, by routes that do not go through its own function.

A reader who doubts the toolkit asks for the table:

>>> from projflow_lite import derivations
>>> print(derivations.table(derivations.run(), derivations.run_as_printed()))  # doctest: +SKIP

``run(paper="GMD")`` does the same for GMD, and a table shows the rows of both, one after the other.

Each derivation is a short function with its argument in the docstring, sorted by topic. It gets
random numbers, compares `projflow_lite.equations` with something else (symbols, fractions, a
generic solver, a drawn sample, a loop) and returns the largest deviation.
"""

from . import (
    applications,
    as_printed,
    flow,
    gains,
    gmd,
    gmd_as_printed,
    guides,
    inverse_problem,
    masks,
    metric,
    posterior,
    projection,
)
from .registry import (
    COUNTEREXAMPLES,
    DERIVATIONS,
    Counterexample,
    Derivation,
    PrintedRow,
    Row,
    contradicts,
    derives,
    run,
    run_as_printed,
)
from .table import plain, table

__all__ = [
    "COUNTEREXAMPLES",
    "DERIVATIONS",
    "Counterexample",
    "Derivation",
    "PrintedRow",
    "Row",
    "applications",
    "as_printed",
    "contradicts",
    "derives",
    "flow",
    "gains",
    "gmd",
    "gmd_as_printed",
    "guides",
    "inverse_problem",
    "masks",
    "metric",
    "plain",
    "posterior",
    "projection",
    "run",
    "run_as_printed",
    "table",
]
