"""The study of fewer steps: what it counts, stores, and says of numbers worked out by hand."""

import numpy as np
import pytest
import torch
from untrained import small_prior

from data_synth import held_out
from projflow_lite.samplers import flow_times
from projflow_lite.samplers.euler import euler
from projflow_lite.skeleton import JOINTS
from projflow_lite.studies import fewer_steps, fewer_steps_ways, fewer_steps_words
from projflow_lite.studies.fewer_steps_ways import DEFAULT, SCHEDULES, SOLVERS, Way, all_ways, make
from projflow_lite.studies.fewer_steps_words import COLUMNS, DATA, OFF_FLOW

FEW = [
    Way("quadratic", "Euler", 1), Way("quadratic", "Euler", 2), Way("cubic", "Heun", 2),
    Way("quadratic", "Euler", 2, "pelvis", 1, *DEFAULT),
    Way("quadratic", "multistep", 2, "pelvis", 1, *DEFAULT),
]  # fmt: skip


@pytest.fixture(scope="module")
def clips():
    return held_out(2, 60, 3)


@pytest.fixture
def few(monkeypatch):
    """Five ways to sample, and a fine one of two steps, instead of all."""
    monkeypatch.setattr(fewer_steps, "all_ways", lambda quick: FEW)
    monkeypatch.setattr(fewer_steps, "FINE", Way("cubic", "midpoint", 2))


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_times_rise_from_0_to_1(schedule):
    times = Way(schedule, "Euler", 10).times
    assert (times[0], times[-1], len(times)) == (0.0, 1.0, 11)
    assert np.all(np.diff(times) > 0)


def test_quadratic_times_are_those_that_sample_takes():
    np.testing.assert_allclose(Way("quadratic", "Euler", 7).times, flow_times(7), atol=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "wish",
    [
        (),
        ("left_wrist", 5, "implied", 0.0, "kinematic"),
        ("left_wrist", 5, "implied", "paper", "moving"),
    ],
)
def test_network_calls_are_counted_and_keyframes_met(solver, wish, clips):
    way = Way("cubic", solver, 4, *wish)
    x, calls = make(small_prior(), way, clips, seed=0)
    assert calls == way.calls
    if wish:
        frames, joint = [10, 20, 30, 39, 49], JOINTS.index("left_wrist")
        np.testing.assert_array_equal(x[:, frames, joint], clips.positions[:, frames, joint])


@pytest.mark.parametrize(("solver", "order"), [("Euler", 1), ("Heun", 2), ("midpoint", 2)])
def test_solvers_have_the_order_that_books_give_them(solver, order):
    """On x' = cos(9 t) - x, whose solution is known; every step up to t = 1 is a part of it."""

    def velocity(x_t, t, text=None):
        return torch.as_tensor(np.cos(9 * t)) - x_t

    def end(steps):
        times = [k / steps * 0.9 for k in range(steps + 1)]
        x = euler(SOLVERS[solver](velocity, times), torch.ones(1, dtype=torch.float64), times)
        return float(x[0])

    t = 0.9
    exact = (np.cos(9 * t) + 9 * np.sin(9 * t)) / 82 + (1 - 1 / 82) * np.exp(-t)
    coarse, fine = abs(end(100) - exact), abs(end(200) - exact)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.1)


def test_every_way_is_measured_once_and_quick_ones_are_fewer():
    ways, quick = all_ways(), all_ways(quick=True)
    assert len(set(ways)) == len(ways)
    assert sum(way.calls for way in quick) < 0.2 * sum(way.calls for way in ways)
    assert {way.steps for way in ways} == {5, 10, 15, 25, 50, 100}
    assert {way.task for way in ways} >= {
        "no wish",
        "pelvis, 5 keyframes",
        "left_wrist, 1 keyframe",
    }
    assert {(way.noise, way.eta) for way in ways if way.joint} >= {
        ("implied", "ddpm"), ("implied", "paper"), ("implied", 0.0), ("original", "paper"),
    }  # fmt: skip


