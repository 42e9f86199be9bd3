"""All scores of a set of clips in one call."""

import numpy as np
import pytest

from data_synth import held_out
from projflow_lite import scores
from projflow_lite.motion import Motion


@pytest.fixture(scope="module")
def data():
    return held_out(64, 40, seed=1)


def test_every_score_is_what_its_own_function_says(data):
    other = held_out(96, 40, seed=2).positions
    row = scores.score_clips(data.positions, data.captions, other)
    judge = scores.load_evaluator()
    motion, text = judge.embed_motion(data.positions), judge.embed_text(data.captions)
    expected = {
        "bone error %": 100 * scores.bone_length_error(data.positions).mean(),
        "worst acceleration": scores.worst_acceleration(data.positions).mean(),
        "skating gmd": scores.foot_skating(data.positions).mean(),
        "skating bmm": scores.foot_skating(data.positions, definition="bmm").mean(),
        "jerk": scores.mean_jerk(data.positions).mean(),
        "diversity": scores.diversity(motion),
        "FID": scores.frechet_distance(motion, judge.embed_motion(other)),
        "kinetic distance": scores.frechet_distance(
            scores.kinetic_features(data.positions), scores.kinetic_features(other)
        ),
        "matching": scores.matching_score(text, motion),
    }
    expected |= dict(
        zip(["R top 1", "R top 2", "R top 3"], scores.r_precision(text, motion)[:3], strict=True)
    )
    assert set(row) == set(expected)
    for name, value in expected.items():
        assert row[name] == pytest.approx(value, rel=1e-4, abs=1e-6), name


def test_clips_of_different_lengths_weigh_the_same(data):
    long = held_out(1, 80, seed=3).positions[0]
    row = scores.score_clips([data.positions[0], long])
    both = [scores.mean_jerk(data.positions[0]), scores.mean_jerk(long)]
    assert row["jerk"] == pytest.approx(np.mean(both))
    assert not {"FID", "matching", "R top 1"} & set(row)


def test_a_file_brings_its_own_captions(tmp_path, data):
    Motion(data.positions[:4], data.captions[:4]).save(tmp_path / "clips.npz")
    row = scores.score_clips(tmp_path / "clips.npz")
    assert row == scores.score_clips(data.positions[:4], data.captions[:4])
    assert "matching" in row
    Motion(data.positions[0]).save(tmp_path / "clip.npz")
    assert set(scores.score_clips(str(tmp_path / "clip.npz"))) == {
        "bone error %", "worst acceleration", "skating gmd", "skating bmm", "jerk",
    }  # fmt: skip


def test_what_cannot_be_scored_is_refused(data):
    with pytest.raises(ValueError, match="3 captions for 4 clips"):
        scores.score_clips(data.positions[:4], data.captions[:3])
    with pytest.raises(ValueError, match="there is no clip"):
        scores.score_clips([])
    with pytest.raises(ValueError, match="a clip is"):
        scores.score_clips(data.positions[None])
