"""The study of GMD beside ProjFlow: what it asks for, counts and stores."""

import json
import sys

import numpy as np
import pytest
import torch

from data_synth import held_out
from projflow_lite.prior.small_training import EmphasisRecipe, TrajectoryRecipe
from projflow_lite.prior.training import Recipe
from projflow_lite.samplers.gmd import gmd
from projflow_lite.samplers.gmd_keyframes import gmd_keyframes
from projflow_lite.skeleton import JOINTS
from projflow_lite.studies import gmd_table, gmd_ways
from projflow_lite.studies.gmd_ways import (
    DENSITIES,
    FAR,
    HOWS,
    POST,
    PROJFLOW,
    TWO_STAGES,
    Models,
    Way,
    all_ways,
    make,
    post_of,
    projected,
    walks,
)

SIZES = {"steps": 1, "batch": 4, "widths": (16, 24)}


@pytest.fixture(scope="module")
def models():
    """Priors that have learnt nothing, but how motion is spread."""
    emphasised = {}
    for c in (1.0, 10.0):
        trainer = EmphasisRecipe(**SIZES, c=c).trainer()
        emphasised[c] = trainer.model.eval().requires_grad_(False)
    return Models(Recipe(**SIZES).trainer().result(), emphasised, TrajectoryRecipe(**SIZES).trainer().result())  # fmt: skip


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(gmd_ways, "STEPS", 2)


@pytest.fixture(scope="module")
def clips():
    return held_out(3, 60, 3)


def miss(x, clips, frames):
    """Distance of the pelvis to its keyframes over the ground, worked out here."""
    away = (x - clips.positions)[:, frames, JOINTS.index("pelvis")]
    return np.hypot(away[..., 0], away[..., 2])


def test_every_method_is_measured_at_every_density(models):
    ways = all_ways(models)
    assert len(set(ways)) == len(ways)
    assert len({way.name for way in ways}) == len(ways)
    for method in set(HOWS) - {"no control"}:
        assert {w.keys for w in ways if w[:2] == ("keyframes", method)} == {1, 2, 5, 15, 60}
    assert DENSITIES[-2] == 0.25 * 60
    assert len(all_ways(models, quick=True)) < 0.5 * len(ways)
    without = Models(models.plain, {10.0: models.emphasised[10.0]}, models.planner)
    assert "mixing (c = 1)" not in {way.method for way in all_ways(without)}


@pytest.mark.parametrize("keys", [1, 5, 60])
def test_projection_meets_keyframes_on_the_ground_and_no_height(models, clips, short, keys):
    way = Way("keyframes", PROJFLOW, keys)
    x, seconds = make(models, way, clips, seed=0)
    frames = gmd_ways.frames_of(way)
    assert miss(x, clips, frames).max() < 1e-5
    assert np.abs((x - clips.positions)[:, frames, 0, 1]).max() > 1e-3
    assert seconds > 0
    assert projected(clips, way).projector.project(torch.as_tensor(x)).shape == x.shape


@pytest.mark.parametrize("method", [name for name in HOWS if name not in (PROJFLOW, "no control")])
def test_every_way_of_gmd_imputes_the_keyframes_of_every_clip(
    models, clips, short, monkeypatch, method
):
    """Told to insist until the end, each is exact: the keyframes are those of the clip."""

    def insisting(*args, **options):
        return gmd(*args, **options | {"until": 1.0})

    monkeypatch.setattr(gmd_ways, "gmd", insisting)
    monkeypatch.setattr(sys.modules[gmd_keyframes.__module__], "gmd", insisting)
    way = Way("keyframes", method, 5)
    x, _ = make(models, way, clips, seed=0)
    assert miss(x, clips, gmd_ways.frames_of(way)).max() < 1e-5


def test_errors_are_those_of_the_ground(models, clips, short):
    way = Way("keyframes", "imputation", 5)
    x, _ = make(models, way, clips, seed=0)
    reference = gmd_table.features_of(held_out(16, 60, 1).positions)
    row = gmd_table.measured(models, way, clips, 0, reference)
    away = miss(x, clips, gmd_ways.frames_of(way))
    assert row["error, m"] == pytest.approx(away.mean(), rel=1e-5)
    assert row["location error %"] == pytest.approx(100 * (away > 0.5).mean())
    assert row["trajectory error %"] == pytest.approx(100 * (away > 0.5).any(1).mean())
    assert set(row) == set(gmd_table.COLUMNS["keyframes"])


