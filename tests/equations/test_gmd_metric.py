"""Where emphasis is a metric of ProjFlow's eq. 7, and where it is not."""

import numpy as np
import pytest
from scipy.optimize import minimize

from projflow_lite import equations as eq

FEATURES, EMPHASISED = 5, [0, 1]


def step(seed, c, A_prime=None):
    """Return one step x, A, k and R."""
    rng = np.random.default_rng(seed)
    A_prime = rng.normal(size=(FEATURES, FEATURES)) if A_prime is None else A_prime
    A = eq.emphasis_matrix(A_prime, EMPHASISED, c)
    k = eq.emphasis_scale(FEATURES, EMPHASISED, c)
    return rng.normal(size=FEATURES), A, k, eq.emphasis_metric(A, k)


def undone(x_proj, A, k):
    return np.linalg.lstsq(k * A, x_proj, rcond=None)[0]


def test_metric_is_the_squared_length_in_projected_space():
    x, A, k, R = step(0, 3.0)
    length = sum((k * sum(A[i, j] * x[j] for j in range(FEATURES))) ** 2 for i in range(FEATURES))
    assert x @ R @ x == pytest.approx(length)


@pytest.mark.parametrize("c", [1.0, 10.0, 300.0])
@pytest.mark.parametrize("rows", ["one emphasised", "one ordinary", "mixed", "sums"])
def test_nearest_in_projected_space_is_eq_7_with_this_metric(c, rows):
    """Exact for every c and for rows of any kind, not only for masks; k drops out."""
    x, A, k, R = step(1, c)
    e = np.eye(FEATURES)
    S = {
        "one emphasised": e[[0]],
        "one ordinary": e[[3]],
        "mixed": e[[1, 2, 4]],
        "sums": np.array([[1.0, -1, 0, 2, 0], [0, 0, 1, 1, 1]]),
    }[rows]
    y = np.arange(1.0, len(S) + 1)
    hard = np.zeros((len(S),) * 2)
    ours = undone(eq.nearest_emphasised(k * A @ x, S, y, A, k), A, k)
    assert np.allclose(ours, eq.project(x, S, y, R, hard), atol=1e-7 * c)
    assert np.allclose(ours, eq.project(x, S, y, 7 * R, hard), atol=1e-7 * c)


def test_nearest_in_projected_space_against_a_generic_solver():
    x, A, k, _ = step(2, 2.0)
    S, y = np.array([[1.0, 0, 0, 0, 0], [0, 0, 1, 1, 0]]), np.array([0.5, -1.0])
    found = minimize(
        lambda u: ((k * A @ (u - x)) ** 2).sum(),
        x,
        constraints={"type": "eq", "fun": lambda u: S @ u - y},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 500},
    )
    assert found.success
    ours = undone(eq.nearest_emphasised(k * A @ x, S, y, A, k), A, k)
    assert np.allclose(ours, found.x, atol=1e-5)


@pytest.mark.parametrize("c", [1.0, 10.0])
def test_overwriting_is_this_projection_where_columns_are_orthogonal(c):
    Q, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(FEATURES, FEATURES)))
    x, _, _, R = step(3, c, A_prime=Q)
    assert np.allclose(R, np.diag(np.diag(R)))
    S, y = np.eye(FEATURES)[[0, 3]], np.array([1.0, 2.0])
    overwritten = np.array([1.0, x[1], x[2], 2.0, x[4]])
    assert np.allclose(eq.project(x, S, y, R, np.zeros((2, 2))), overwritten)


