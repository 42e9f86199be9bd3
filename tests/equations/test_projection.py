import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from projflow_lite import equations as eq

from .bodies import STICK, random_precision, random_problem


def constrained_minimum(x1_hat, A, y, R):
    """Smallest correction in the metric under A x = y, by a generic QP solver (SLSQP)."""
    found = minimize(
        lambda u: 0.5 * u @ R @ u,
        np.zeros(len(x1_hat)),
        jac=lambda u: R @ u,
        constraints={"type": "eq", "fun": lambda u: A @ (x1_hat + u) - y, "jac": lambda u: A},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 200},
    )
    assert found.success
    return found.x


def test_hard_projection_against_a_generic_solver():
    for seed in range(10):
        x1_hat, A, y, R, _ = random_problem(seed)
        ours = eq.project(x1_hat, A, y, R, np.zeros((3, 3)))
        np.testing.assert_allclose(
            ours, x1_hat + constrained_minimum(x1_hat, A, y, R), rtol=0, atol=1e-7
        )
        np.testing.assert_allclose(A @ ours, y, rtol=0, atol=1e-13)


def test_projection_on_a_line_by_hand():
    # Nearest point to the origin on x + y = 2 is (1, 1); if moving x costs three times as much
    # as moving y, Lagrange's conditions 3 x = y and x + y = 2 give (1/2, 3/2).
    args = ([0, 0], [[1, 1]], [2])
    np.testing.assert_allclose(eq.project(*args, np.eye(2), [[0]]), [1, 1], rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        eq.project(*args, np.diag([3, 1]), [[0]]), [0.5, 1.5], rtol=0, atol=1e-15
    )


def test_projection_between_prior_and_measurement_by_hand():
    # One coordinate, prior precision 4 at 0, measurement 10 with variance 1 (precision 1):
    # the precision-weighted mean is (4 * 0 + 1 * 10) / 5.
    np.testing.assert_allclose(eq.project([0], [[1]], [10], [[4]], [[1]]), [2], rtol=0, atol=1e-15)


def test_project_adds_the_correction_to_the_prediction():
    x1_hat, A, y, R, Sigma = random_problem(0)
    moved = eq.project(x1_hat, A, y, R, Sigma)
    shifted = eq.project(np.zeros(7), A, y - A @ x1_hat, R, Sigma)
    np.testing.assert_allclose(moved - x1_hat, shifted, rtol=0, atol=1e-13)
    np.testing.assert_allclose(
        eq.projection_correction(x1_hat, A, y, R, Sigma), shifted, rtol=0, atol=1e-13
    )


def test_ddnm_is_recovered_symbolically():
    """Eq. 23, 24 and 25 with symbols: a full-row-rank A with three coordinates and one row."""
    a = sp.Matrix([sp.symbols("a1:4", positive=True)])
    x, y = sp.Matrix(sp.symbols("x1:4")), sp.Matrix([sp.Symbol("y")])
    A_pinv = a.T * (a * a.T).inv()
    assert sp.simplify(a * A_pinv * a - a) == sp.zeros(1, 3)  # Moore and Penrose agree
    eq_23 = x + a.T * (a * a.T).inv() * (y - a * x)
    eq_24 = x + A_pinv * y - A_pinv * a * x
    eq_25 = A_pinv * y + (sp.eye(3) - A_pinv * a) * x
    assert sp.simplify(eq_23 - eq_24) == sp.zeros(3, 1)
    assert sp.simplify(eq_24 - eq_25) == sp.zeros(3, 1)
    point = dict(zip([*a, *x, *y], [1.0, 2.0, 0.5, 0.1, -0.7, 2.0, 3.0], strict=True))
    expected = np.array(eq_25.subs(point), dtype=float).ravel()
    args = ([0.1, -0.7, 2.0], [[1.0, 2.0, 0.5]], [3.0])
    for function in (eq.ddnm, eq.euclidean_projection, eq.euclidean_projection_expanded):
        np.testing.assert_allclose(function(*args), expected, rtol=0, atol=1e-14)
    general = eq.project(*args, np.eye(3), [[0.0]])
    np.testing.assert_allclose(general, expected, rtol=0, atol=1e-14)


def test_ddnm_is_the_nearest_point_by_least_squares():
    for seed in range(5):
        x1_hat, A, y, _, _ = random_problem(seed)
        delta, *_ = np.linalg.lstsq(A, y - A @ x1_hat, rcond=None)  # of least length
        np.testing.assert_allclose(eq.ddnm(x1_hat, A, y), x1_hat + delta, rtol=0, atol=1e-12)
        hard = eq.project(x1_hat, A, y, np.eye(7), np.zeros((3, 3)))
        np.testing.assert_allclose(eq.ddnm(x1_hat, A, y), hard, rtol=0, atol=1e-12)


