"""The Python side of the path pad: paths in and out, planes, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from stage import walking
from traitlets import TraitError

from projflow_lite.widgets import BOUNDS, PLANES, PathPad
from projflow_lite.widgets.front_end import pack
from projflow_lite.widgets.path_pad import spread


def test_an_empty_pad_has_no_path():
    pad = PathPad()
    assert pad.path is None
    assert pad.targets() is None


@pytest.mark.parametrize("plane", list(PLANES))
def test_targets_leave_the_third_axis_free(plane):
    pad = PathPad(plane, samples=3)
    pad.path = [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]
    free = ({0, 1, 2} - set(PLANES[plane])).pop()
    targets = pad.targets()
    assert np.isnan(targets[:, free]).all()
    np.testing.assert_allclose(targets[:, PLANES[plane]], pad.path)
    assert pad.bounds == list(BOUNDS[plane])


def test_a_path_of_other_length_is_spread_evenly():
    pad = PathPad(samples=5)
    pad.path = [[0, 0], [0, 1], [3, 1]]
    np.testing.assert_allclose(pad.path, [[0, 0], [0, 1], [1, 1], [2, 1], [3, 1]], atol=1e-6)
    np.testing.assert_allclose(spread([[1.0, 2.0]], 3), [[1, 2]] * 3)


def test_version_counts_paths_set_from_python_too():
    pad = PathPad(samples=2)
    seen = []
    pad.observe(lambda change: seen.append(change["new"]), "version")
    pad.path = [[0, 0], [1, 1]]
    pad.path = None
    assert seen == [1, 2]
    assert pad.path is None


def test_what_the_page_sends_arrives_as_one_event():
    pad = PathPad(samples=2)
    seen = []
    pad.observe(lambda change: seen.append(pad.path.tolist()), "version")
    pad.set_state({"path_data": memoryview(pack([[0, 0.5], [1, 0.25]])), "version": 1})
    assert seen == [[[0, 0.5], [1, 0.25]]]


def test_another_plane_clears_the_path_and_another_length_resamples_it():
    pad = PathPad(samples=2)
    pad.path = [[0, 0], [1, 1]]
    pad.samples = 3
    np.testing.assert_allclose(pad.path, [[0, 0], [0.5, 0.5], [1, 1]])
    pad.plane = "zy"
    assert pad.path is None
    assert pad.bounds == list(BOUNDS["zy"])


def test_reference_is_the_body_seen_in_the_plane():
    pad = PathPad("zy")
    motion = walking(4)
    pad.show_reference(motion, "left_wrist")
    assert pad.joint_name == "left wrist"
    np.testing.assert_allclose(pad.joint_path, motion.joint("left_wrist")[:, [2, 1]])
    np.testing.assert_allclose(pad.reference[0][0], motion.positions[0, 0, [2, 1]])


def test_given_bounds_win_over_those_of_the_plane():
    assert PathPad("xz", bounds=[0, 1, 0, 1]).bounds == [0, 1, 0, 1]


@pytest.mark.parametrize(
    ("traits", "message"),
    [
        ({"plane": "yx"}, "plane"),
        ({"samples": 1}, "samples must be 2..2000, got 1"),
        ({"smoothing": -1.0}, "smoothing must be 0..1 metres"),
        ({"bounds": [1, 0, 0, 1]}, "each pair growing"),
        ({"bounds": [0, 1, 0, float("nan")]}, "4 finite metres"),
        ({"joint_path": [[1, 2, 3]]}, "joint_path needs finite"),
        ({"path_data": b"1234"}, "not pairs of float32"),
        ({"path_data": pack([np.nan, 0])}, "not finite"),
    ],
)
def test_bad_state_is_refused(traits, message):
    with pytest.raises((TraitError, ValueError, KeyError), match=message):
        PathPad(**traits)


def test_bad_paths_are_refused():
    for points in ([[1, 2, 3]], [], [[0, np.inf]]):
        with pytest.raises(ValueError, match="expected finite points"):
            PathPad().path = points
