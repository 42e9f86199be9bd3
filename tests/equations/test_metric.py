import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from projflow_lite import equations as eq
from projflow_lite.skeleton import JOINTS

from .bodies import FULL_BODY, STICK

PELVIS, SHOULDER, ELBOW, WRIST, SPINE3, TOE = (
    JOINTS.index(name)
    for name in ("pelvis", "left_shoulder", "left_elbow", "left_wrist", "spine3", "left_foot")
)


def body_metric(w_kin=10.0, ridge=1.0):
    return eq.joint_metric(eq.kinematic_laplacian(*FULL_BODY), w_kin, ridge)


def explicit_norm_squared(u, edges, w_kin, ridge):
    """Sum over frames, bones and axes, written out: the metric without any matrix."""
    frames, joints, _ = u.shape
    total = 0.0
    for n in range(frames):
        for c in range(3):
            for a, b in edges:
                total += w_kin * (u[n, a, c] - u[n, b, c]) ** 2
            for j in range(joints):
                total += ridge * u[n, j, c] ** 2
    return total


def test_laplacian_bone_by_bone():
    edges, joints = FULL_BODY
    by_hand = [[0.0] * joints for _ in range(joints)]
    for a, b in edges:  # each bone adds (u_a - u_b)^2
        by_hand[a][a] += 1
        by_hand[b][b] += 1
        by_hand[a][b] -= 1
        by_hand[b][a] -= 1
    np.testing.assert_array_equal(eq.kinematic_laplacian(edges, joints), by_hand)


def test_laplacian_of_three_joints_by_hand():
    expected = [[1, -1, 0], [-1, 2, -1], [0, -1, 1]]
    np.testing.assert_array_equal(eq.kinematic_laplacian([(0, 1), (2, 1), (1, 2)], 3), expected)
    np.testing.assert_array_equal(eq.kinematic_laplacian([], 1), [[0]])
    np.testing.assert_array_equal(eq.kinematic_laplacian([(1, 0)], 2), [[1, -1], [-1, 1]])


def test_adjacency_marks_bones_in_both_directions():
    edges, joints = FULL_BODY
    bones = {frozenset(e) for e in edges}
    A_kin = eq.kinematic_adjacency(edges, joints)
    for a in range(joints):
        for b in range(joints):
            assert A_kin[a, b] == (frozenset((a, b)) in bones and a != b)


def test_laplacian_ignores_a_translation_and_nothing_else():
    eigenvalues = np.linalg.eigvalsh(eq.kinematic_laplacian(*FULL_BODY))
    assert abs(eigenvalues[0]) < 1e-12 < eigenvalues[1]  # a connected graph has one zero


@pytest.mark.parametrize("edge", [(0, 3), (3, 0), (-1, 0), (0, -1), (1, 1)])
def test_what_is_no_bone_is_refused(edge):
    with pytest.raises(ValueError, match="is no bone among 3 joints"):
        eq.kinematic_laplacian([edge], 3)


@given(st.integers(1, 4), st.integers(0, 2**32 - 1), st.floats(0, 50), st.floats(0.01, 5))
def test_metric_is_the_sum_over_frames_bones_and_axes(frames, seed, w_kin, ridge):
    edges, joints = STICK
    u = np.random.default_rng(seed).normal(size=(frames, joints, 3))
    R = eq.kinematic_metric(frames, eq.kinematic_laplacian(edges, joints), w_kin, ridge)
    expected = explicit_norm_squared(u, edges, w_kin, ridge)
    assert eq.squared_norm(eq.vectorise(u), R) == pytest.approx(expected, rel=1e-12)


def test_printed_kronecker_order_couples_strangers():
    """Erratum of eq. 11 and 49: move every joint of the body by one step along x.

    No bone changes, so only the ridge may charge: N J = 2 * 4 unit coordinates. The printed
    order, applied to the frame-major vector that the paper declares, also sees broken bones.
    """
    edges, joints = STICK
    L, step = eq.kinematic_laplacian(edges, joints), np.zeros((2, joints, 3))
    step[..., 0] = 1
    derived = eq.kinematic_metric(2, L, 10.0, 1.0)
    printed = eq.kinematic_metric(2, L, 10.0, 1.0, form="printed")
    assert eq.squared_norm(eq.vectorise(step), derived) == pytest.approx(8)
    assert eq.squared_norm(eq.vectorise(step), printed) > 100
    # Sorted axis by axis (c, n, j), the same motion gets the right price from the printed form.
    channel_major = step.transpose(2, 0, 1).ravel()
    assert eq.squared_norm(channel_major, printed) == pytest.approx(8)


def test_both_orders_agree_up_to_the_sorting():
    edges, joints = STICK
    L, rng = eq.kinematic_laplacian(edges, joints), np.random.default_rng(0)
    printed = eq.kinematic_metric(3, L, 7.0, 0.5, form="printed")
    for _ in range(5):
        u = rng.normal(size=(3, joints, 3))
        expected = explicit_norm_squared(u, edges, 7.0, 0.5)
        assert eq.squared_norm(u.transpose(2, 0, 1).ravel(), printed) == pytest.approx(expected)


