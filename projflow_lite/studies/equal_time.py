"""Ten ways to obey at the same wall clock: what does each do with the time that ProjFlow takes?

The study of control gives every method the same number of steps, and they differ in price: a
gradient through the network costs a few calls, a search for noise hundreds. Here they get the same
time: that of ProjFlow at its usual number of steps, twice and four times of it. How many steps fit
(of DNO: looks) is found in the same run: two counts of each method are timed, in turns with
ProjFlow, so that a busy machine slows both, and the line through them says what others take.
Another machine may find other numbers, and only ratios are kept.

Captions, keyframes and noise are those of the study of control; settings of methods as well.
``python -m projflow_lite.studies.equal_time --help`` has all options.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from tqdm.auto import tqdm

from projflow_lite.prior import Prior
from projflow_lite.studies import control
from projflow_lite.studies.bench import Bench, begin
from projflow_lite.studies.cells import Rival, stored
from projflow_lite.studies.control import Protocol, in_time, rows_of, score_of_data
from projflow_lite.studies.control_ways import FREE, OURS, RIVALS, time_ratio
from projflow_lite.studies.control_words import COLUMNS
from projflow_lite.studies.equal_time_figure import figure
from projflow_lite.studies.equal_time_words import BUDGET, COUNT, RATIO, sentences, table
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.sensitivity_sweeps import USUAL
from projflow_lite.studies.shell import add_methods, asked_for, carry_out, chosen, options_of

__all__ = ["figure", "run", "sentences", "table"]

BUDGETS = (1, 2, 4)
"""Multiples of the time that ProjFlow takes."""

COUNTED = {"dno": "iterations"}
"""What a method takes more of when it has more time, if not steps."""

TURNS = 3
"""How often each count is timed, in turns with ProjFlow; the best turn counts."""

FULL = Protocol(
    joints=("pelvis", "left_wrist"), densities=(1, 5, FRAMES // 4), rivals=RIVALS + OURS,
    edit=False, clock=False,
)  # fmt: skip
QUICK = FULL._replace(clips=32, seeds=2, steps=5, joints=("left_wrist",), densities=(5,))
"""A first look: wide intervals, one joint, one density, and very few steps."""


class Fit(NamedTuple):
    """How much of a method fits into a time.

    Attributes:
        number: of steps, or of iterations.
        ratio: the time that they take, over ProjFlow's at its usual number of steps.
    """

    number: int
    ratio: float


def counted(rival: Rival) -> str:
    """The option that says how much of a method is done."""
    return COUNTED.get(rival.method, "steps")


def with_count(rival: Rival, count: int) -> Rival:
    """A method with another number of steps or iterations."""
    options = dict(rival.options) | {counted(rival): count}
    return rival._replace(options=tuple(options.items()))


def tried(rival: Rival, steps: int) -> tuple[int, int]:
    """Two counts whose times tell what one more costs."""
    return (1, 2) if rival.method in COUNTED else (max(1, steps // 5), max(2, steps // 2))


class Price(NamedTuple):
    """What a method takes, in units of ProjFlow's time.

    Attributes:
        start: before anything is counted.
        each: for one more.
    """

    start: float
    each: float

    def fit(self, budget: float) -> Fit:
        """The number that takes a time nearest to a budget; 1 at least."""
        number = max(1, round((budget - self.start) / self.each))
        return Fit(number, self.start + number * self.each)


def price_of(few: int, many: int, cost: tuple[float, float]) -> Price:
    """The line through what two counts took; through the origin if a busy machine says nonsense."""
    each = (cost[1] - cost[0]) / (many - few)
    start = cost[0] - few * each
    return Price(start, each) if each > 0 and start >= 0 else Price(0.0, cost[1] / many)


def priced(make: Callable[[Rival], Any], rival: Rival, usual: Rival, steps: int) -> dict[str, Any]:
    """The price of a method.

    Args:
        make: what is timed.
        rival: the method.
        usual: what it is timed against, ProjFlow at its usual number of steps.
        steps: that number.
    """
    counts = tried(rival, steps)
    first, second = (
        time_ratio(partial(make, with_count(rival, count)), partial(make, usual), TURNS)
        for count in counts
    )
    return price_of(*counts, (first, second))._asdict()


def fits_of(bench: Bench, rivals: tuple[Rival, ...], progress: bool) -> dict[Rival, dict[int, Fit]]:
    """How much of each method fits into each time, from the files or timed and stored.

    ProjFlow itself is what the others are timed against: its counts are known.
    """
    steps, found = bench.about["steps"], {}
    usual = with_count(USUAL, steps)
    bar = tqdm(rivals, disable=not progress, unit="method")
    for rival in bar:
        bar.set_description(f"how much fits: {rival.name}")
        if rival == USUAL:
            found[rival] = {budget: Fit(budget * steps, float(budget)) for budget in BUDGETS}
            continue
        measure = partial(priced, partial(in_time, bench), rival, usual, steps)
        path = bench.place / rival.spelled / f"price-{bench.device}.json"
        price = Price(**stored(path, measure, by_first=True))
        found[rival] = {budget: price.fit(budget) for budget in BUDGETS}
    return found


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = control.FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every method in every time; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: `FULL` by default, or one like it; its ``steps`` are ProjFlow's.
        folder: where results are stored, see `control.run`; a run that goes on keeps the counts
            that it began with.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        Records as of `control.run`, without the means over joints at one density, and beside them
        ``budget``, ``count``, ``counted`` ("steps" or "iterations") and ``ratio``, the time that
        this takes, as a multiple of ProjFlow's at its usual number of steps.

    Raises:
        ValueError: as `control.run`.
    """
    p = protocol or FULL
    bench = begin("equal_time", prior, p, control.SEEDS, folder, device)
    fits = fits_of(bench, p.rivals, progress)
    rows = [bench.data_row(partial(score_of_data, bench), COLUMNS)]
    for budget in BUDGETS:
        rivals = tuple(with_count(rival, fits[rival][budget].number) for rival in p.rivals)
        known = {rival.name: (counted(rival), fits[rival][budget]) for rival in p.rivals}
        for row in rows_of(bench, p._replace(rivals=rivals), progress):
            name, fit = known[row["method"]]
            rows.append(
                row | {BUDGET: budget, COUNT: fit.number, "counted": name, RATIO: fit.ratio}
            )
    return rows


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    parser = options_of("Ten ways to obey at the same wall clock.", control.FOLDER, FULL)
    add_methods(parser, FULL.rivals)
    options = parser.parse_args()
    rivals = chosen(FULL.rivals, options.methods)
    rivals = tuple(dict.fromkeys((FREE, USUAL, *rivals)))
    protocol = asked_for(options, FULL._replace(rivals=rivals), QUICK)
    carry_out("equal-time", options, protocol, run, table, figure)


if __name__ == "__main__":
    main()
