"""The Python side of the metric explorer: what it takes, what it refuses, its default metric."""

from __future__ import annotations

import numpy as np
import pytest
from traitlets import TraitError

from projflow_lite.skeleton import EDGES, bone_lengths
from projflow_lite.widgets import MetricExplorer
from projflow_lite.widgets.metric_explorer import equal_strain_metric
from projflow_lite.widgets.standing import standing_pose


def test_it_starts_with_the_constants_of_table_5():
    explorer = MetricExplorer()
    assert (explorer.w_kin, explorer.ridge, explorer.joint) == (10.0, 1.0, "left_wrist")
    np.testing.assert_array_equal(explorer.rest, standing_pose()[0])
    assert explorer.own_name == "equal strain"


def test_a_joint_may_be_given_by_its_index_and_a_pull_as_a_tuple():
    explorer = MetricExplorer(joint=15, pull=(0, 0.5, 0))
    assert explorer.joint == "head"
    explorer.pull = (0.1, 0, 0)
    assert explorer.pull == [0.1, 0.0, 0.0]


def test_a_metric_goes_in_and_comes_back_to_the_last_bit():
    root = np.random.default_rng(0).normal(size=(22, 22))
    R_J = root @ root.T + np.eye(22)
    explorer = MetricExplorer(R_J)
    np.testing.assert_array_equal(explorer.metric, R_J)
    assert explorer.own_name == "your metric"
    explorer.metric = 2 * R_J
    np.testing.assert_array_equal(explorer.metric, 2 * R_J)


def test_equal_strain_charges_every_bone_the_same_for_one_percent():
    """Moving a joint and all beyond it by one percent of the bone before it costs w l² / 10⁴."""
    pose = standing_pose()
    lengths = bone_lengths(pose)[0]
    R_J = equal_strain_metric(w_kin=7.0, ridge=1e-9)
    costs = []
    for bone, (_, child) in enumerate(EDGES):
        beyond = {child}
        for parent, end in EDGES:  # a parent comes before its child
            if parent in beyond:
                beyond.add(end)
        u = np.zeros(22)
        u[list(beyond)] = 0.01 * lengths[bone]
        costs.append(u @ R_J @ u)
    np.testing.assert_allclose(costs, 7.0 * 1e-4 * np.mean(lengths**2), rtol=1e-6)


def test_a_shift_of_the_whole_body_costs_the_ridge_alone():
    ones = np.ones(22)
    assert ones @ equal_strain_metric(ridge=3.0) @ ones == pytest.approx(66.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"joint": "left_wirst"}, "MetricExplorer: 'left_wirst' is not a joint; did you mean"),
        ({"metric": np.eye(21)}, r"metric has shape \(21, 21\), expected \(22, 22\)"),
        ({"metric": np.ones((22, 22))}, "not positive definite; add a small multiple"),
        ({"metric": np.triu(np.ones((22, 22)))}, "metric is not symmetric"),
        ({"metric": np.full((22, 22), np.nan)}, "not finite"),
        ({"pull": (0, 0)}, r"pull has shape \(2,\), expected \(3,\)"),
        ({"pull": (0, 3, 0)}, "pull must be within 2 m"),
        ({"pull": (0, np.inf, 0)}, "pull has a value that is not finite"),
        ({"w_kin": -1.0}, "w_kin must be in 0..1e6, got -1"),
        ({"ridge": 0.0}, "ridge must be in .*a shift of the whole body is free"),
        ({"ridge": float("nan")}, "ridge must be in"),
        ({"pose": np.zeros((22, 3))}, "bone pelvis – left_hip of the pose has no length"),
        ({"pose": np.zeros((3, 3))}, r"pose has shape \(3, 3\)"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises((ValueError, TraitError), match=message):
        MetricExplorer(**arguments)


def test_bad_changes_are_refused_and_leave_what_was():
    explorer = MetricExplorer()
    for name, value in (("joint", "tail"), ("pull", [0, 9, 0]), ("w_kin", -1), ("ridge", 0)):
        before = getattr(explorer, name)
        with pytest.raises((ValueError, TraitError)):
            setattr(explorer, name, value)
        assert getattr(explorer, name) == before
    before = explorer.metric
    with pytest.raises(ValueError, match="not positive definite"):
        explorer.metric = -np.eye(22)
    np.testing.assert_array_equal(explorer.metric, before)
