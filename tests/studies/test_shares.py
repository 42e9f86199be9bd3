"""Several processes share the cells of a study."""

import json
import os
import subprocess
import sys
import textwrap
from collections import Counter
from pathlib import Path

import pytest

from projflow_lite import cli
from projflow_lite.studies import commands, shares
from projflow_lite.studies.cells import Cell, Rival, filled, stored

CELLS = [Cell(joint, 5, Rival(name, "")) for joint in "abcd" for name in ("slow", "quick")]

ONE_OF_TWO = """
import json, os, sys
from pathlib import Path
from projflow_lite.studies.cells import filled
sys.path.insert(0, {tests!r})
from test_shares import CELLS

place, rank = Path({place!r}), os.environ["RANK"]

def measure(cell, seed):
    with (place / "log").open("a") as log:
        log.write(f"{{rank}} {{cell.path}} {{seed}}\\n")
    return {{"FID": len(str(cell.path)) + seed}}

found = filled(place, CELLS, 3, measure, progress=False)
(place / f"rows-{{rank}}.json").write_text(json.dumps(list(found.values())))
"""


def environment(rank, count):
    return {**os.environ, "RANK": str(rank), "WORLD_SIZE": str(count), "OMP_NUM_THREADS": "1"}


def test_two_processes_measure_every_cell_once_and_end_with_the_same(tmp_path):
    script = textwrap.dedent(ONE_OF_TWO).format(
        place=str(tmp_path), tests=str(Path(__file__).parent)
    )
    started = [
        subprocess.Popen([sys.executable, "-c", script], env=environment(rank, 2))
        for rank in range(2)
    ]
    assert [process.wait(120) for process in started] == [0, 0]
    lines = (tmp_path / "log").read_text().split("\n")[:-1]
    done = Counter(line.partition(" ")[2] for line in lines)
    assert len(done) == 3 * len(CELLS)
    assert set(done.values()) == {1}
    assert {line[0] for line in lines} == {"0", "1"}
    first, second = (json.loads((tmp_path / f"rows-{rank}.json").read_text()) for rank in range(2))
    assert first == second
    alone = filled(tmp_path / "alone", CELLS, 3, measure_alone, progress=False)
    assert list(alone.values()) == first


def measure_alone(cell, seed):
    return {"FID": len(str(cell.path)) + seed}


def test_slow_cells_are_spread(monkeypatch):
    """In a list slow ones come at even steps; the names decide, so both processes get some."""
    monkeypatch.setenv("WORLD_SIZE", "2")
    whose = []
    for rank in "01":
        monkeypatch.setenv("RANK", rank)
        paths = [Path("x") / cell.path / f"seed-{seed}.json" for cell in CELLS for seed in range(9)]
        whose.append([shares.is_mine(path) for path in paths if "slow" in str(path)])
    assert all(a != b for a, b in zip(*whose, strict=True))
    assert 0.25 < sum(whose[0]) / len(whose[0]) < 0.75


def test_times_are_taken_by_the_first_alone(monkeypatch, tmp_path):
    monkeypatch.setenv("WORLD_SIZE", "2")
    for k in range(8):
        assert stored(tmp_path / f"{k}.json", lambda: {"time": 1.0}, by_first=True)
    monkeypatch.setenv("RANK", "1")

    def never():
        raise AssertionError("the first one does this")

    monkeypatch.setattr(shares, "LOOK_AGAIN", 0)
    for k in range(8):
        assert stored(tmp_path / f"{k}.json", never, by_first=True) == {"time": 1.0}


def test_others_neither_print_nor_write(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("RANK", "1")
    wanted = commands.Wanted(None, tmp_path, None, quick=True)
    assert commands.shown("control", None, [], wanted) == {"rows": []}
    monkeypatch.setitem(commands.STUDIES, "posterior", lambda wanted: pytest.fail("unshared"))
    assert cli.main(["reproduce", "posterior"]) == 0
    assert capsys.readouterr().out == ""
    assert not list(tmp_path.iterdir())


def test_a_process_alone_does_everything_as_it_comes():
    done = []
    shares.take_share([(Path("a"), lambda: done.append(1))])
    assert shares.processes() == (0, 1)
    assert shares.is_first()
    assert not done
    assert all(shares.is_mine(Path(f"{k}")) for k in range(9))
