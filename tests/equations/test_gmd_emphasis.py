import re

import numpy as np
import pytest

from projflow_lite import equations as eq

N, EMPHASISED, C = 263, [0, 1, 2], 10.0
ROWS = [1, 2]


def small(seed, c=10.0, features=6, steps=4):
    """Return x, z, mask, A and k of a small motion with well-conditioned A'."""
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.normal(size=(features, features)))
    A_prime = Q * rng.uniform(0.5, 2, features) + 0.1 * rng.normal(size=Q.shape)
    x, z = rng.normal(size=(features, steps)), rng.normal(size=(2, steps))
    mask = eq.imputation_region(rng.integers(0, 2, z.shape), ROWS, features)
    A, k = eq.emphasis_matrix(A_prime, EMPHASISED, c), eq.emphasis_scale(features, EMPHASISED, c)
    return x, z, mask, A, k


def test_emphasis_matrix_entry_by_entry():
    A_prime = np.random.default_rng(0).normal(size=(4, 4))
    A = eq.emphasis_matrix(A_prime, [1], 3.0)
    for i, j in np.ndindex(4, 4):
        assert A[i, j] == A_prime[i, j] * (3.0 if j == 1 else 1.0)


def test_unit_variance_of_a_projected_motion():
    """Drawn: A' and x standard normal. 40 projected frames of 263 features each."""
    rng = np.random.default_rng(1)
    squares, printed = [], []
    for _ in range(40):
        A = eq.emphasis_matrix(rng.normal(size=(N, N)), EMPHASISED, C)
        x = rng.normal(size=(N, 1))
        squares.append((eq.emphasise(x, A, eq.emphasis_scale(N, EMPHASISED, C)) ** 2).mean())
        k_printed = eq.emphasis_scale(N, EMPHASISED, C, form="printed")
        printed.append((eq.emphasise(x, A, k_printed) ** 2).mean())
    error = np.std(squares) / np.sqrt(len(squares))
    assert error < 0.15
    assert abs(np.mean(squares) - 1) < 5 * error
    assert np.sqrt(np.mean(printed)) == pytest.approx(0.042, abs=5 * 0.042 * error)


def test_variance_is_one_on_average_only():
    """Coordinate by coordinate the exact variance of white data is k^2 sum_j B_jj^2 A'_ij^2."""
    A_prime = np.random.default_rng(2).normal(size=(N, N))
    k = eq.emphasis_scale(N, EMPHASISED, C)
    variance = (eq.emphasise(np.eye(N), eq.emphasis_matrix(A_prime, EMPHASISED, C), k) ** 2).sum(1)
    by_hand = np.sqrt(2 * (260 + 3 * 10**4)) / 560
    assert by_hand == pytest.approx(0.44, abs=0.005)
    assert variance.std() == pytest.approx(by_hand, rel=0.25)
    assert variance.min() < 0.55
    assert variance.max() > 2


def test_undoing_the_projection_solves_a_linear_system():
    x, _, _, A, k = small(3)
    x_proj = eq.emphasise(x, A, k)
    assert np.allclose(x_proj, [[k * sum(A[i] * x[:, t]) for t in range(4)] for i in range(6)])
    assert np.allclose(eq.unemphasise(x_proj, A, k), np.linalg.solve(k * A, x_proj))
    assert np.allclose(eq.unemphasise(x_proj, A, k), x)
    assert np.allclose(eq.unemphasise(x_proj, A, k, form="printed"), k * x)
    batch = np.stack([x, 2 * x])
    assert np.allclose(eq.unemphasise(eq.emphasise(batch, A, k), A, k), batch)


def test_a_square_random_matrix_is_far_from_orthogonal():
    """What the docstring of unemphasise says, at the paper's size."""
    rng = np.random.default_rng(4)
    draws = [eq.emphasis_matrix(rng.normal(size=(N, N)), EMPHASISED, C) for _ in range(5)]
    assert np.median([np.linalg.cond(A) for A in draws]) > 1000


def test_imputing_entry_by_entry():
    x, z, mask, _, _ = small(5)
    ours = eq.impute(x, z, mask, ROWS)
    for row, i in np.ndindex(x.shape):
        known = row in ROWS and mask[row, i]
        assert ours[row, i] == (z[ROWS.index(row), i] if known else x[row, i])


def test_imputing_a_projected_motion_by_solving_for_it():
    """Unknown: the projected result. Known: what its motion is, on the mask and off it."""
    x, z, mask, A, k = small(6)
    x0_proj = eq.emphasise(x, A, k)
    ours = eq.impute_emphasised(x0_proj, z, mask, ROWS, A, k)
    for i in range(4):
        wanted = [
            z[ROWS.index(j), i] if mask[j, i] else np.linalg.solve(k * A, x0_proj[:, i])[j]
            for j in range(6)
        ]
        assert np.allclose(np.linalg.solve(k * A, ours[:, i]), wanted)


def test_printed_imputation_makes_the_trajectory_too_large():
    x, z, mask, A, k = small(7)
    printed = eq.impute_emphasised(eq.emphasise(x, A, k), z, mask, ROWS, A, k, form="printed")
    motion = np.linalg.solve(k * A, printed)
    assert np.allclose(motion[~mask], x[~mask])
    wanted = eq.fill_trajectory(z, ROWS, 6)
    assert np.allclose(motion[mask], wanted[mask] / k)
    assert 1 / eq.emphasis_scale(N, EMPHASISED, C) == pytest.approx(23.7, abs=0.05)


@pytest.mark.parametrize("c", [0.5, 1.0, 10.0, 1e4])
def test_imputation_under_emphasis_is_plain_imputation(c):
    """A and c drop out: un-projected, GMD's imputation is a projection with R = I (ddnm)."""
    x, z, mask, A, k = small(8, c)
    motion = eq.unemphasise(eq.impute_emphasised(eq.emphasise(x, A, k), z, mask, ROWS, A, k), A, k)
    for i in range(4):
        S = np.eye(6)[mask[:, i]]
        y = eq.fill_trajectory(z, ROWS, 6)[mask[:, i], i]
        assert np.allclose(motion[:, i], eq.ddnm(x[:, i], S, y), atol=1e-9)
        hard = np.zeros((len(y), len(y)))
        assert np.allclose(motion[:, i], eq.project(x[:, i], S, y, np.eye(6), hard), atol=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: eq.emphasis_matrix(np.eye(3), [3], 2.0), "row 3 is outside 0..2"),
        (lambda: eq.emphasis_scale(3, [0], 0.0), "c = 0.0, expected a positive number"),
        (lambda: eq.emphasise(np.zeros((2, 3)), np.eye(3), 1.0), "x has 2 features, A expects 3"),
        (lambda: eq.unemphasise(np.zeros((2, 3)), np.ones((2, 2)), 1.0), "columns of A are"),
        (lambda: eq.unemphasise(np.zeros((2, 3)), np.eye(2), 0.0), "scale is 0.0"),
        (lambda: eq.unemphasise(np.zeros((3, 3)), np.eye(2), 1.0), "A gives 2"),
        (
            lambda: eq.impute(np.zeros((3, 2)), np.zeros((1, 2)), np.ones((3, 2)), [1]),
            "mask covers feature 0",
        ),
    ],
)
def test_mistakes_are_named(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()
