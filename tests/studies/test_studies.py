"""The studies run, and their tables hold what they say; on a prior too small to be good."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from data_synth import ACTIONS, make_clips
from projflow_lite.prior.training import RECIPES, train
from projflow_lite.skeleton import JOINTS
from projflow_lite.studies import contact_sheet, keyframes


@pytest.fixture(scope="module")
def prior(tmp_path_factory):
    return train(replace(RECIPES["smoke"], steps=2), tmp_path_factory.mktemp("run"), progress=False)


def test_keyframes_are_spread_and_every_frame_is_every_frame():
    assert keyframes.keyframes(1).tolist() == [30]
    assert keyframes.keyframes(5).tolist() == [10, 20, 30, 39, 49]
    assert keyframes.keyframes(60).tolist() == list(range(60))


@pytest.mark.parametrize("metric", ["kinematic", "moving"])
def test_every_clip_goes_through_its_own_keyframes(metric):
    clips = make_clips(3, seed=1)
    step = keyframes.through_keyframes(clips.positions, "left_wrist", 5, metric)
    x = step(torch.randn(3, 60, 22, 3), 0.5).numpy()
    frames, joint = keyframes.keyframes(5), JOINTS.index("left_wrist")
    np.testing.assert_array_equal(x[:, frames, joint], clips.positions[:, frames, joint])


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