def test_a_square_mask_has_no_full_row_rank():
    """Erratum of eq. 23: the case the paper uses most breaks the assumption; 21 does not need it."""
    M, y = np.diag([1.0, 0.0, 1.0]), np.array([5.0, 0.0, 7.0])
    with pytest.raises(ValueError, match="dependent"):
        eq.euclidean_projection([1, 2, 3], M, y)
    for function in (eq.ddnm, eq.euclidean_projection_expanded):
        np.testing.assert_allclose(function([1, 2, 3], M, y), [5, 2, 7], rtol=0, atol=1e-14)
    ours = eq.project([1, 2, 3], M, y, np.eye(3), np.zeros((3, 3)))
    np.testing.assert_allclose(ours, [5, 2, 7], rtol=0, atol=1e-14)


def test_no_row_changes_nothing():
    x1_hat, _, _, R, _ = random_problem(0)
    ours = eq.project(x1_hat, np.zeros((0, 7)), [], R, np.zeros((0, 0)))
    np.testing.assert_array_equal(ours, x1_hat)
    np.testing.assert_array_equal(eq.ddnm(x1_hat, np.zeros((0, 7)), []), x1_hat)


def test_all_rows_leave_nothing_to_the_prediction():
    x1_hat, _, _, R, _ = random_problem(1)
    y = np.arange(7.0)
    ours = eq.project(x1_hat, np.eye(7), y, R, np.zeros((7, 7)))
    np.testing.assert_allclose(ours, y, rtol=0, atol=1e-13)


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=40)
def test_redundant_rows_that_agree_change_nothing(seed, repeats, factor):
    x1_hat, A, y, R, _ = random_problem(seed)
    mix = factor * np.random.default_rng(seed).integers(-2, 3, size=(repeats, 3))
    hard = eq.project(x1_hat, A, y, R, np.zeros((3, 3)))
    A_more, y_more = np.vstack([A, mix @ A]), np.concatenate([y, mix @ y])
    more = eq.project(x1_hat, A_more, y_more, R, np.zeros((len(A_more),) * 2))
    np.testing.assert_allclose(more, hard, rtol=0, atol=1e-7 if factor == 1e-6 else 1e-9)


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-9, 1e-6, 1e-3, 1.0]))
@settings(max_examples=40)
def test_rows_that_contradict_each_other_are_named(seed, gap):
    x1_hat, A, y, R, _ = random_problem(seed)
    A, y = np.vstack([A, A[1]]), np.append(y, y[1] + gap)
    with pytest.raises(ValueError, match="rows 1, 3 contradict each other"):
        eq.project(x1_hat, A, y, R, np.zeros((4, 4)))
    # Two noisy opinions are no contradiction: they are averaged.
    soft = eq.project(x1_hat, A, y, R, np.diag([0, 1e-3, 0, 1e-3]))
    np.testing.assert_allclose((A @ soft)[[0, 2]], y[[0, 2]], rtol=0, atol=1e-10)


def test_redundant_rows_that_ask_for_zero_are_no_contradiction():
    """The rounding to allow for is that of A x, which y = 0 says nothing about."""
    for seed in range(20):
        x1_hat, A, _, R, _ = random_problem(seed)
        A = np.vstack([A, A[0] - A[1], A[2] / 3])
        ours = eq.project(1e3 * x1_hat, A, np.zeros(5), R, np.zeros((5, 5)))
        np.testing.assert_allclose(A @ ours, 0, rtol=0, atol=1e-10)


def test_contradictions_are_found_in_any_unit():
    x1_hat, A, y, R, _ = random_problem(3)
    A, y = np.vstack([A, A[1]]), np.append(y, y[1] + 1e-6)
    for unit in (np.ones(4), np.array([1, 1e-9, 1, 1e-9]), np.full(4, 1e6)):
        agreeing = eq.project(x1_hat, unit[:3, None] * A[:3], unit[:3] * y[:3], R, np.zeros((3, 3)))
        np.testing.assert_allclose(A[:3] @ agreeing, y[:3], rtol=0, atol=1e-10)
        with pytest.raises(ValueError, match="rows 1, 3 contradict each other"):
            eq.project(x1_hat, unit[:, None] * A, unit * y, R, np.zeros((4, 4)))
    with pytest.raises(ValueError, match="rows 1, 3 contradict each other"):
        eq.project(1e-9 * x1_hat, A, 1e-9 * y, R, np.zeros((4, 4)))


def test_a_row_that_measures_nothing_must_ask_for_nothing():
    x1_hat, A, y, R, _ = random_problem(2)
    A[1] = 0
    with pytest.raises(ValueError, match="row 1 measures nothing"):
        eq.project(x1_hat, A, y, R, np.zeros((3, 3)))
    y[1] = 0
    ours = eq.project(x1_hat, A, y, R, np.zeros((3, 3)))
    np.testing.assert_allclose(A @ ours, y, rtol=0, atol=1e-13)


def test_loop_and_keyframes_together_are_redundant_but_fine():
    edges, joints = STICK
    R = eq.kinematic_metric(4, eq.kinematic_laplacian(edges, joints), 10.0, 1.0)
    unit, frame = np.eye(4 * joints * 3), joints * 3
    A = np.vstack([unit[:frame] - unit[-frame:], unit[:frame], unit[-frame:]])
    rng = np.random.default_rng(3)
    pose = rng.normal(size=frame)
    y = np.concatenate([np.zeros(frame), pose, pose])
    assert np.linalg.matrix_rank(A) < len(A)
    ours = eq.project(rng.normal(size=48), A, y, R, np.zeros((len(A),) * 2))
    np.testing.assert_allclose(A @ ours, y, rtol=0, atol=1e-12)


