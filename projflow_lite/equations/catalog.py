"""The list of every printed equation, with its function and what checks it."""

from __future__ import annotations

from .records import bmm, gmd, projflow_paper, projflow_supplement
from .records.record import Record


def catalog() -> list[Record]:
    """Return one record per printed equation: ProjFlow 1–52, then BMM 1–16, then GMD.

    A record is a named tuple of strings: paper, number, title, latex, function, check, status
    and erratum. ProjFlow's and GMD's are checked; BMM's are open.
    """
    return [
        *projflow_paper.RECORDS,
        *projflow_supplement.RECORDS,
        *bmm.RECORDS,
        *gmd.RECORDS,
    ]
