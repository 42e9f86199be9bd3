"""The proof that the checks can fail: wrong answers they must catch, right ones they must not."""

from __future__ import annotations

from typing import Any, NamedTuple

from .bank import right_answers, wrong_answers
from .checking import check
from .shelf import EXERCISES


class Row(NamedTuple):
    """How the check of one exercise did.

    Attributes:
        id: such as ``"projflow:7"``.
        title: what the exercise is about.
        wrong: number of wrong answers in the bank.
        caught: how many of them the check refused.
        right: number of right answers in the bank.
        accepted: how many of them the check accepted.
    """

    id: str
    title: str
    wrong: int
    caught: int
    right: int
    accepted: int


def mutation_score(seed: int = 0) -> list[Row]:
    """Run every answer of the bank through its check.

    Args:
        seed: draws the cases.
    """
    return [_row(id, seed) for id in EXERCISES]


def _row(id: str, seed: int) -> Row:
    """Count what one check catches and accepts."""
    wrong, right = wrong_answers(id), right_answers(id)
    caught = sum(not check(id, answer, seed) for answer in wrong)
    accepted = sum(bool(check(id, answer, seed)) for answer in right)
    return Row(id, EXERCISES[id].record.title, len(wrong), caught, len(right), accepted)


def run(seed: int = 0) -> dict[str, Any]:
    """Return the rows of `mutation_score`, their totals, and an exit code for a shell.

    Args:
        seed: draws the cases.

    Returns:
        ``rows`` (a list of dictionaries), ``wrong``, ``caught``, ``right``, ``accepted``,
        ``seed``, and ``exit_code``: 0 if everything was caught and accepted, else 1.
    """
    rows = mutation_score(seed)
    counts = ("wrong", "caught", "right", "accepted")
    totals = {name: sum(getattr(row, name) for row in rows) for name in counts}
    perfect = totals["caught"] == totals["wrong"] and totals["accepted"] == totals["right"]
    return {
        "rows": [row._asdict() for row in rows],
        **totals,
        "seed": seed,
        "exit_code": 0 if perfect else 1,
    }


def report(rows: list[Row]) -> str:
    """Write the rows of `mutation_score` as a table that ends in the score.

    Args:
        rows: from `mutation_score`.
    """
    width = max((len(row.title) for row in rows), default=0)
    lines = [f"{'exercise':<12} {'':<{width}}  caught    accepted"]
    for row in rows:
        caught, accepted = f"{row.caught} of {row.wrong}", f"{row.accepted} of {row.right}"
        lines.append(f"{row.id:<12} {row.title:<{width}}  {caught:<8}  {accepted}")
    wrong, caught_all = sum(row.wrong for row in rows), sum(row.caught for row in rows)
    right, accepted_all = sum(row.right for row in rows), sum(row.accepted for row in rows)
    percent = f"{int(100 * caught_all / wrong)} %" if wrong else "undefined"
    lines.append(
        f"mutation score {percent} ({caught_all} of {wrong} caught), "
        f"{accepted_all} of {right} right answers accepted"
    )
    return "\n".join(lines)
