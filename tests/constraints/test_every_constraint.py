"""What must be true of every constraint: its adjoint, its words, its rows against plain loops."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.linalg import LinearOperator, lsqr

import projflow_lite as pf
from projflow_lite.skeleton import JOINTS, LOWER_BODY, MASS, UPPER_BODY

FRAMES = 9
RANDOM = np.random.default_rng(0)
X = RANDOM.normal(size=(FRAMES, 22, 3))
CAMERA = pf.Orthographic(pitch=20, yaw=-30, roll=5, scale=1.1)
PINHOLE = pf.Perspective(position=(0.5, 1.2, 9.0), pitch=5, yaw=10, focal=2.0, centre=(0.1, -0.2))
J = {name: k for k, name in enumerate(JOINTS)}


def loops_of_wishes():
    """Wishes made of X itself, with what a plain loop over the motion measures for them."""
    wrist, frames = J["left_wrist"], [1, 4, 8]
    return {
        "pin": (pf.pin("left_wrist", frames, X[frames, wrist]), lambda x: [x[n, wrist, c] for n in frames for c in range(3)]),
        "pin xz": (pf.pin("left_wrist", frames, X[frames, wrist][:, [0, 2]], axes="xz"), lambda x: [x[n, wrist, c] for n in frames for c in (0, 2)]),
        "offset": (pf.offset("left_wrist", "head", X[:, wrist] - X[:, 15]), lambda x: [x[n, wrist, c] - x[n, 15, c] for n in range(FRAMES) for c in range(3)]),
        "loop": (pf.loop(shift=[1, 2, 3]), lambda x: [x[-1, j, c] - x[0, j, c] for j in range(22) for c in range(3)]),
        "keep": (pf.keep(X, ["head", "neck"]), lambda x: [x[n, j, c] for n in range(FRAMES) for j in (15, 12) for c in range(3)]),
        "lift": (pf.lift(CAMERA, "left_wrist", frames, CAMERA.project(X[frames, wrist])), lambda x: [CAMERA.project(x[n, wrist])[k] / 1.1 for n in frames for k in range(2)]),
        "velocity": (pf.velocity("left_wrist", [0, 7], np.zeros((2, 3))), lambda x: [x[n + 1, wrist, c] - x[n, wrist, c] for n in (0, 7) for c in range(3)]),
        "acceleration": (pf.acceleration("left_wrist", [1, 7], np.zeros((2, 3))), lambda x: [x[n + 1, wrist, c] - 2 * x[n, wrist, c] + x[n - 1, wrist, c] for n in (1, 7) for c in range(3)]),
        "centre_of_mass": (pf.centre_of_mass([2, 3], np.zeros((2, 2)), axes="zx"), lambda x: [sum(MASS[j] * x[n, j, c] for j in range(22)) for n in (2, 3) for c in (2, 0)]),
        "rows": (pf.rows(np.eye(3, FRAMES * 66), np.ones(3)), lambda x: list(x.ravel()[:3])),
    }  # fmt: skip


WISHES = loops_of_wishes()
ALL = {name: wish for name, (wish, _) in WISHES.items()} | {
    "perspective": pf.lift(PINHOLE, "head", [0, 5], [[0.1, 0.2], [0.3, 0.1]]),
    "moving loop": pf.loop(moving=True),
    "smooth loop": pf.loop(smooth=True),
    "stack": pf.loop() & pf.pin("head", 0, [1, 2, 3]),
}


@pytest.mark.parametrize("name", WISHES)
def test_rows_measure_what_a_plain_loop_measures(name):
    wish, measure = WISHES[name]
    x = np.random.default_rng(1).normal(size=X.shape)
    np.testing.assert_allclose(wish.rows(FRAMES).A @ x.ravel(), measure(x), atol=1e-12)


@pytest.mark.parametrize("name", ["pin", "pin xz", "offset", "keep", "lift"])
def test_a_wish_made_of_a_motion_holds_for_that_motion(name):
    assert WISHES[name][0].residual(X) < 1e-12
    assert WISHES[name][0].residual(X + 0.1 * RANDOM.normal(size=X.shape)) > 0.01


@given(name=st.sampled_from(sorted(ALL)), seed=st.integers(0, 999))
def test_dot_test(name, seed):
    operator = ALL[name].operator(FRAMES)
    assert isinstance(operator, LinearOperator)
    random = np.random.default_rng(seed)
    u, v = random.normal(size=operator.shape[1]), random.normal(size=operator.shape[0])
    assert (operator @ u) @ v == pytest.approx(u @ (operator.T @ v), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("name", ALL)
def test_every_wish_knows_its_shape_and_says_itself_in_a_sentence(name):
    A, y, variance = ALL[name].rows(FRAMES)
    assert A.shape == (len(y), FRAMES * 66)
    assert variance.shape == y.shape
    assert not variance.any()
    text = repr(ALL[name])
    assert text.startswith("Wish: ")
    assert "0x" not in text
    assert 20 < len(text) < 300


def test_scipys_own_solver_takes_the_operator():
    wish = ALL["stack"]
    x = lsqr(wish.operator(FRAMES), wish.rows(FRAMES).y, atol=1e-13, btol=1e-13)[0]
    assert wish.residual(x.reshape(FRAMES, 22, 3)) < 1e-9


def test_std_becomes_the_variance_in_metres():
    assert pf.offset("head", "neck", [0, 0, 0], frames=[1], std=0.2).rows(4).variance == (
        pytest.approx(0.04)
    )
    fast = pf.velocity("head", 1, [1, 0, 0], std=0.4).rows(4)
    np.testing.assert_allclose(fast.y, [0.05, 0, 0])
    np.testing.assert_allclose(fast.variance, 0.02**2)
    hard = pf.acceleration("head", 1, [0, -9.81, 0], std=4).rows(4)
    np.testing.assert_allclose(hard.y, [0, -9.81 / 400, 0])
    np.testing.assert_allclose(hard.variance, 0.01**2)
    assert pf.keep(X, "head", std=0.1).rows(FRAMES).variance == pytest.approx(0.01)
    assert pf.rows(np.ones((1, 66)), [1.0], 0.3).rows(1).variance == pytest.approx(0.3)


def test_a_falling_body_meets_the_acceleration_of_gravity():
    t = np.arange(12) / 20
    x = np.zeros((12, 22, 3))
    x[:, :, 1] = (1 + 2 * t - 4.905 * t**2)[:, None]
    wish = pf.acceleration("pelvis", range(1, 11), np.tile([0, -9.81, 0], (10, 1)))
    assert wish.residual(x) < 1e-12
    fall = np.stack([0 * t, 1 + 2 * t - 4.905 * t**2], axis=1)
    assert pf.centre_of_mass(None, fall, axes="xy").residual(x) < 1e-12


def test_a_moving_loop_is_met_by_a_body_that_only_moved_over_the_ground():
    x = X.copy()
    x[-1] = x[0] + [0.7, 0.0, -2.0]
    assert pf.loop(moving=True).residual(x) < 1e-12
    assert pf.loop().residual(x) == pytest.approx(2.0)
    x[-1, :, 1] += 0.3
    assert pf.loop(moving=True).residual(x) == pytest.approx(0.3)


def test_a_smooth_loop_is_met_where_the_seam_is_straight():
    angle, size = 2 * np.pi * np.arange(13) / 12, RANDOM.normal(size=(22, 3))
    assert pf.loop(smooth=True).residual(np.sin(angle)[:, None, None] * size) < 1e-12
    bent = np.cos(angle)[:, None, None] * size
    assert pf.loop().residual(bent) < 1e-12
    bend = 2 * (1 - np.cos(np.pi / 6)) * np.abs(size).max()
    assert pf.loop(smooth=True).residual(bent) == pytest.approx(bend)


def test_upper_and_lower_body_share_the_joints():
    assert len(UPPER_BODY) == 13
    assert sorted(UPPER_BODY + LOWER_BODY) == sorted(JOINTS)
    assert sum(MASS) == pytest.approx(1)
    assert min(MASS) >= 0
    assert MASS[J["left_knee"]] == MASS[J["right_knee"]]