def test_a_bone_that_is_twice_as_long_in_one_frame_is_a_tear():
    clip = held_out(2, 60, 1).positions.astype(float)
    assert gmd_table.tears(clip).max() < 1e-3
    clip[1, 30, 20] += clip[1, 30, 20] - clip[1, 30, 18]  # a hand that shoots out
    np.testing.assert_allclose(gmd_table.tears(clip), [0, 1], atol=1e-3)


def test_planted_feet_walk_the_whole_way_and_carried_bodies_none_of_it():
    clip = held_out(8, 60, 1, actions=["walk"]).positions.astype(float)
    assert 0.85 < gmd_table.walked(clip) < 1.02
    frozen = clip - clip[:, :, :1] + clip[:, :1, :1]
    frozen = np.repeat(frozen[:, :1], 60, axis=1)
    carried = frozen + np.linspace(0, 2, 60)[:, None, None] * [0, 0, 1.0]
    assert gmd_table.walked(carried) == pytest.approx(0, abs=1e-9)
    planted = carried.copy()  # the left foot stays on the floor, all else goes on
    planted[:, :, JOINTS.index("left_foot")] = frozen[:, :, JOINTS.index("left_foot")] * [1, 0, 1]
    assert gmd_table.walked(planted) == pytest.approx(1)


def test_a_post_stands_in_the_way_of_every_walk():
    made = walks(16, 5)
    track = made.positions[:, :, 0][..., [0, 2]]
    assert (np.linalg.norm(track[:, -1], axis=-1) > FAR - 1e-3).all()
    depth = post_of(made).depth(made.positions).numpy()
    np.testing.assert_allclose(depth[:, 30], POST, atol=1e-5)
    assert (depth[:, [0, 59]] == 0).all()
    aside = made.positions.copy()
    aside[:, :, :, 0] += 1e3
    assert (post_of(made).depth(aside) == 0).all()


def test_an_obstacle_is_scored_by_depth_and_time_inside(models, short):
    made = walks(4, 5)
    way = Way("obstacle", PROJFLOW, 1)
    reference = gmd_table.features_of(held_out(16, 60, 1).positions)
    row = gmd_table.measured(models, way, made, 0, reference)
    x, _ = make(models, way, made, 0)
    centre = made.positions[:, 30, 0][:, [0, 2]]
    inside = POST - np.linalg.norm(x[:, :, 0][..., [0, 2]] - centre[:, None], axis=-1)
    assert row["depth, cm"] == pytest.approx(100 * inside.max(1).clip(0).mean(), abs=1e-4)
    assert row["frames inside %"] == pytest.approx(100 * (inside > 0).mean())
    assert row["clear %"] == pytest.approx(100 * (inside <= 0).all(1).mean())


def test_an_interrupted_run_goes_on(models, tmp_path, monkeypatch, short):
    few = [
        Way("keyframes", "no control", 60), Way("keyframes", "imputation", 5),
        Way("keyframes", PROJFLOW, 5), Way("tau", TWO_STAGES, 5, 0.5),
        Way("obstacle", PROJFLOW, 1), Way("obstacle", TWO_STAGES, 1, scale=10.0),
    ]  # fmt: skip
    monkeypatch.setattr(gmd_table, "all_ways", lambda models, quick: few)
    made, real = [], make

    def breaking(models, way, clips, seed):
        made.append((way, seed))
        if len(made) == 4:
            raise KeyboardInterrupt
        return real(models, way, clips, seed)

    monkeypatch.setattr(gmd_table, "make", breaking)
    options = {"clips": 16, "seeds": 2, "folder": tmp_path, "progress": False}
    with pytest.raises(KeyboardInterrupt):
        gmd_table.run(models, **options)
    rows = gmd_table.run(models, **options)
    assert len(made) == 2 * len(few) + 1  # nothing was made twice but what broke
    assert gmd_table.run(models, **options) == rows
    assert [row["task"] for row in rows[1:]] == [way.task for way in few]
    for row in rows:
        for cell in row["scores"].values():
            assert cell["mean"] == pytest.approx(np.mean(cell["values"]))
    json.dumps(rows)
    text = gmd_table.table(rows)
    assert sum(line.startswith(PROJFLOW) for line in text.splitlines()) == 2
    assert gmd_table.figure(rows, tmp_path / "gmd.png").stat().st_size > 10_000


def test_too_few_clips_or_seeds_are_refused(models):
    with pytest.raises(ValueError, match="at least 16 clips and 2 seeds, not 8 and 4"):
        gmd_table.run(models, clips=8)
