import numpy as np
import pytest

import projflow_lite as pf


def some_positions(*shape):
    return np.random.default_rng(0).normal(size=(*shape, 22, 3)).astype(np.float32)


def test_a_motion_comes_back_from_a_file_as_it_was(tmp_path):
    motion = pf.Motion(some_positions(7), "a person waves")
    motion.save(tmp_path / "m.npz")
    again = pf.Motion.load(tmp_path / "m.npz")
    np.testing.assert_array_equal(again.positions, motion.positions)
    assert (again.prompt, again.fps) == ("a person waves", 20)


def test_a_batch_is_a_sequence_of_motions():
    batch = pf.Motion(some_positions(3, 7), ["a", "b", "c"])
    assert len(batch) == 3
    assert [m.prompt for m in batch] == ["a", "b", "c"]
    assert [m.positions.shape for m in batch] == [(7, 22, 3)] * 3
    assert len(pf.Motion(some_positions(7))) == 1


def test_a_truncated_file_is_named(tmp_path):
    path = tmp_path / "m.npz"
    pf.Motion(some_positions(7)).save(path)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(ValueError, match=r"m\.npz is not a readable motion file"):
        pf.Motion.load(path)


def test_wrong_positions_are_refused():
    with pytest.raises(
        ValueError, match=r"expected shape \(\.\.\., frames, 22, 3\), got \(4, 21, 3\)"
    ):
        pf.Motion(np.zeros((4, 21, 3)))
    bad = some_positions(4)
    bad[2, 5, 1] = np.nan
    with pytest.raises(ValueError, match="right_knee, frame 2, y is not finite"):
        pf.Motion(bad)


def test_the_residual_is_the_largest_miss_over_the_hard_rows():
    x = some_positions(6)
    target = x[[1, 4], 20].astype(np.float64)
    target[1, 2] += 0.25
    wish = pf.pin("left_wrist", [1, 4], target) & pf.pin("head", 0, [9, 9, 9], std=0.1)
    assert pf.Motion(x, wish=wish).residual == pytest.approx(0.25, abs=1e-7)
    assert pf.Motion(x).residual == 0.0


def test_one_motion_of_a_batch_by_its_index():
    batch = pf.Motion(
        np.arange(3.0)[:, None, None, None] + np.zeros((3, 4, 22, 3)), ["a", "b", "c"]
    )
    assert batch[1].prompt == "b"
    assert batch[-1].positions.shape == (4, 22, 3)
    assert batch[2].positions[0, 0, 0] == 2
    with pytest.raises(IndexError, match="Motion: index 3 in a batch of 3"):
        batch[3]
