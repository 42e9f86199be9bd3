"""The explorer of methods: same noise, same wish, and numbers that say what was given up."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite.prior import conditioned_files
from projflow_lite.skeleton import CONTROLLED
from projflow_lite.studies.control_ways import TRAINED
from projflow_lite.studies.method_explorer import MOVING, WAYS, MethodExplorer
from projflow_lite.widgets.recording import family, record


class Still:
    """The flow to one body that stands a metre up, with a little of everything that x_t says."""

    noise_std = 0.3

    def __call__(self, x_t, t, text):
        x1 = 0.9 * torch.tensor([0.0, 1.0, 0.0]) + 0.1 * x_t
        return (x1 - x_t) / (1 - t)


@pytest.fixture(scope="module")
def explorer():
    made = MethodExplorer(Still(), frames=24, batch=2)
    made.try_all()
    return made


def test_every_method_has_its_line(explorer):
    trained = {rival.name for rival in TRAINED}
    free = [name for name in WAYS if name not in trained]
    assert list(explorer.outcomes) == ["projflow", *(name for name in free if name != "projflow")]
    assert explorer.table.value.count("<tr") == 1 + len(free)
    assert "font-weight: bold" in explorer.table.value


def test_the_exact_methods_are_exact_and_no_wish_misses(explorer):
    missed = {name: outcome.numbers[0] for name, outcome in explorer.outcomes.items()}
    for name in ("projflow", MOVING.name, "ddnm", "replacement", "imputation"):
        assert missed[name] < 1e-3, name
    assert missed["no wish"] > 10


def test_numbers_are_those_of_the_motion(explorer):
    name = explorer.joint.value
    at = explorer.keyframes
    motion = explorer.outcomes["dps"].motion
    by_hand = np.mean(
        [
            np.linalg.norm(motion.joint(name)[b, f] - explorer.clip.joint(name)[f])
            for b in range(2)
            for f in at
        ]
    )
    assert explorer.outcomes["dps"].numbers[0] == pytest.approx(100 * by_hand)


def test_another_wish_begins_anew():
    explorer = MethodExplorer(Still(), frames=24, batch=1)
    explorer.method.value = "ddnm"
    assert list(explorer.outcomes) == ["projflow", "ddnm"]
    explorer.count.value = 2
    assert list(explorer.outcomes) == ["ddnm"]
    assert len(explorer.keyframes) == 2
    explorer.count.value = 5
    assert list(explorer.outcomes) == ["projflow", "ddnm"], "and an earlier one is remembered"
    explorer.joint.value = "head"
    assert list(explorer.outcomes) == ["ddnm"]
    assert explorer.viewer.trail == [15]
    assert explorer.viewer.motion.residual < 1e-6


def test_a_trained_method_is_left_out_with_a_sentence(explorer):
    assert set(WAYS) - set(explorer.method.options) == {rival.name for rival in TRAINED}
    assert "another prior" in explorer.left_out.value
    assert explorer.left_out in explorer.children


def test_the_control_branch_is_loaded_when_it_is_chosen():
    prior = pf.load_prior()
    explorer = MethodExplorer(prior, frames=24, batch=1)
    assert explorer.joint.options == CONTROLLED
    assert list(explorer._models) == [""]
    explorer.method.value = "control branch"
    assert list(explorer._models) == ["", "control_branch"]
    missed = explorer.outcomes["control branch"].numbers[0]
    assert missed < explorer.try_method("no wish").numbers[0]


def test_a_model_that_the_package_does_not_have_is_named(monkeypatch):
    def gone(name, who):
        raise FileNotFoundError

    monkeypatch.setattr(conditioned_files, "shipped", gone)
    explorer = MethodExplorer(pf.load_prior(), frames=24, batch=1)
    assert "control branch" not in explorer.ways
    assert "control branch, whose model is not in the package" in explorer.left_out.value


def test_a_page_without_python_can_play_every_control_back():
    explorer = MethodExplorer(Still(), frames=24, batch=1)
    explorer.try_all()
    records = record(family(explorer), seconds=60.0)
    assert records.silent == []
    assert records.strayed == {}
    assert {r.control.widget for r in records.recordings} == {
        explorer.method, explorer.joint, explorer.count,
    }  # fmt: skip
    assert all(len(r.stops) == len(r.control.stops) for r in records.recordings)


def test_a_prompt_that_no_clip_has_is_refused():
    with pytest.raises(ValueError, match="no held-out clip is called 'flies'"):
        MethodExplorer(Still(), "flies", frames=24)