@given(
    st.integers(0, 2**32 - 1), st.lists(st.sampled_from([0.0, 0.01, 1.0]), min_size=3, max_size=3)
)
@settings(max_examples=40)
def test_mixed_hard_and_soft_rows_satisfy_lagranges_conditions(seed, variances):
    """R Δ = Aᵀ z and y - A x = Σ z for one z: what makes a point the minimum, hard or soft."""
    x1_hat, A, y, R, _ = random_problem(seed)
    Sigma = np.diag(variances)
    x1 = eq.project(x1_hat, A, y, R, Sigma)
    z, *_ = np.linalg.lstsq(A.T, R @ (x1 - x1_hat), rcond=None)
    assume(np.linalg.cond(A) < 1e4)
    np.testing.assert_allclose(A.T @ z, R @ (x1 - x1_hat), rtol=0, atol=1e-8)
    np.testing.assert_allclose(y - A @ x1, Sigma @ z, rtol=0, atol=1e-8)


def test_projecting_twice_is_projecting_once():
    x1_hat, A, y, R, _ = random_problem(4)
    once = eq.project(x1_hat, A, y, R, np.zeros((3, 3)))
    np.testing.assert_allclose(
        eq.project(once, A, y, R, np.zeros((3, 3))), once, rtol=0, atol=1e-13
    )


def test_correction_is_perpendicular_to_every_free_direction():
    x1_hat, A, y, R, _ = random_problem(5)
    delta = eq.projection_correction(x1_hat, A, y, R, np.zeros((3, 3)))
    free = np.linalg.svd(A)[2][3:]  # A v = 0 for these
    np.testing.assert_allclose(free @ R @ delta, 0, rtol=0, atol=1e-13)


def test_released_diagonal_leaves_a_residual():
    """Erratum of the "0.0000" errors: 1e-8 on the diagonal is a soft constraint."""
    x1_hat, A, y, R, _ = random_problem(6)
    hard = np.zeros((3, 3))
    exact = np.abs(A @ eq.project(x1_hat, A, y, R, hard) - y).max()
    released = np.abs(A @ eq.project(x1_hat, A, y, R, hard, form="released") - y).max()
    assert exact < 1e-13
    assert 1e-10 < released < 1e-6
    # It is what a variance of 1e-8 m^2, a tenth of a millimetre, would do.
    soft = eq.project(x1_hat, A, y, R, 1e-8 * np.eye(3))
    np.testing.assert_allclose(
        soft, eq.project(x1_hat, A, y, R, hard, "released"), rtol=0, atol=1e-13
    )
    # And it splits a contradiction in the middle without a word.
    between = eq.project([0.0], [[1.0], [1.0]], [0.0, 1.0], [[1.0]], np.zeros((2, 2)), "released")
    np.testing.assert_allclose(between, [0.5], rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x1_hat": np.zeros((1, 2, 3))}, r"x1_hat has shape \(1, 2, 3\); vectorise it first"),
        ({"y": np.zeros((3, 1))}, r"y has shape \(3, 1\), expected \(3,\)"),
        ({"A": np.zeros((3, 6))}, r"A has shape \(3, 6\), expected \(any, 7\)"),
        ({"x1_hat": np.full(7, np.nan)}, "x1_hat has a value that is not finite"),
        ({"R": -np.eye(7)}, "R is not positive definite"),
        ({"R": np.triu(np.ones((7, 7)))}, "R is not symmetric"),
        ({"Sigma": np.diag([1.0, -1.0, 0.0])}, "Sigma has a negative variance"),
        ({"Sigma": np.ones((3, 3)) - 2 * np.eye(3)}, "Sigma has a negative variance"),
        ({"Sigma": np.triu(np.ones((3, 3)))}, "Sigma is not symmetric"),
        ({"Sigma": np.zeros(3)}, "Sigma has shape"),
        ({"form": "printed"}, "expected one of derived, released"),
    ],
)
def test_wrong_arguments_are_named(change, message):
    names = ("x1_hat", "A", "y", "R", "Sigma")
    arguments = dict(zip(names, random_problem(0), strict=True)) | change
    with pytest.raises(ValueError, match=f"project: .*{message}"):
        eq.project(**arguments)


def test_a_structured_metric_and_a_dense_one_take_the_same_path():
    rng = np.random.default_rng(7)
    R = random_precision(rng, 5)
    T = rng.normal(size=(5, 5))  # new coordinates x = T u turn R into Tᵀ R T
    A, y, x1_hat = rng.normal(size=(2, 5)), rng.normal(size=2), rng.normal(size=5)
    there = eq.project(np.linalg.solve(T, x1_hat), A @ T, y, T.T @ R @ T, np.zeros((2, 2)))
    here = eq.project(x1_hat, A, y, R, np.zeros((2, 2)))
    np.testing.assert_allclose(T @ there, here, rtol=0, atol=1e-10)
