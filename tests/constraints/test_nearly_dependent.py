"""Rows that all but imply each other: their condition number, what is said of it, and exactness."""

import warnings

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.projection import NearlyDependentRows


def parallel(angle, y=(0.0, 0.0)):
    """Rows on x of head and neck in one frame, at an angle to each other."""
    A = np.zeros((2, 66))
    A[:, 15 * 3] = 1, np.cos(angle)
    A[1, 12 * 3] = np.sin(angle)
    return pf.rows(A, y)


@pytest.mark.filterwarnings("ignore::projflow_lite.projection.NearlyDependentRows")
@pytest.mark.parametrize("degrees", [90, 60, 30, 5, 1, 0.1, 0.01, 0.001])
def test_the_condition_of_two_rows_is_the_cotangent_of_half_their_angle(degrees):
    angle = np.radians(degrees)
    projector = pf.Projector(parallel(angle).rows(1), "euclidean")
    assert projector.condition == pytest.approx(1 / np.tan(angle / 2), rel=1e-6)


def test_lengths_of_rows_do_not_count_but_the_metric_does():
    near, far = pf.rows(np.eye(2, 66, k=45), [0, 0]), pf.rows(1000 * np.eye(1, 66, k=45), [0])
    assert pf.Projector((near & far).rows(1)).condition == 1.0
    C = np.linalg.inv(kinematic_joint_metric())
    cosine = C[15, 12] / np.sqrt(C[15, 15] * C[12, 12])
    pins = pf.pin(["head", "neck"], 0, np.zeros((2, 3))).rows(1)
    expected = np.sqrt((1 + cosine) / (1 - cosine))
    assert pf.Projector(pins).condition == pytest.approx(expected, rel=1e-12)
    assert pf.Projector(pins, "euclidean").condition == 1.0


@pytest.mark.parametrize("frames", [2, 10, 60])
def test_the_condition_of_a_chain_of_velocities(frames):
    """Differences along a path have the singular values 2 sin(k pi / 2N), k = 1 .. N - 1."""
    wish = pf.velocity("head", range(frames - 1), np.zeros((frames - 1, 3)))
    size = np.sin(np.arange(1, frames) * np.pi / (2 * frames))
    expected = size[-1] / size[0]
    assert pf.Projector(wish.rows(frames)).condition == pytest.approx(expected, rel=1e-6)


def test_noise_of_its_own_tells_soft_rows_apart():
    """Two soft pins on one point: rows (s, std, 0) and (s, 0, std), with s^2 from the metric."""
    std, s2 = 0.1, np.linalg.inv(kinematic_joint_metric())[15, 15]
    twice = pf.pin("head", [0, 0], np.zeros((2, 3)), std=std).rows(1)
    expected = np.sqrt((2 * s2 + std**2) / std**2)
    assert pf.Projector(twice).condition == pytest.approx(expected, rel=1e-9)
    assert pf.Projector(pf.pin("head", [0, 0], np.zeros((2, 3))).rows(1)).condition == 1.0


def test_nearly_dependent_rows_are_named_with_their_condition_number():
    with pytest.warns(NearlyDependentRows) as caught:
        projector = pf.Projector(parallel(1e-4).rows(1), "euclidean")
    assert projector.condition == pytest.approx(2e4, rel=1e-6)
    assert str(caught[0].message) == (
        "row 0 (head, frame 0, x) and row 1 (0.0001 * neck, frame 0, x + 1 * head, frame 0, x) are "
        "nearly dependent: condition number 2e+04"
    )


def test_usual_wishes_are_not_warned_of():
    """What people ask for stays far below the condition number of a warning."""
    random = np.random.default_rng(0)
    half = random.choice(60, 30, replace=False)
    body = pf.pin(range(22), half, random.normal(size=(30, 22, 3)))
    hands = pf.offset("left_wrist", "right_wrist", [0.3, 0, 0])
    steps = pf.velocity("left_foot", range(10, 40), np.zeros((30, 3)))
    seam = pf.loop(moving=True, smooth=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        conditions = [
            pf.Projector(w.rows(60)).condition for w in (body, hands & seam, seam & steps)
        ]
    assert max(conditions) < 100


@pytest.mark.filterwarnings("ignore::projflow_lite.projection.NearlyDependentRows")
@pytest.mark.parametrize("angle", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("gap", [0.0, 0.01, 2.0])
def test_nearly_dependent_rows_are_met_exactly(angle, gap):
    """Targets that differ by a gap move the neck by gap / sin(angle): metres become kilometres.

    The residual is that of rounding such a motion: 1e-15 of it in float64, 1e-7 in float32.
    """
    rows = parallel(angle, (0.0, gap)).rows(1)
    x = np.random.default_rng(0).normal(size=(1, 22, 3))
    x[0, [15, 12], 0] = 0.0
    size = max(1.0, gap / np.sin(angle))
    for dtype, share in ((torch.float64, 1e-15), (torch.float32, 1e-7)):
        projector = pf.Projector(rows, "euclidean", dtype)
        z = projector.project(torch.as_tensor(x, dtype=dtype)).numpy().astype(np.float64)
        assert z[0, 12, 0] == pytest.approx(gap / np.sin(angle), rel=1e-6, abs=1e-12)
        miss = np.abs(rows.A @ z.ravel() - rows.y).max()
        assert miss <= share * max(10.0, size)


@pytest.mark.filterwarnings("ignore::projflow_lite.projection.NearlyDependentRows")
def test_a_motion_whose_every_acceleration_is_given_is_exact_in_float32():
    """Its condition number is 15 000: float32 alone would miss by metres."""
    frames = 196
    given = np.random.default_rng(0).normal(size=(frames - 2, 3))
    wish = pf.acceleration("head", range(1, frames - 1), given)
    wish = wish & pf.pin("head", [0, frames - 1], [[0, 1.6, 0], [0, 1.6, 3]])
    projector = pf.Projector(wish.rows(frames))
    assert 1e4 < projector.condition < 2e4
    z = projector.project(torch.zeros(frames, 22, 3))
    assert wish.residual(z.numpy()) < 1e-6
