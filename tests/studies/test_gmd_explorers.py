"""The explorers of GMD: what they ask for is sampled, and numbers are those of the motion."""

import numpy as np
import pytest
import torch

from projflow_lite.prior.small_training import EmphasisRecipe, TrajectoryRecipe
from projflow_lite.prior.training import Recipe
from projflow_lite.studies import gmd_ways
from projflow_lite.studies.gmd_explorer import COLUMNS, GmdExplorer
from projflow_lite.studies.gmd_ways import HOWS, PROJFLOW, Models
from projflow_lite.studies.obstacle_walk import RADIUS, ObstacleWalk

SIZES = {"steps": 1, "batch": 4, "widths": (16, 24)}


@pytest.fixture(scope="module")
def models():
    """Priors that have learnt nothing, but how motion is spread; none with c = 1."""
    emphasised = EmphasisRecipe(**SIZES).trainer().model.eval().requires_grad_(False)
    planner = TrajectoryRecipe(**SIZES).trainer().result()
    return Models(Recipe(**SIZES).trainer().result(), {10.0: emphasised}, planner)


@pytest.fixture
def explorer(models, monkeypatch):
    monkeypatch.setattr(gmd_ways, "STEPS", 2)
    return GmdExplorer(models, batch=2)


def test_every_way_has_its_line(explorer):
    explorer.try_all()
    assert set(explorer.outcomes) == set(HOWS) - {"mixing (c = 1)"}
    assert explorer.table.value.count("<tr") == 1 + len(explorer.outcomes)
    assert all(len(out.numbers) == len(COLUMNS) for out in explorer.outcomes.values())


def test_numbers_and_wish_are_those_of_the_motion(explorer):
    explorer.method.value = PROJFLOW
    explorer.count.value = 2
    assert list(explorer.outcomes) == [PROJFLOW]
    shown = explorer.viewer.motion
    assert shown.residual < 1e-5
    assert explorer.outcomes[PROJFLOW].numbers[0] == pytest.approx(0, abs=1e-3)
    explorer.method.value = "imputation"
    frames = gmd_ways.keyframes(2)
    x = explorer.outcomes["imputation"].motion.positions
    away = (x - explorer.clips.positions)[:, frames, 0]
    by_hand = 100 * np.hypot(away[..., 0], away[..., 2]).mean()
    assert explorer.outcomes["imputation"].numbers[0] == pytest.approx(by_hand)


def test_another_tau_begins_anew(explorer):
    explorer.method.value = "emphasis, guidance, lines"
    before = explorer.viewer.motion.positions.copy()
    explorer.tau.value = 0.0
    assert list(explorer.outcomes) == ["emphasis, guidance, lines"]
    assert np.abs(explorer.viewer.motion.positions - before).max() > 1e-6


class Straight:
    """The flow to one body that slides from the origin to z = 3, and follows its state."""

    noise_std = 0.3

    def __call__(self, x_t, t, text):
        frames = x_t.shape[1]
        path = torch.zeros(frames, 1, 3)
        path[:, 0, 2] = torch.linspace(0, 3, frames)
        x1 = 0.3 * path * (1 - t) + x_t * (0.7 + 0.3 * t)
        return (x1 - x_t) / (1 - t)


def test_a_post_in_the_way_is_gone_around():
    walk = ObstacleWalk(Straight(), frames=24, goal=(0.0, 3.0), scale=0.0)
    post = np.array(walk.board.positions["post 1"])
    track = walk.motion.joint("pelvis")[:, [0, 2]]
    inside = RADIUS - np.linalg.norm(track - post, axis=-1)
    assert walk.numbers[0] == pytest.approx(100 * inside.max().clip(0), abs=1e-3)
    assert walk.numbers[1] == pytest.approx(100 * (inside > 0).mean())
    assert walk.numbers[2] == pytest.approx(100 * np.linalg.norm(track[-1] - [0, 3]), abs=1e-3)
    before = walk.motion.positions
    walk.scale.value = 100.0
    assert np.abs(walk.motion.positions - before).max() > 1e-3


def test_a_post_on_the_start_is_refused_in_words():
    walk = ObstacleWalk(Straight(), frames=24)
    before = walk.motion
    walk.board.handle("post 1", (0.1, 0.1), color="noise")
    walk.run()
    assert "an obstacle covers the start point" in walk.said.value
    assert walk.motion is before