def test_elsewhere_it_is_not_as_two_features_show_by_hand():
    """A' = [[1, 1], [0, 1]], c = 2 on feature 0: R is k^2 [[4, 2], [2, 2]].

    Asking feature 0 for 1 more moves feature 1 by -2/2 = -1. Overwriting leaves it alone.
    """
    A = eq.emphasis_matrix([[1.0, 1.0], [0.0, 1.0]], [0], 2.0)
    R = eq.emphasis_metric(A, 1.0)
    assert np.allclose(R, [[4, 2], [2, 2]])
    x, S, hard = np.zeros(2), np.array([[1.0, 0.0]]), np.zeros((1, 1))
    assert np.allclose(eq.project(x, S, [1.0], R, hard), [1, -1])
    assert np.allclose(eq.ddnm(x, S, [1.0]), [1, 0])
    overwritten = eq.impute_emphasised(np.zeros((2, 1)), [[1.0]], [[1], [0]], [0], A, 1.0)
    assert np.allclose(eq.unemphasise(overwritten, A, 1.0).ravel(), [1, 0])


def free_move(c, imputed):
    """How the free features move when imputed ones are asked for 1 more."""
    x, _, _, R = step(4, c)
    S = np.eye(FEATURES)[imputed]
    moved = eq.project(x, S, S @ x + 1, R, np.zeros((len(imputed),) * 2)) - x
    return np.delete(moved, imputed)


def test_what_grows_and_what_shrinks_with_emphasis():
    """Imputed features emphasised: free ones move c times as much, without limit. Imputed ones
    ordinary: an emphasised free feature moves by 1 / c, an ordinary one as without emphasis."""
    plain = free_move(1.0, EMPHASISED)
    assert np.abs(plain).max() > 0.1
    for c in (10.0, 1000.0):
        assert np.allclose(free_move(c, EMPHASISED), c * plain, rtol=1e-5)
        assert np.allclose(free_move(c, [3]), free_move(1.0, [3]) * [1 / c, 1 / c, 1, 1], rtol=1e-5)
        both = free_move(c, [0])  # feature 1 is emphasised too, and free
        assert np.allclose(both, free_move(1.0, [0]) * [1, c, c, c], rtol=1e-5)


def test_a_very_tall_matrix_comes_near_overwriting_a_square_one_does_not():
    """Coupling of free and imputed features falls like 1 / sqrt(rows)."""
    rng = np.random.default_rng(5)
    n, moves = 40, {}
    for rows in (n, 40 * n, 640 * n):
        A = eq.emphasis_matrix(rng.normal(size=(rows, n)), [0], 1.0)
        R = eq.emphasis_metric(A, 1 / np.sqrt(rows))
        moved = eq.project(np.zeros(n), np.eye(n)[[0]], [1.0], R, np.zeros((1, 1)))
        moves[rows] = np.linalg.norm(moved[1:])
    assert moves[n] > 0.5
    assert moves[40 * n] == pytest.approx(1 / np.sqrt(40), rel=0.4)
    assert moves[640 * n] == pytest.approx(1 / np.sqrt(640), rel=0.4)


def test_white_noise_in_projected_space_has_covariance_of_the_inverse_metric():
    _, A, k, R = step(6, 3.0)
    noise = np.random.default_rng(7).normal(size=(FEATURES, 40_000))
    found = np.cov(undone(noise, A, k))
    expected = np.linalg.inv(R)
    spread = np.outer(np.diag(expected), np.diag(expected)) + expected**2
    assert (np.abs(found - expected) < 5 * np.sqrt(spread / 40_000)).all()


def test_emphasis_raises_the_ratio_of_signal_to_noise_by_c_squared():
    """Against the ordinary features, and for any A'."""
    noise = {c: np.diag(np.linalg.inv(step(8, c)[3])) for c in (1.0, 10.0)}
    gained = noise[1.0] / noise[10.0]
    assert np.allclose(gained / gained[-1], [100, 100, 1, 1, 1])


def test_a_projection_that_loses_a_direction_has_no_metric():
    with pytest.raises(ValueError, match="columns of A are dependent"):
        eq.emphasis_metric(np.ones((3, 3)), 1.0)
    with pytest.raises(ValueError, match="scale is 0"):
        eq.emphasis_metric(np.eye(3), 0)
