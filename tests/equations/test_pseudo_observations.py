import statistics

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from projflow_lite import equations as eq

from .bodies import FULL_BODY, STICK

CONSTANTS = {name: eq.TABLE_5[name] for name in ("c0", "lambda_s", "p", "tau_min")}
BOUNDS = (eq.TABLE_5["pi_min"], eq.TABLE_5["pi_max"])
FLAGS = st.tuples(st.integers(1, 8), st.integers(1, 3)).flatmap(lambda s: arrays(bool, s))


def guide_by_hand(values, seen, n):
    """One guide, from the words of section B.2.1."""
    before = [m for m in range(n + 1) if seen[m]]
    after = [m for m in range(n, len(seen)) if seen[m]]
    if not before and not after:
        return None
    if not before:
        return values[after[0]]
    if not after:
        return values[before[-1]]
    a, b = before[-1], after[0]
    return values[a] if a == b else values[a] + (values[b] - values[a]) * (n - a) / (b - a)


@given(FLAGS)
def test_guides_by_brute_force(observed):
    frames, joints = observed.shape
    y = np.random.default_rng(0).normal(size=(frames, joints, 3))
    y_src, known = eq.interpolate_observations(y, observed)
    for n, j, c in np.ndindex(y.shape):
        guide = guide_by_hand(y[:, j, c].tolist(), observed[:, j].tolist(), n)
        assert known[n, j, c] == (guide is not None)
        assert y_src[n, j, c] == pytest.approx(guide if known[n, j, c] else 0, abs=1e-13)


def test_guides_of_single_axes():
    """A flag for each coordinate: height known in two frames, x in one, z never."""
    y, observed = np.zeros((4, 1, 3)), np.zeros((4, 1, 3), dtype=bool)
    observed[1, 0, 0], y[1, 0, 0] = True, 5
    observed[[0, 2], 0, 1], y[[0, 2], 0, 1] = True, [1, 3]
    y_src, known = eq.interpolate_observations(y, observed)
    np.testing.assert_array_equal(y_src[:, 0], [[5, 1, 0], [5, 2, 0], [5, 3, 0], [5, 3, 0]])
    np.testing.assert_array_equal(known[:, 0], [[True, True, False]] * 4)
    one_column, _ = eq.interpolate_observations([0.0, 9.0, 4.0], [True, False, True])
    np.testing.assert_array_equal(one_column, [0, 2, 4])


def test_halo_radius_is_a_straight_line_between_its_ends():
    t, a, b = sp.symbols("t a b")
    line = sp.interpolate([(0, b), (1, a)], t)
    radius = sp.lambdify((t, a, b), line)
    for s in (0, 0.25, 0.7, 1):
        assert eq.halo_radius(s, 3, 10) == pytest.approx(radius(s, 3, 10), abs=1e-14)
    assert eq.halo_radius(1, 0, 10) == 0
    np.testing.assert_allclose(eq.halo_radius([0, 0.5, 1], 3, 10), [10, 6.5, 3], rtol=0, atol=0)


def test_guides_never_vanish():
    """Erratum of eq. 14: at the last update (t = 0.99) six guides per keyframe still pull."""
    radius = eq.halo_radius(0.99, eq.TABLE_5["l_min"], eq.TABLE_5["l_max"])
    assert radius == pytest.approx(3.07)
    observed = np.zeros((21, 1), dtype=bool)
    observed[10] = True
    assert eq.halo(observed, radius).sum() == 6  # at t = 1 exactly, it would be 4
    assert eq.halo(observed, eq.halo_radius(1, 3, 10)).sum() == 4
    (trust,) = eq.frame_trust([1.0], 0.99, **CONSTANTS)
    assert trust == pytest.approx(0.1635, abs=1e-4)  # 0.109 * 3 / 2, by hand


def test_time_decay_is_a_straight_line_between_its_ends():
    t, floor = sp.symbols("t floor")
    decay = sp.lambdify((t, floor), sp.interpolate([(0, 1), (1, floor)], t))
    for s in (0, 0.25, 0.7, 1):
        assert eq.time_decay(s, 0.1) == pytest.approx(decay(s, 0.1), abs=1e-14)


def curvature_by_hand(x, edges, w_kin, ridge):
    """Second differences frame by frame, priced by an explicit loop over bones and joints."""
    frames, joints, _ = x.shape
    s = []
    for n in range(frames):
        middle = min(max(n, 1), frames - 2)  # the first and last frame copy their neighbour
        a = [[float(x[middle + 1, j, c] - 2 * x[middle, j, c] + x[middle - 1, j, c])
              for c in range(3)] for j in range(joints)]  # fmt: skip
        price = sum(w_kin * (a[i][c] - a[j][c]) ** 2 for i, j in edges for c in range(3))
        price += sum(ridge * a[j][c] ** 2 for j in range(joints) for c in range(3))
        s.append(price**0.5)
    return s


