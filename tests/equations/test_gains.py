import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from projflow_lite import equations as eq

from .bodies import STICK, random_precision


def masked_problem(seed, d=6, soft=0.0):
    """Return x1_hat, a mask with gaps, y and Sigma that is 0 wherever nothing is observed."""
    rng = np.random.default_rng(seed)
    m = rng.integers(0, 2, d)
    y, variance = m * rng.normal(size=d), m * rng.uniform(0.1, 2, d) * soft
    return rng.normal(size=d), np.diag(m).astype(float), y, np.diag(variance)


def test_euclidean_gain_symbolically_from_39_to_43():
    """A 2 x 2 mask with one observed coordinate, every step by sympy."""
    x1, x2, y1, s1, s2 = sp.symbols("x1 x2 y1 s1 s2", positive=True)
    x, y, M, Sigma = sp.Matrix([x1, x2]), sp.Matrix([y1, 0]), sp.diag(1, 0), sp.diag(s1, s2)
    eq_39 = x + M * (M + Sigma).inv() * (y - M * x)
    eq_40 = (sp.eye(2) - M * (M + Sigma).inv() * M) * x + M * (M + Sigma).inv() * y
    eq_41 = (1 - 1 / (1 + s1)) * x1 + y1 / (1 + s1)
    pi = 1 / (1 + s1)
    assert sp.simplify(eq_39 - eq_40) == sp.zeros(2, 1)
    assert sp.simplify(eq_39[0] - eq_41) == 0
    assert sp.simplify(eq_41 - ((1 - pi) * x1 + pi * y1)) == 0
    assert eq_39[1] == x2
    point = {x1: 0.4, x2: 1.1, y1: 2.0, s1: 0.25, s2: 0.7}
    expected = np.array(eq_39.subs(point), dtype=float).ravel()
    args = ([0.4, 1.1], np.diag([1, 0]), [2.0, 0.0], np.diag([0.25, 0.7]))
    for form in ("derived", "printed"):
        np.testing.assert_allclose(
            eq.euclidean_masked_update(*args, form), expected, rtol=0, atol=1e-15
        )
        np.testing.assert_allclose(
            eq.euclidean_masked_average(*args, form), expected, rtol=0, atol=1e-15
        )
    coordinate = eq.euclidean_coordinate_update([0.4], [2.0], [0.25])
    np.testing.assert_allclose(coordinate, expected[:1], rtol=0, atol=1e-15)
    gain = eq.euclidean_gain([0.25])
    np.testing.assert_allclose(gain, [0.8], rtol=0, atol=1e-15)  # 1 / 1.25
    np.testing.assert_allclose(
        eq.weighted_average([0.4], [2.0], gain), expected[:1], rtol=0, atol=1e-15
    )


def test_weighted_average_by_hand():
    np.testing.assert_allclose(eq.weighted_average([0.0, 4.0], [8.0, 8.0], [0.25, 1.0]), [2, 8])


@given(st.floats(0, 1e3), st.floats(-5, 5), st.floats(-5, 5))
def test_one_coordinate_minimises_its_own_price(variance, x_i, y_i):
    """Eq. 41 against a search: (x - x_i)^2 + (x - y_i)^2 / variance has its least value there."""
    (best,) = eq.euclidean_coordinate_update([x_i], [y_i], [variance])
    if variance == 0:
        assert best == pytest.approx(y_i, abs=1e-12)
        return

    def price(x):  # multiplied by the variance, so that a small one does no harm
        return variance * (x - x_i) ** 2 + (x - y_i) ** 2

    assert price(best) <= min(price(best - 1e-3), price(best + 1e-3))


