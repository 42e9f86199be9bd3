"""The study of equal time: how counts are found, what is run with them, and what is said."""

import json

import numpy as np
import pytest
from untrained import small_prior

from projflow_lite.studies import control, equal_time, equal_time_words
from projflow_lite.studies.cells import ALL, DATA, published
from projflow_lite.studies.control_ways import FREE, RIVALS
from projflow_lite.studies.equal_time import (
    BUDGETS,
    Price,
    counted,
    price_of,
    priced,
    tried,
    with_count,
)
from projflow_lite.studies.equal_time_words import BUDGET, COUNT, RATIO
from projflow_lite.studies.sensitivity_sweeps import USUAL

DPS, DNO = RIVALS[-3], RIVALS[-1]


@pytest.fixture(scope="module")
def prior():
    return small_prior()


def test_what_a_method_has_more_of_is_steps_or_looks():
    assert [counted(rival) for rival in (FREE, USUAL, DPS, DNO)] == ["steps"] * 3 + ["iterations"]
    assert dict(with_count(DNO, 7).options) == dict(DNO.options) | {"iterations": 7}
    ready = next(rival for rival in RIVALS if rival.name == "dps, endpoint")
    assert dict(with_count(ready, 9).options) == dict(ready.options) | {"steps": 9}
    assert dict(with_count(with_count(ready, 9), 3).options)["steps"] == 3


@pytest.mark.parametrize(
    ("cost", "budget", "number", "ratio"),
    [
        ((0.5, 0.9), 1.0, 14, 1.0),  # 0.3 to begin with and 0.05 a step
        ((0.5, 0.9), 4.0, 74, 4.0),
        ((8.0, 24.0), 1.0, 1, 2.0),  # half a step, but one it must be
        ((0.5, 0.4), 1.0, 30, 1.0),  # the clock was disturbed: a twelfth of 0.4 a step
        ((0.1, 1.2), 1.0, 10, 1.0),  # and here: nothing takes less than no time to begin with
    ],
)
def test_the_number_that_fits_is_worked_out_by_hand(cost, budget, number, ratio):
    fit = price_of(4, 12, cost).fit(budget)
    assert fit.number == number
    assert fit.ratio == pytest.approx(ratio)


def test_a_price_is_found_by_the_clock(monkeypatch):
    """A method that takes 0.2 to begin with and 0.06 a step, in units of ProjFlow's time."""
    asked = []

    def clock(work, reference, turns):
        done = [dict(f.args[0].options) for f in (work, reference)]
        asked.append(done[0]["steps"])
        assert done[1]["steps"] == 25
        return 0.2 + 0.06 * done[0]["steps"]

    monkeypatch.setattr(equal_time, "time_ratio", clock)
    price = Price(**priced(lambda rival: None, DPS, with_count(USUAL, 25), 25))
    assert asked == [5, 12]
    assert [price.fit(budget).number for budget in BUDGETS] == [13, 30, 63]
    assert price.fit(1).ratio == pytest.approx(0.98)
    assert tried(DNO, 25) == (1, 2)
    assert tried(DPS, 2) == (1, 2)