def test_one_frame_one_joint():
    np.testing.assert_array_equal(eq.kinematic_metric(1, [[0.0]], 10.0, 2.0), 2 * np.eye(3))


def test_metric_needs_a_ridge():
    L = eq.kinematic_laplacian(*STICK)
    for w_kin, ridge in ((10, 0), (10, -1), (-10, 1)):
        with pytest.raises(ValueError, match="ridge must be positive"):
            eq.kinematic_metric(2, L, w_kin, ridge)
    with pytest.raises(ValueError, match="square"):
        eq.joint_metric(np.zeros((2, 3)), 1, 1)
    with pytest.raises(ValueError, match="frames is 0"):
        eq.kinematic_metric(0, L, 1, 1)


def test_joint_metric_of_one_bone_symbolically():
    w, ridge = sp.symbols("w lambda", positive=True)
    u = sp.Matrix(sp.symbols("u0 u1"))
    price = w * (u[0] - u[1]) ** 2 + ridge * (u[0] ** 2 + u[1] ** 2)
    expected = sp.lambdify((w, ridge), sp.hessian(price, list(u)) / 2)
    L = eq.kinematic_laplacian([(0, 1)], 2)
    np.testing.assert_allclose(eq.joint_metric(L, 3.0, 0.7), expected(3.0, 0.7), rtol=0, atol=1e-15)


def test_known_numbers_of_the_human_skeleton():
    R_J = body_metric()
    assert np.linalg.cond(R_J) == pytest.approx(54.3, abs=0.05)
    r = eq.marginal_variance(R_J)
    assert JOINTS[r.argmin()] == "spine3"
    assert JOINTS[r.argmax()] in ("left_foot", "right_foot")
    np.testing.assert_allclose([r.min(), r.max()], [0.098, 0.259], rtol=0, atol=5e-4)


def test_marginal_variance_is_the_diagonal_of_the_whole_inverse():
    edges, joints = STICK
    L = eq.kinematic_laplacian(edges, joints)
    whole = np.diag(np.linalg.inv(eq.kinematic_metric(3, L, 10.0, 1.0)))
    r = eq.marginal_variance(eq.joint_metric(L, 10.0, 1.0))
    expected = np.broadcast_to(r[:, None], (3, joints, 3))
    np.testing.assert_allclose(whole.reshape(3, joints, 3), expected, rtol=1e-12)


def test_marginal_variance_is_the_spread_of_the_prior():
    # Draw from N(0, R_J^-1) through a Cholesky factor of R_J and look at the variance.
    R_J, n = body_metric(), 100_000
    z = np.random.default_rng(1).normal(size=(len(R_J), n))
    u = np.linalg.solve(np.linalg.cholesky(R_J).T, z)
    np.testing.assert_allclose(
        u.var(axis=1) / eq.marginal_variance(R_J), 1, rtol=0, atol=5 * (2 / n) ** 0.5
    )


def test_influence_weights_by_explicit_loops():
    R_J = body_metric()
    for j, q_j in enumerate(eq.influence_weights(R_J)):
        unit = [float(k == j) for k in range(22)]
        c_j = np.linalg.solve(R_J, unit)
        norm = sum(float(c) ** 2 for c in c_j) ** 0.5
        assert q_j == pytest.approx(1 / norm, rel=1e-12)


def test_pelvis_gets_more_weight_than_the_wrist():
    """Erratum of eq. 51: the words promise less trust to the pelvis, the formula gives more."""
    R_J = body_metric()
    q, squared = eq.influence_weights(R_J), eq.influence_weights(R_J, form="released")
    norms = 1 / q[[PELVIS, SPINE3, WRIST, TOE]]
    np.testing.assert_allclose(norms, [0.253, 0.244, 0.361, 0.368], rtol=0, atol=5e-4)
    assert q[PELVIS] > q[WRIST]
    np.testing.assert_allclose(squared, q**2, rtol=1e-13)
    # Why: every column of the inverse has the same sum, 1 / ridge, with no negative entry.
    inverse = np.linalg.inv(R_J)
    np.testing.assert_allclose(inverse.sum(axis=0), 1, rtol=0, atol=1e-13)
    assert (inverse > 0).all()


def test_pulling_a_wrist_pulls_the_arm():
    """Known answer: the metric says how far the rest of the body follows one joint."""
    R = eq.kinematic_metric(1, eq.kinematic_laplacian(*FULL_BODY), 10.0, 1.0)
    A = np.zeros((1, 66))
    A[0, 3 * WRIST] = 1
    moved = eq.unvectorise(eq.project(np.zeros(66), A, [1.0], R, np.zeros((1, 1))), 1, 22)[0]
    np.testing.assert_allclose(
        moved[[WRIST, ELBOW, SHOULDER, PELVIS], 0], [1, 0.71, 0.49, 0.05], rtol=0, atol=5e-3
    )
    np.testing.assert_allclose(moved[:, 1:], 0, rtol=0, atol=1e-15)


def test_forms_are_named_when_wrong():
    with pytest.raises(ValueError, match="expected one of printed, released"):
        eq.influence_weights(body_metric(), form="derived")
    with pytest.raises(ValueError, match="expected one of derived, printed"):
        eq.kinematic_metric(1, [[0.0]], 1, 1, form="released")