def test_printed_inverse_does_not_exist_for_hard_keyframes():
    """Erratum of eq. 12, 39, 40, 44: any unobserved coordinate without variance is fatal."""
    x1_hat, y = [1.0, 2.0, 3.0], [5.0, 0.0, 0.0]
    M, Sigma, R = np.diag([1, 0, 0]), np.zeros((3, 3)), np.eye(3)
    for function in (eq.euclidean_masked_update, eq.euclidean_masked_average):
        np.testing.assert_allclose(function(x1_hat, M, y, Sigma), [5, 2, 3], rtol=0, atol=1e-15)
        with pytest.raises(ValueError, match="singular; use form='derived'"):
            function(x1_hat, M, y, Sigma, form="printed")
    for general in (eq.masked_update, eq.masked_average):
        np.testing.assert_allclose(general(x1_hat, M, y, R, Sigma), [5, 2, 3], rtol=0, atol=1e-15)
        with pytest.raises(ValueError, match="singular; use form='derived'"):
            general(x1_hat, M, y, R, Sigma, form="printed")


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1.0]))
def test_masked_forms_agree_with_selected_rows(seed, soft):
    """The oracle has no empty row: pick the observed ones and solve their normal equations."""
    x1_hat, M, y, Sigma = masked_problem(seed, soft=soft)
    R = random_precision(np.random.default_rng(seed), 6)
    seen = np.flatnonzero(np.diag(M))
    free = np.setdiff1d(np.arange(6), seen)
    expected = x1_hat.copy()
    if soft:
        precision = R.copy()
        precision[seen, seen] += 1 / np.diag(Sigma)[seen]
        right = R @ x1_hat
        right[seen] += y[seen] / np.diag(Sigma)[seen]
        expected = np.linalg.solve(precision, right)
    else:  # hard: observed ones take their value, the free ones the conditional mean
        expected[seen] = y[seen]
        pull = R[np.ix_(free, seen)] @ (y - x1_hat)[seen]
        expected[free] -= np.linalg.solve(R[np.ix_(free, free)], pull)
    np.testing.assert_allclose(
        eq.masked_update(x1_hat, M, y, R, Sigma), expected, rtol=0, atol=1e-10
    )
    np.testing.assert_allclose(
        eq.masked_average(x1_hat, M, y, R, Sigma), expected, rtol=0, atol=1e-10
    )


def test_printed_and_derived_agree_where_every_row_has_variance():
    x1_hat, M, y, _ = masked_problem(3)
    R, Sigma = random_precision(np.random.default_rng(3), 6), 0.5 * np.eye(6)
    for general in (eq.masked_update, eq.masked_average):
        np.testing.assert_allclose(
            general(x1_hat, M, y, R, Sigma, form="printed"),
            general(x1_hat, M, y, R, Sigma, form="derived"),
            rtol=0,
            atol=1e-13,
        )


def test_eq_44_splits_into_45_symbolically():
    r1, r2, r12, s = sp.symbols("r1 r2 r12 s", positive=True)
    x, y = sp.Matrix(sp.symbols("x1 x2")), sp.Matrix([sp.Symbol("y1"), 0])
    R, M, Sigma = sp.Matrix([[r1, r12], [r12, r2]]), sp.diag(1, 0), sp.diag(s, 1)
    K = R.inv() * M.T * (M * R.inv() * M.T + Sigma).inv()
    assert sp.simplify(x + K * (y - M * x) - ((sp.eye(2) - K * M) * x + K * y)) == sp.zeros(2, 1)
    point = dict(zip([r1, r2, r12, s, *x, y[0]], [2, 1.5, 0.4, 0.3, 1, -1, 2], strict=True))
    expected = np.array((x + K * (y - M * x)).subs(point), dtype=float).ravel()
    args = ([1, -1], np.diag([1, 0]), [2, 0], [[2, 0.4], [0.4, 1.5]], np.diag([0.3, 1]))
    np.testing.assert_allclose(eq.masked_update(*args), expected, rtol=0, atol=1e-14)
    np.testing.assert_allclose(eq.masked_average(*args), expected, rtol=0, atol=1e-14)