def test_what_was_fitted_is_taken_from_its_file_and_runs(prior, tmp_path, monkeypatch):
    timed, made, real = [], [], control.measured

    def fake(make, rival, usual, steps):
        timed.append(rival.name)
        return {"start": 0.9, "each": 1.0}

    def looking(*what):
        made.append(what[2].name)
        return real(*what)

    monkeypatch.setattr(equal_time, "priced", fake)
    monkeypatch.setattr(control, "measured", looking)
    protocol = equal_time.QUICK._replace(steps=2, rivals=(FREE, USUAL, RIVALS[2]))
    rows = equal_time.run(prior, protocol, tmp_path / "runs", progress=False)
    assert timed == ["no wish", "ddnm"]
    assert equal_time.run(prior, protocol, tmp_path / "runs", progress=False) == rows
    assert timed == ["no wish", "ddnm"]
    assert len(made) == 2 * (3 + 2 * 2)  # one step is the same in one and in two times
    counts = {(row["method"], row[BUDGET]): (row[COUNT], row[RATIO]) for row in rows[1:]}
    assert counts["projflow", 2] == (4, 2.0)
    assert counts["ddnm", 2] == (1, 1.9)
    assert {row["options"]["steps"] for row in rows[1:]} == {1, 2, 3, 4, 8}
    text = equal_time.table(rows)
    for part in ("2 seeds of 32 clips", "twice the time", "ddnm, 1 steps, 1.90", "at 2 steps"):
        assert part in text
    said = equal_time.sentences(rows)
    assert said[0] == (
        "Longer than their time by more than a quarter: no wish in the time (takes 1.9 times ProjFlow's with 1 "
        "steps), ddnm in the time (takes 1.9 times ProjFlow's with 1 steps)."
    )
    published("equal-time", prior, rows, equal_time.figure, tmp_path)
    assert json.loads((tmp_path / "results/equal-time.json").read_text())["rows"] == rows
    assert (tmp_path / "pictures/equal-time.png").stat().st_size > 10_000


def row(method, budget, fid, miss=0.0):
    """A row of made-up numbers."""
    columns = dict.fromkeys(equal_time_words.SHOWN, fid) | {"average error": (miss, miss)}
    scores = {
        name: {"mean": float(np.mean(v)), "half width": 0.1, "values": list(v)}
        for name, v in columns.items()
    }
    about = {"joint": "average", "keys": ALL, "method": method, "steps": 25, "counted": "steps"}
    return about | {BUDGET: budget, COUNT: 25 * budget, RATIO: budget, "scores": scores}


ROWS = [
    {"method": DATA, "joint": ALL, "keys": ALL, "scores": {}},
    row("no wish", 1, (9.0, 9.1), 0.4),
    row("projflow", 1, (2.0, 3.0)),
    row("dps", 1, (1.0, 2.01), 0.02),
    row("ddnm", 1, (4.0, 5.01)),
    row("gmd", 1, (1.0, 9.0), 0.2),
    row("projflow", 4, (1.0, 2.01)),
    row("dps", 4, (3.0, 1.0), 0.01),
    row("gmd", 4, (0.5, 8.49), 0.04),
]


def test_who_is_ahead_is_said_with_what_it_misses():
    """Differences of two seeds: -1 and -0.99, 2 and 2.01, -1 and 6."""
    assert equal_time_words.of_budget(ROWS, 1, "FID") == (
        "FID in the time of ProjFlow, which is 25 steps of its own and 2.500 ± 0.100; ahead of it: "
        "dps (-0.995 ± 0.064, misses by 0.020 m); behind it: ddnm (+2 ± 0.064, exact); undecided: "
        "gmd (+2.5 ± 44, misses by 0.200 m)."
    )
    assert equal_time_words.of_budget(ROWS[:2], 1, "FID") is None


def test_more_time_is_judged_for_every_method():
    assert equal_time_words.of_more_time(ROWS, "FID") == (
        "FID, four times the time less the time: projflow -0.995 ± 0.064 (better), "
        "dps +0.495 ± 19 (undecided), gmd -0.505 ± 0.064 (better)."
    )
    assert equal_time_words.of_more_time(ROWS[:6], "FID") is None


def test_who_is_near_and_who_is_late():
    assert equal_time_words.of_near(ROWS) == (
        "Within 5 cm of their keyframes on average, and the least time in which they are: projflow "
        "(the time), dps (the time), ddnm (the time), gmd (four times the time)."
    )
    assert (
        equal_time_words.of_fit(ROWS) == "Longer than their time by more than a quarter: no method."
    )
    late = [ROWS[0], row("dno", 1, (1.0, 1.1)) | {RATIO: 3.1, COUNT: 1, "counted": "iterations"}]
    assert equal_time_words.of_fit(late) == (
        "Longer than their time by more than a quarter: dno in the time (takes 3.1 times ProjFlow's with 1 "
        "iterations)."
    )