def test_an_interrupted_run_goes_on_and_another_prior_starts_anew(few, tmp_path, monkeypatch):
    made, real = [], make

    def breaking(prior, way, clips, seed):
        made.append((way, seed))
        if len(made) == 4:
            raise KeyboardInterrupt
        return real(prior, way, clips, seed)

    monkeypatch.setattr(fewer_steps, "make", breaking)
    with pytest.raises(KeyboardInterrupt):
        fewer_steps.run(small_prior(), quick=True, folder=tmp_path, progress=False)
    rows = fewer_steps.run(small_prior(), quick=True, folder=tmp_path, progress=False)
    everything = 2 * (len(FEW) + 1)
    assert len(made) == everything + 1  # nothing was made twice but what broke
    again = fewer_steps.run(small_prior(), quick=True, folder=tmp_path, progress=False)
    assert len(made) == everything + 1
    assert again == rows
    assert not list(tmp_path.rglob("*.half"))
    fewer_steps.run(small_prior(seed=1), quick=True, folder=tmp_path, progress=False)
    assert len(made) == 2 * everything + 1

    assert [row["task"] for row in rows] == [DATA] + ["no wish"] * 3 + ["pelvis, 1 keyframe"] * 2
    for row in rows:
        free = row["task"] == "no wish"
        assert list(row["scores"]) == [name for name in COLUMNS if free or name != OFF_FLOW]
        for cell in row["scores"].values():
            assert cell["mean"] == pytest.approx(np.mean(cell["values"]))
            assert len(cell["values"]) == 2
    assert rows[3]["calls"] == 3  # Heun, two steps
    assert len([line for line in fewer_steps.table(rows).splitlines() if "quadratic " in line]) >= 4
    assert fewer_steps.figure(rows, tmp_path / "steps.png").stat().st_size > 10_000


def test_a_way_that_follows_the_flow_is_not_off_it(few, tmp_path, monkeypatch):
    same = [Way("cubic", "midpoint", 2), Way("cubic", "Euler", 1)]
    monkeypatch.setattr(fewer_steps, "all_ways", lambda quick: same)
    rows = fewer_steps.run(small_prior(), quick=True, folder=tmp_path, progress=False)
    assert rows[1]["scores"][OFF_FLOW]["mean"] == 0
    assert rows[2]["scores"][OFF_FLOW]["mean"] > 0.1


def test_too_few_clips_or_seeds_are_refused():
    with pytest.raises(ValueError, match="at least 64 clips and 2 seeds, not 32 and 3"):
        fewer_steps.run(small_prior(), clips=32)


def row(steps, jerk, fid, solver="Euler", task="no wish", found=1.0):
    values = {"FID": fid, "jerk": jerk, "R top 1": found}
    scores = {
        name: {"mean": float(np.mean(column)), "half width": 0.0, "values": list(column)}
        for name, column in ((n, np.broadcast_to(v, 2)) for n, v in values.items())
    }
    way = {
        "schedule": "quadratic",
        "solver": solver,
        "steps": steps,
        "noise": "",
        "eta": "",
        "metric": "",
    }
    return {"task": task, "calls": steps, "clips": 64, "seeds": 2, "scores": scores} | way


def test_what_is_lost_by_hand():
    """The reference misses the data's jerk by 9 and 11. A row that misses it by 22 twice misses it
    by 13 and 11 more: 12 on average, with an interval of 12.7062, Student's t for one degree of
    freedom times a standard error of 1. One that misses it by 23 is certain to be worse."""
    data = row(0, 50.0, 0.1, task=DATA, found=0.9)
    reference = row(100, [41.0, 39.0], 1.0, found=0.8)
    lost = fewer_steps_words.lost
    assert lost(row(10, 28.0, 1.0, found=0.8), reference, data) == []  # 12 of 12.7
    assert lost(row(10, 27.0, 1.0, found=0.8), reference, data) == ["jerk"]
    assert lost(row(10, 73.0, 1.1, found=0.8), reference, data) == ["FID", "jerk"]
    assert lost(row(10, 50.0, 1.04, found=0.8), reference, data) == []  # certain, but 4 % only
    assert lost(row(10, 50.0, 0.5, found=1.0), reference, data) == []  # found better than the data
    assert lost(row(10, 50.0, 0.5, found=0.7), reference, data) == ["R top 1"]
    jerk = fewer_steps_words.losses_against(row(10, 28.0, 1.0), reference, data)[1]
    assert (jerk.share, jerk.half_width) == pytest.approx((12 / 40, 12.7062 / 40), rel=1e-5)


def test_sentences_say_how_few_steps_keep_the_quality():
    data = row(0, 50.0, 0.1, task=DATA)
    euler_rows = [row(5, 50, 3.0), row(10, 50, 1.0), row(25, 50, 2.0), row(50, 50, 1.0), row(100, 50, 1.0)]  # fmt: skip
    other = [row(5, 50, 2.0, "multistep"), row(10, 50, 1.0, "multistep"), row(25, 50, 0.9, "multistep")]  # fmt: skip
    said = fewer_steps_words.sentences([data, *euler_rows, *other])
    # Ten steps happen to keep it, but 25 do not: fifty are the fewest that can be relied on.
    assert said[0] == (
        "No wish: 50 of the plainest steps (quadratic Euler) keep the quality of 100, within the "
        "interval; 25 lose FID. The interval leaves room for a loss of 0 % in FID."
    )
    assert said[1] == (
        "No wish: the fewest network calls that keep it are 10, of 2 methods with quadratic "
        "multistep. The interval leaves room for a loss of 0 % in FID."
    )
    assert fewer_steps_ways.Way("even", "Euler", 5, "pelvis", 1).task == "pelvis, 1 keyframe"