def test_trust_and_variance_undo_each_other_symbolically():
    """Eq. 46 solved for the variance by sympy is 47, and 47 is 18."""
    pi, r, v = sp.symbols("pi r v", positive=True)
    (solved,) = sp.solve(sp.Eq(pi, r / (r + v)), v)
    assert sp.simplify(solved - r * (1 / pi - 1)) == 0
    assert sp.simplify(solved - r * (1 - pi) / pi) == 0
    assert sp.simplify((r / (r + v)).subs(r, 1) - 1 / (1 + v)) == 0  # 46, not 47, reduces to 42
    variance = sp.lambdify((pi, r), solved)
    for trust, prior in ((0.02, 0.1), (0.5, 0.26), (1.0, 3.0)):
        assert eq.variance_from_trust(trust, prior) == pytest.approx(variance(trust, prior))


@given(st.floats(0.01, 1), st.floats(0.01, 10))
def test_trust_survives_the_round_trip(pi, r):
    assert eq.trust_from_variance(eq.variance_from_trust(pi, r), r) == pytest.approx(pi, rel=1e-9)


def test_trust_is_the_share_of_the_misfit_that_one_row_corrects():
    """Eq. 46 measured: observe one coordinate, project, and see how far it went towards y."""
    edges, joints = STICK
    R_J = eq.joint_metric(eq.kinematic_laplacian(edges, joints), 10.0, 1.0)
    R = eq.kinematic_metric(2, eq.kinematic_laplacian(edges, joints), 10.0, 1.0)
    r = eq.marginal_variance(R_J)
    x1_hat, rng = np.random.default_rng(0).normal(size=24), np.random.default_rng(1)
    for i in range(24):
        variance = rng.uniform(0, 1)
        row = np.eye(24)[[i]]
        moved = eq.project(x1_hat, row, [7.0], R, [[variance]])
        share = (moved[i] - x1_hat[i]) / (7.0 - x1_hat[i])
        assert share == pytest.approx(eq.trust_from_variance(variance, r[i // 3 % joints]))
        pi = rng.uniform(0.1, 1)
        variance = eq.variance_from_trust(pi, r[i // 3 % joints])
        moved = eq.project(x1_hat, row, [7.0], R, [[variance]])
        assert (moved[i] - x1_hat[i]) / (7.0 - x1_hat[i]) == pytest.approx(pi)


def test_neighbouring_guides_overshoot_the_trust_of_a_single_one():
    """Eq. 46 speaks of one active row. Two guides on neighbouring joints push each other on."""
    R = eq.kinematic_metric(1, eq.kinematic_laplacian([(0, 1)], 2), 10.0, 1.0)
    r = np.linalg.inv(R)[0, 0]
    rows, variance = np.eye(6)[[0, 3]], eq.variance_from_trust(0.5, r)
    moved = eq.project(np.zeros(6), rows, [1.0, 1.0], R, variance * np.eye(2))
    assert moved[0] == pytest.approx(0.656, abs=5e-4)  # (r + c) / (r + c + variance), c = 10/21


@pytest.mark.parametrize(
    "call",
    [
        lambda: eq.variance_from_trust(0.0, 1.0),
        lambda: eq.variance_from_trust(3.0, 1.0),
        lambda: eq.variance_from_trust(0.5, 0.0),
        lambda: eq.trust_from_variance(-0.1, 1.0),
        lambda: eq.trust_from_variance(0.1, [1.0]),
        lambda: eq.euclidean_gain(-1.0),
        lambda: eq.euclidean_coordinate_update(0.0, 0.0, -1.0),
        lambda: eq.euclidean_masked_update([0.0], [[2.0]], [0.0], [[0.0]]),
        lambda: eq.masked_update([0.0], [[1.0]], [0.0], [[1.0]], [[-1.0]]),
        lambda: eq.masked_average([0.0], [[1.0]], [0.0], [[1.0]], [[1.0]], form="released"),
    ],
)
def test_wrong_arguments_are_refused(call):
    with pytest.raises(ValueError, match=r"^\w+: "):
        call()