@given(st.integers(3, 7), st.integers(0, 2**32 - 1))
def test_curvature_by_an_explicit_loop_over_bones(frames, seed):
    edges, joints = STICK
    x = np.random.default_rng(seed).normal(size=(frames, joints, 3))
    R_J = eq.joint_metric(eq.kinematic_laplacian(edges, joints), 10.0, 1.0)
    expected = curvature_by_hand(x, edges, 10.0, 1.0)
    np.testing.assert_allclose(eq.curvature(x, R_J), expected, rtol=1e-12)


def test_curvature_by_hand():
    # One joint, ridge 4, a corner of height 1 at frame 1: |0 - 2 + 0| * sqrt(4) = 4.
    x = np.zeros((3, 1, 3))
    x[1, 0, 1] = 1
    np.testing.assert_allclose(eq.curvature(x, [[4.0]]), [4, 4, 4], rtol=0, atol=1e-15)


def test_a_steady_walk_does_not_bend():
    x = np.arange(6.0)[:, None, None] * np.ones((1, 22, 3))
    R_J = eq.joint_metric(eq.kinematic_laplacian(*FULL_BODY), 10.0, 1.0)
    np.testing.assert_allclose(eq.curvature(x, R_J), 0, rtol=0, atol=1e-14)
    for frames in (0, 1, 2):
        np.testing.assert_array_equal(eq.curvature(x[:frames], R_J), np.zeros(frames))


@given(st.lists(st.floats(0, 10), min_size=1, max_size=9), st.floats(0, 1))
def test_frame_trust_number_by_number(s, t):
    trust = eq.frame_trust(s, t, **CONSTANTS)
    released = eq.frame_trust(s, t, **CONSTANTS, form="released")
    for n, s_n in enumerate(s):
        for ours, middle in (
            (trust[n], statistics.median(s)),
            (released[n], statistics.median_low(s)),
        ):
            tau = 1 - 0.9 * t
            if middle == 0:
                expected = 0 if s_n > 0 else 3 * tau
            elif s_n / middle > 1e100:
                expected = 0
            else:
                expected = 3 * tau / (1 + (s_n / middle) ** 2)
            assert ours == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_the_median_of_an_even_number_of_frames():
    """Erratum of eq. 15: the released code takes the lower of the two middle values."""
    printed = eq.frame_trust([1.0, 3.0], 0, **CONSTANTS)
    released = eq.frame_trust([1.0, 3.0], 0, **CONSTANTS, form="released")
    np.testing.assert_allclose(printed, [3 / (1 + 1 / 4), 3 / (1 + 9 / 4)], rtol=0, atol=1e-14)
    np.testing.assert_allclose(released, [3 / 2, 3 / (1 + 9)], rtol=0, atol=1e-14)


def test_a_power_below_one_softens_the_curvature():
    trust = eq.frame_trust([1.0, 1.0, 4.0], 0, **(CONSTANTS | {"p": 0.5}))
    np.testing.assert_allclose(trust, [1.5, 1.5, 1], rtol=0, atol=1e-14)  # 3 / (1 + sqrt(4))


def test_frame_trust_where_nothing_bends():
    np.testing.assert_array_equal(eq.frame_trust(np.zeros(4), 0, **CONSTANTS), np.full(4, 3.0))
    # One corner in a straight walk: the corner gets no trust, the rest all of it.
    np.testing.assert_array_equal(eq.frame_trust([0, 0, 0, 5], 0, **CONSTANTS), [3, 3, 3, 0])
    # A zero median is the limit of a small one.
    near = eq.frame_trust([1e-9, 1e-9, 1e-9, 5], 0, **CONSTANTS)
    np.testing.assert_allclose(near, [1.5, 1.5, 1.5, 0], rtol=0, atol=1e-12)
    no_curvature = CONSTANTS | {"lambda_s": 0.0}
    np.testing.assert_array_equal(eq.frame_trust([0, 0, 5], 0, **no_curvature), [3, 3, 3])


