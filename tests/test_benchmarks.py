"""Every benchmark runs, and its numbers can be read. How fast anything is, no test says."""

import importlib
import json
import math
import sys
from itertools import pairwise
from pathlib import Path

import pytest
import torch

FOLDER = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = sorted(
    path.stem for path in FOLDER.glob("*.py") if path.stem not in ("measuring", "run_all")
)


@pytest.fixture
def benchmark(monkeypatch):
    """Function that imports a benchmark as if it were run as a script, and forgets it afterwards."""
    threads, loaded = torch.get_num_threads(), set(sys.modules)
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "1")
    yield importlib.import_module
    torch.set_num_threads(threads)
    for name in set(sys.modules) - loaded:
        if str(FOLDER) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_quick_run_writes_numbers_and_a_picture(benchmark, name, tmp_path, capsys):
    numbers, picture = tmp_path / "numbers.json", tmp_path / "picture.png"
    module = benchmark(name)
    module.main(["--quick", "--json", str(numbers), "--plot", str(picture)])
    result = json.loads(numbers.read_text(), parse_constant=pytest.fail)
    assert result["question"].endswith("?")
    assert f"torch {torch.__version__}" in result["machine"]
    assert result["quick"] is True
    assert result["bars"] == []  # small sizes prove nothing
    assert len(result["rows"]) >= 2
    for row in result["rows"]:
        measured = [value for value in row.values() if isinstance(value, float)]
        assert measured
        assert all(math.isfinite(value) for value in measured)
    assert picture.read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr().out
    assert result["machine"] in printed
    assert all(column in printed for column in result["rows"][0])


def test_all_ways_to_project_agree(benchmark):
    row = benchmark("projection").measure("five joints, a quarter of the frames", 8, 1, 0.0, True)
    rivals = [column for column in row if column.endswith("/ projection")]
    assert len(rivals) == 5
    assert row["apart, m"] < 1e-8


def test_turns_are_taken_until_each_has_had_its_time(benchmark, monkeypatch):
    measuring = benchmark("measuring")
    now, order = [0.0], []

    def work(name, seconds):
        order.append(name)
        now[0] += seconds

    monkeypatch.setattr(measuring.time, "process_time", lambda: now[0])
    monkeypatch.setattr(measuring.time, "perf_counter", lambda: now[0])
    runs = {"a": lambda: work("a", 1.0), "b": lambda: work("b", 2.0), "c": lambda: work("c", 9.0)}
    times = measuring.take_turns(runs, seconds=5.0, least=2, turn=0.5)
    assert "".join(order) == "abcababaaa"
    assert {name: timing.calls for name, timing in times.items()} == {
        "a": [1.0] * 6,
        "b": [2.0] * 3,
        "c": [9.0],  # longer than all that it was given: once is enough
    }
    assert times["b"].best == 2.0


def test_an_exponent_is_the_slope_of_logarithms(benchmark):
    exponent = benchmark("measuring").exponent
    assert exponent([1, 2, 4], [3, 12, 48]) == pytest.approx(2)
    assert exponent([1, 10], [5, 5]) == pytest.approx(0)


@pytest.mark.parametrize(
    ("measured", "limit", "at_least", "met"),
    [(1.04, 1.05, False, True), (1.06, 1.05, False, False), (250, 200, True, True), (150, 200, True, False)],
)  # fmt: skip
def test_a_bar_is_met_or_missed(benchmark, measured, limit, at_least, met):
    bar = benchmark("measuring").Bar("this", measured, limit, at_least)
    assert bar.met is met
    assert str(bar).startswith("met: " if met else "MISSED: ")


def test_bars_are_judged_by_the_dearest_wish(benchmark):
    sampling = benchmark("sampling")
    row = {sampling.RATIO: 1.01, "whole sample at its best, ms": 250.0}
    rows = [{"batch": b, "wish": name} | row for b in (1, 16) for name in sampling.wishes()]
    rows[1][sampling.RATIO], rows[2]["whole sample at its best, ms"] = 1.2, 320.0
    first, second, live = sampling.bars(rows)
    assert (first.met, second.met, live.met) == (False, True, False)
    assert list(sampling.wishes())[1] in first.what


def test_what_a_move_takes_is_judged_beside_its_sampling(benchmark):
    latency = benchmark("latency")
    rows = [
        latency.summary("viewer, scrub", [40.0, 60.0, 10.0]),
        latency.summary("pose editor, drag, sampling", [340.0, 440.0, 240.0])
        | latency.beside_sampling([340.0, 440.0, 240.0], [300.0, 300.0, 200.0]),
    ]
    scrub, drag = latency.bars(rows)
    assert (scrub.measured, scrub.limit, scrub.met) == (40.0, 50.0, True)
    assert (drag.measured, drag.limit, drag.met) == (40.0, 50.0, True)
    assert rows[0]["90 %, ms"] == pytest.approx(56.0)
    assert rows[1]["median / sampling"] == pytest.approx(340 / 300)


def test_moves_go_to_places_far_from_the_one_before(benchmark):
    places = [benchmark("latency").spread(k) for k in range(40)]
    assert all(0 <= place < 1 for place in places)
    assert min(abs(a - b) for a, b in pairwise(places)) > 0.3


def test_a_table_leaves_what_was_not_run_empty(benchmark):
    table = benchmark("measuring").table([{"a": 1, "b": 1234.5}, {"a": 20000, "c": 0.12345}])
    assert table.splitlines() == [
        "| a      | b     | c     |",
        "|--------|-------|-------|",
        "| 1      | 1,234 |       |",
        "| 20,000 |       | 0.123 |",
    ]


def test_the_page_of_results_is_written_anew_below_its_mark(benchmark, tmp_path):
    run_all = benchmark("run_all")
    result = {
        "question": "How many?", "machine": "a machine", "quick": False, "rows": [{"count": 3}],
        "bars": [{"what": "count", "measured": 3.0, "limit": 2.0, "at_least": True, "met": True}],
    }  # fmt: skip
    (tmp_path / "memory.json").write_text(json.dumps(result))
    readme = tmp_path / "README.md"
    readme.write_text(f"Introduction\n{run_all.BEGIN}\nold results\n")
    run_all.write_page(tmp_path, readme)
    text = readme.read_text()
    assert text.startswith("Introduction\n")
    assert "old results" not in text
    assert "- met: count >= 2, measured 3" in text
    assert "| 3     |" in text
    run_all.write_page(tmp_path, readme)
    assert readme.read_text() == text


def test_the_page_names_every_benchmark(benchmark):
    assert set(benchmark("run_all").NAMES) == set(SCRIPTS)
    readme = (FOLDER / "README.md").read_text()
    assert all(f"`{name}.py`" in readme for name in SCRIPTS)
