import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from projflow_lite import equations as eq

FLAGS = st.tuples(st.integers(1, 6), st.integers(1, 3)).flatmap(lambda s: arrays(bool, (*s, 3)))


@given(FLAGS)
def test_mask_keeps_observed_coordinates_and_zeroes_the_rest(observed):
    x = np.random.default_rng(0).normal(size=observed.shape)
    kept = eq.masked_observation(eq.vectorise(x), eq.observation_mask(observed))
    kept = eq.unvectorise(kept, *observed.shape[:2])
    for place in np.ndindex(x.shape):
        assert kept[place] == (x[place] if observed[place] else 0)


@given(FLAGS)
def test_selection_rows_pick_the_same_values_without_the_empty_rows(observed):
    x = np.random.default_rng(1).normal(size=observed.shape)
    picked = [x[place] for place in np.ndindex(x.shape) if observed[place]]
    A = eq.selection_rows(observed)
    assert A.shape == (len(picked), x.size)
    np.testing.assert_array_equal(A @ eq.vectorise(x), picked)
    assert np.linalg.matrix_rank(A) == len(picked)  # never dependent, unlike the square mask


def test_released_selection_is_wrong_for_a_wish_about_height():
    """Erratum of eq. 12: pin only the height of a joint; the released form sees nothing."""
    observed = np.zeros((1, 2, 3), dtype=bool)
    observed[0, 1, 1] = True
    np.testing.assert_array_equal(eq.selection_rows(observed), [[0, 0, 0, 0, 1, 0]])
    assert len(eq.selection_rows(observed, form="released")) == 0
    observed[0, 1] = (True, False, False)  # and a wish about x alone also fixes y and z
    assert len(eq.selection_rows(observed, form="released")) == 3
    everything = np.ones((1, 2, 3), dtype=bool)  # a whole joint is the case where both agree
    for form in ("derived", "released"):
        np.testing.assert_array_equal(eq.selection_rows(everything, form=form), np.eye(6))


def test_guides_fill_their_coordinates_and_leave_the_others():
    M_obs, M_aug = np.diag([1, 0, 0, 0]), np.diag([0, 1, 1, 0])
    M, y = eq.combined_observation(M_obs, M_aug, [7, 0, 0, 0], [1, 2, 3, 4])
    np.testing.assert_array_equal(M, np.diag([1, 1, 1, 0]))
    np.testing.assert_array_equal(y, [7, 2, 3, 0])  # by hand: the keyframe is not touched


@pytest.mark.parametrize(
    ("M_obs", "M_aug", "y_obs", "message"),
    [
        (np.eye(2), np.diag([0, 1]), [1, 1], "share a coordinate"),
        (np.diag([1, 0]), np.diag([0, 1]), [1, 1], "not zero where nothing is observed"),
        (np.diag([2, 0]), np.diag([0, 1]), [1, 0], "M_obs is not a diagonal matrix"),
        (np.eye(2), np.ones((2, 2)), [1, 1], "M_aug is not a diagonal matrix"),
        (np.eye(3), np.eye(2), [1, 1], "M_obs has shape"),
    ],
)
def test_masks_that_do_not_fit_are_named(M_obs, M_aug, y_obs, message):
    with pytest.raises(ValueError, match=f"combined_observation: .*{message}"):
        eq.combined_observation(M_obs, M_aug, y_obs, [0, 0])


@given(FLAGS, st.floats(0, 8))
def test_halo_by_brute_force(observed, radius):
    active = eq.halo(observed, radius)
    frames, joints, axes = observed.shape
    for n in range(frames):
        for j in range(joints):
            for c in range(axes):
                nearest = min(
                    (abs(n - m) for m in range(frames) if observed[m, j, c]), default=float("inf")
                )
                assert active[n, j, c] == (0 < nearest < radius)


def test_halo_by_hand():
    observed = np.zeros((9, 1), dtype=bool)
    observed[4] = True
    # "less than this radius": a radius of 3 reaches two frames to each side.
    np.testing.assert_array_equal(np.flatnonzero(eq.halo(observed, 3)), [2, 3, 5, 6])
    np.testing.assert_array_equal(np.flatnonzero(eq.halo(observed, 3.1)), [1, 2, 3, 5, 6, 7])
    assert not eq.halo(observed, 1).any()
    assert not eq.halo(np.zeros((5, 2)), 10).any()
    assert not eq.halo(np.ones((1, 1)), 10).any()


def test_flags_must_be_flags():
    for function in (eq.observation_mask, eq.selection_rows, lambda o: eq.halo(o, 2)):
        with pytest.raises(ValueError, match="neither true nor false"):
            function(np.full((2, 1, 3), 0.5))