def test_early_guides_are_as_hard_as_keyframes():
    """Erratum of eq. 15, 48 and 52 with Table 5: full trust is variance 0."""
    for t, hard in ((0, True), (0.37, True), (0.38, False)):
        (trust,) = eq.clip_trust(eq.frame_trust([1.0], t, **CONSTANTS), *BOUNDS)
        assert (eq.variance_from_trust(trust, 0.26) == 0) is np.bool_(hard)
    # So a projection cannot tell such a guide from a keyframe:
    R, variance = np.eye(3), eq.variance_from_trust(1.0, 1.0)
    moved = eq.project(np.zeros(3), np.eye(3)[:1], [1.0], R, [[variance]])
    assert moved[0] == 1.0


def test_an_unclipped_trust_is_no_variance():
    """Erratum of section B.2.3: a single active joint "simply" taking the frame's trust."""
    (trust,) = eq.frame_trust([0.0], 0, **CONSTANTS)
    assert trust == 3
    assert 0.26 * (1 / trust - 1) < 0  # what eq. 47 would make of it
    with pytest.raises(ValueError, match="clip it first"):
        eq.variance_from_trust(trust, 0.26)


@given(FLAGS, st.integers(0, 2**32 - 1), st.floats(0.01, 0.5), st.floats(0.5, 1))
def test_joint_trust_number_by_number(active, seed, pi_min, pi_max):
    frames, joints = active.shape
    rng = np.random.default_rng(seed)
    budget, q = rng.uniform(0, 3, frames), rng.uniform(0.5, 3, joints)
    for form in ("printed", "released"):
        trust = eq.joint_trust(budget, q, active, pi_min, pi_max, form=form)
        for n in range(frames):
            total = sum(float(q[k]) for k in range(joints) if active[n, k])
            start = float(budget[n])
            if form == "released":
                start = min(max(start, pi_min), pi_max)
            for j in range(joints):
                share = start * q[j] / total if active[n, j] else 0
                expected = min(max(share, pi_min), pi_max) if active[n, j] else 0
                assert trust[n, j] == pytest.approx(expected, rel=1e-12)


def test_joint_trust_keeps_the_budget_unless_it_clips():
    q, active = [1.0, 2.0, 5.0], [[True, True, False]]
    np.testing.assert_allclose(eq.joint_trust([0.6], q, active, *BOUNDS), [[0.2, 0.4, 0]])


def test_the_order_of_clipping_matters():
    """Erratum of section B.2.3: a raw budget of 3 shared by two joints, clipped late or early."""
    q, active = [1.0, 1.0], [[True, True]]
    printed = eq.joint_trust([3.0], q, active, *BOUNDS)
    released = eq.joint_trust([3.0], q, active, *BOUNDS, form="released")
    np.testing.assert_allclose(printed, [[1, 1]])  # both as hard as keyframes
    np.testing.assert_allclose(released, [[0.5, 0.5]])  # both soft


def test_table_5_can_be_used_as_it_is():
    assert eq.time_grid(int(eq.TABLE_5["steps"])).shape == (101,)
    assert eq.clip_trust([0.0, 0.5, 3.0], *BOUNDS).tolist() == [0.02, 0.5, 1.0]


@pytest.mark.parametrize(
    "call",
    [
        lambda: eq.halo_radius(0.5, 4, 3),
        lambda: eq.halo_radius(1.5, 3, 10),
        lambda: eq.time_decay(0.5, 1.5),
        lambda: eq.curvature(np.zeros((4, 2, 3)), np.eye(3)),
        lambda: eq.curvature(np.zeros((4, 2, 3)), np.zeros((2, 2))),
        lambda: eq.frame_trust([], 0, **CONSTANTS),
        lambda: eq.frame_trust([-1.0], 0, **CONSTANTS),
        lambda: eq.frame_trust([1.0], [0.0, 1.0], **CONSTANTS),
        lambda: eq.frame_trust([1.0], 0, **(CONSTANTS | {"p": 0})),
        lambda: eq.clip_trust(0.5, 0.0, 1.0),
        lambda: eq.clip_trust(0.5, 0.5, 1.1),
        lambda: eq.joint_trust([1.0], [0.0], [[True]], 0.1, 1),
        lambda: eq.joint_trust([1.0], [1.0], [[0.5]], 0.1, 1),
        lambda: eq.joint_trust([1.0], [1.0], [True], 0.1, 1),
        lambda: eq.joint_trust([1.0], [1.0], [[True]], 0.1, 1, form="derived"),
        lambda: eq.interpolate_observations(np.zeros((4, 2, 3)), np.ones((4, 3))),
    ],
)
def test_wrong_arguments_are_refused(call):
    with pytest.raises(ValueError, match=r"^\w+: "):
        call()
