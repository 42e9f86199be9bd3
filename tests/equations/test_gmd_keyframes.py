import re
from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from projflow_lite import equations as eq

ROWS = [1, 2]


def problem(seed):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=(4, 5)), rng.normal(size=(2, 5))
    mask = np.zeros((2, 5), dtype=bool)
    mask[:, 1] = mask[0, 3] = True
    return x, y, mask


@pytest.mark.parametrize("p", [1, 2, 3])
def test_goal_of_keyframes_step_by_step(p):
    x, y, mask = problem(0)
    total = 0.0
    for i in range(5):
        powers = [abs(x[ROWS[k], i] - y[k, i]) ** p for k in range(2) if mask[k, i]]
        total += sum(powers) ** (1 / p)
    assert eq.keyframe_goal(x[ROWS], y, mask, p) == pytest.approx(total)
    assert eq.keyframe_goal_of_motion(x, y, mask, ROWS, p) == pytest.approx(total)
    met = np.where(mask, y, x[ROWS])
    assert eq.keyframe_goal(met, y, mask, p) == 0


def test_released_goal_is_a_mean_of_three_numbers():
    x, y, mask = problem(1)
    three = [abs(x[1, 1] - y[0, 1]), abs(x[2, 1] - y[1, 1]), abs(x[1, 3] - y[0, 3])]
    released = eq.keyframe_goal_of_motion(x, y, mask, ROWS, form="released")
    assert released == pytest.approx(sum(three) / 3)


def test_printed_goal_has_no_value_or_a_wrong_one():
    x, y, mask = problem(2)
    with pytest.raises(ValueError, match=r"M_y \(2, 5\) times z - y \(2, 5\) has no value"):
        eq.keyframe_goal(x[ROWS], y, mask, form="printed")
    z, y, mask = np.array([[1.0, 2.0], [3.0, 5.0]]), np.zeros((2, 2)), np.array([[1, 0], [0, 0]])
    assert eq.keyframe_goal(z, y, mask) == 1  # one coordinate is observed, and it is 1 away
    assert eq.keyframe_goal(z, y, mask, form="printed") == 3  # a whole row instead


@pytest.mark.parametrize("p", [1, 1.5, 2, 4])
def test_gradient_of_keyframes_by_finite_differences(p):
    x, y, mask = problem(3)

    def goal(flat):
        return eq.keyframe_goal(flat.reshape(2, 5), y, mask, p)

    numerical = approx_fprime(x[ROWS].ravel(), goal, 1e-7).reshape(2, 5)
    assert np.allclose(eq.keyframe_gradient(x[ROWS], y, mask, p), numerical, atol=1e-5)
    met = np.where(mask, y, x[ROWS])
    assert not eq.keyframe_gradient(met, y, mask, p).any()


def test_gradient_does_not_know_how_far_it_is():
    _, y, mask = problem(4)
    for p in (1, 2):
        near, far = (eq.keyframe_gradient(y + d, y, mask, p) for d in (1e-3, 1e3))
        assert np.allclose(near, far)
    assert np.array_equal(eq.keyframe_gradient(y + 0.1, y, mask, 1), mask * 1.0)


def test_region_of_imputation_entry_by_entry():
    _, _, mask = problem(5)
    region = eq.imputation_region(mask, ROWS, 4)
    for row, i in np.ndindex(4, 5):
        assert region[row, i] == (row in ROWS and bool(mask[ROWS.index(row), i]))
    with pytest.raises(ValueError, match="acts on 4 rows, not on 2"):
        eq.imputation_region(mask, ROWS, 4, form="printed")


def test_straight_lines_against_fractions():
    frames, positions = [2, 5, 6], np.array([[0.5, -1.0], [2.0, 0.25], [1.0, 1.0]])
    z, known = eq.point_to_point(frames, positions, 9)
    assert z.shape == known.shape == (2, 9)
    for axis, i in np.ndindex(2, 9):
        expected = Fraction(0)
        for (a, p), (b, q) in zip(
            list(zip(frames, positions[:, axis], strict=True))[:-1],
            list(zip(frames, positions[:, axis], strict=True))[1:],
            strict=True,
        ):
            if a <= i <= b:
                share = Fraction(i - a, b - a)
                expected = (1 - share) * Fraction(p) + share * Fraction(q)
        assert known[axis, i] == (2 <= i <= 6)
        assert z[axis, i] == pytest.approx(float(expected))


def test_released_lines_start_from_the_origin():
    """By hand: from (0, 0) at step 0 to (4, -2) at step 4."""
    z, known = eq.point_to_point([4], [[4.0, -2.0]], 6, form="released")
    assert np.allclose(z[:, :5], [[0, 1, 2, 3, 4], [0, -0.5, -1, -1.5, -2]])
    assert known[0].tolist() == [True] * 5 + [False]
    alone, known = eq.point_to_point([4], [[4.0, -2.0]], 6)
    assert known[0].tolist() == [False] * 4 + [True, False]
    assert np.array_equal(alone, z * known)
    start = [0, 3], [[1.0, 1.0], [2.0, 2.0]], 4
    assert np.array_equal(*(eq.point_to_point(*start, form=f)[0] for f in ("derived", "released")))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: eq.point_to_point([3, 3], np.zeros((2, 2)), 5), "must increase within 0..4"),
        (lambda: eq.point_to_point([5], np.zeros((1, 2)), 5), "must increase within 0..4"),
        (lambda: eq.point_to_point([], np.zeros((0, 2)), 5), "must increase"),
        (lambda: eq.keyframe_goal(np.ones((2, 3)), np.ones((2, 3)), np.ones((2, 3)), 0.5), "p = "),
        (
            lambda: eq.keyframe_goal(*np.zeros((3, 2, 3)), form="released"),
            "needs p = 1 and a keyframe",
        ),
        (lambda: eq.keyframe_goal(np.ones((2, 3)), np.ones((2, 4)), np.ones((2, 3))), "differ"),
    ],
)
def test_mistakes_are_named(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()
