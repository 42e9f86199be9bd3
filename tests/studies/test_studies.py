"""The studies run, and their tables hold what they say; on a prior too small to be good."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import ACTIONS, make_clips
from projflow_lite.prior.training import RECIPES, train
from projflow_lite.skeleton import JOINTS
from projflow_lite.studies import contact_sheet, noise_reading


@pytest.fixture(scope="module")
def prior(tmp_path_factory):
    return train(replace(RECIPES["smoke"], steps=2), tmp_path_factory.mktemp("run"), progress=False)


def test_keyframes_are_spread_and_every_frame_is_every_frame():
    assert noise_reading.keyframes(1).tolist() == [30]
    assert noise_reading.keyframes(5).tolist() == [10, 20, 30, 39, 49]
    assert noise_reading.keyframes(60).tolist() == list(range(60))


@pytest.mark.parametrize("reading", noise_reading.READINGS)
def test_every_clip_goes_through_its_own_keyframes(prior, reading):
    clips = make_clips(3, seed=1)
    options = noise_reading.READINGS[reading]
    x = noise_reading.controlled(prior, clips, "left_wrist", 5, 2.0, 3, options, seed=0)
    frames, joint = noise_reading.keyframes(5), JOINTS.index("left_wrist")
    np.testing.assert_array_equal(x[:, frames, joint], clips.positions[:, frames, joint])


def test_the_table_has_a_row_for_everything_that_was_asked(prior):
    rows = noise_reading.run(prior, 3, 2, 2, ("pelvis",), (1,), (1.0,))
    assert [row["method"] for row in rows] == ["held-out data", "no wish", *noise_reading.READINGS]
    for row in rows:
        assert all(np.isfinite([c["mean"], c["half width"]]).all() for c in row["scores"].values())
    text = noise_reading.table(rows)
    assert len(text.splitlines()) == 1 + len(rows)
    assert "kinetic distance" in text


def test_held_out_motion_has_perfect_bones_in_the_table(prior):
    row = noise_reading.run(prior, 3, 2, 2, (), (), ())[0]["scores"]
    assert row["bone error %"]["mean"] < 1e-3


def test_pictures_show_every_action(prior, tmp_path):
    paths = contact_sheet.run(prior, tmp_path, frames=40)
    assert [path.name for path in paths] == [
        "actions.png",
        "all_actions.png",
        "data.png",
        "heart.gif",
    ]
    assert all(path.stat().st_size > 10_000 for path in paths)
    assert len(ACTIONS) >= 8


def test_the_heart_is_a_heart():
    path = contact_sheet.heart(121)
    np.testing.assert_allclose(path[0], path[-1], atol=1e-12)
    np.testing.assert_allclose(path[:, 0] + path[::-1, 0], 2 * -0.38, atol=1e-12)  # symmetric
    tip = path[60]
    assert tip[1] == path[:, 1].min()
