"""Three metrics of one family: by hand, by minimisation, and as the explorer shows them."""

import numpy as np
import pytest
import torch
from scipy.optimize import minimize

from projflow_lite import equations as eq
from projflow_lite.prior.features import mixing_matrix, mixing_of_positions
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.skeleton import JOINTS
from projflow_lite.studies.gmd_metrics import MetricFamily, metric_of_gmd, pulled, three_metrics
from projflow_lite.widgets.standing import standing_pose

SPREADS = (1.5, 0.25)
POSE = standing_pose()[0]
WRIST = JOINTS.index("left_wrist")
PULL = np.array([0.3, 0.2, -0.1])


def test_ddnm_moves_one_joint_and_projflow_its_neighbours():
    plain, _, kinematic = (
        pulled(POSE, "left_wrist", PULL, R) - POSE for R in three_metrics(10, SPREADS)
    )
    others = np.delete(np.arange(22), WRIST)
    np.testing.assert_allclose(plain[WRIST], PULL)
    np.testing.assert_allclose(plain[others], 0, atol=1e-12)
    shares = kinematic[:, 0] / PULL[0]
    np.testing.assert_allclose(
        shares[[JOINTS.index(j) for j in ("left_elbow", "left_shoulder", "pelvis")]],
        [0.71, 0.49, 0.05], atol=0.01,
    )  # fmt: skip


@pytest.mark.parametrize("c", [0.5, 10.0])
def test_gmd_takes_the_body_along_by_a_share_worked_out_by_hand(c):
    """With rho the price of the place beside the body's: 1 / (1 + rho^2) of the pull."""
    moved = pulled(POSE, "left_wrist", PULL, metric_of_gmd(c, SPREADS)) - POSE
    rho = c * SPREADS[1] / SPREADS[0]
    share = np.array([1 / (1 + rho**2), 0.5, 1 / (1 + rho**2)])  # height is not emphasised
    others = np.delete(np.arange(22), WRIST)
    np.testing.assert_allclose(moved[WRIST], PULL)
    np.testing.assert_allclose(moved[others], np.tile(share * PULL, (21, 1)), atol=1e-9)


@pytest.mark.parametrize("orthogonal", [True, False])
@pytest.mark.parametrize("joint", ["pelvis", "left_wrist"])
def test_the_metric_is_the_shortest_way_in_projected_space(orthogonal, joint):
    """`project` with R, against DDNM on projected poses, undone; for any A'."""
    A, k = mixing_matrix(10, seed=3, orthogonal=orthogonal)
    T = mixing_of_positions(A, SPREADS)
    p = JOINTS.index(joint)
    S = np.eye(66)[3 * p : 3 * p + 3]
    nearest = eq.nearest_emphasised(k * T @ POSE.ravel(), S, POSE[p] + PULL, T, k)
    ours = pulled(POSE, joint, PULL, metric_of_gmd(10, SPREADS, orthogonal, seed=3))
    np.testing.assert_allclose(np.linalg.solve(k * T, nearest).reshape(22, 3), ours, atol=1e-6)


def test_the_metric_against_a_minimiser_that_knows_only_features():
    """Least squares of features divided by their spreads, written out; c = 2."""
    weight = np.full(66, 1 / SPREADS[1])
    weight[[0, 2]] = 2.0 / SPREADS[0]

    def price(free):
        delta = np.insert(free.reshape(21, 3), WRIST, PULL, axis=0)
        features = np.concatenate([delta[:1], delta[1:] - delta[:1]]).ravel()
        return ((weight * features) ** 2).sum()

    found = minimize(price, np.zeros(63), method="BFGS", options={"gtol": 1e-9}).x
    ours = pulled(POSE, "left_wrist", PULL, metric_of_gmd(2, SPREADS)) - POSE
    np.testing.assert_allclose(found.reshape(21, 3), np.delete(ours, WRIST, 0), atol=1e-5)


@pytest.mark.parametrize("c", [0.3, 10.0])
def test_imputation_that_takes_the_body_along_is_this_projection(c):
    """GMD overwrites the pelvis' place: that is `project` with its metric, whatever c is."""
    mask = torch.zeros(1, 22, 3, dtype=torch.bool)
    mask[0, 0, [0, 2]] = True
    values = torch.zeros(1, 22, 3, dtype=torch.float64)
    values[0, 0] = torch.tensor([0.4, 9.0, -0.2])
    overwritten = Imputation(mask, values, along=True)(torch.as_tensor(POSE)[None, None])[0, 0]
    A = np.eye(66)[[0, 2]]
    R = metric_of_gmd(c, SPREADS)
    projected = eq.project(POSE.ravel(), A, np.array([0.4, -0.2]), R, np.zeros((2, 2)))
    np.testing.assert_allclose(overwritten, projected.reshape(22, 3), atol=1e-9)


def test_a_gaussian_mixing_scatters_the_body():
    moved = pulled(POSE, "left_wrist", PULL, metric_of_gmd(10, SPREADS, orthogonal=False)) - POSE
    others = np.delete(moved, WRIST, axis=0)
    assert others.std(0).min() > 0.02
    np.testing.assert_allclose(moved[WRIST], PULL, atol=1e-6)


def test_the_explorer_shows_what_is_computed():
    family = MetricFamily(SPREADS)
    assert family.viewer.shape == [6, 30, 22, 3]
    assert family.table.value.count("<tr>") == 4
    for control, value in ((family.c, 0.1), (family.joint, "pelvis"), (family.pull[2], -0.4)):
        control.value = value
    R = three_metrics(0.1, SPREADS)
    pull = [slider.value for slider in family.pull]
    for body, metric in zip(family.bodies, R, strict=True):
        np.testing.assert_allclose(body, pulled(family.pose, "pelvis", pull, metric))
    assert family.numbers[0][0] == pytest.approx(100 * np.linalg.norm(pull))
    assert family.numbers[1][2] == pytest.approx(0, abs=1e-6)  # GMD takes the whole body along
    assert family.numbers[0][2] > 10  # DDNM tears the pelvis out
    orthogonal = family.bodies[1].copy()
    family.mixing.value = False
    assert np.abs(family.bodies[1] - orthogonal).max() > 0.01
