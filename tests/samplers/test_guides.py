"""Guides between keyframes: the batched fast path against the equations, frame by frame."""

from dataclasses import replace

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.projection import Projector
from projflow_lite.samplers import Guides, GuideSettings, ProjectionStep

FRAMES = 30
R_J = kinematic_joint_metric()
SETTINGS = GuideSettings()
WISH = pf.pin("left_wrist", [4, 25], [[0, 1, 2], [1, 1, 1]]) & pf.pin(
    ["head", "pelvis"], [9], [[[0, 1], [0, 2]]], axes="xy"
)


def observed_and_values():
    """Which coordinates are pinned, and to what, as arrays ``(frames, 22, 3)``."""
    A, y, _ = WISH.rows(FRAMES)
    observed = np.asarray(A.sum(axis=0)).reshape(FRAMES, 22, 3) > 0
    return observed, (A.T @ y).reshape(FRAMES, 22, 3)


def variance_by_the_equations(x1_hat, t, form):
    """Variance of every coordinate, infinite where nothing guides, ``(frames, 22, 3)``."""
    c = SETTINGS
    observed, _ = observed_and_values()
    radius = equations.halo_radius(t, c.l_min, c.l_max)
    near = np.zeros(observed.shape, dtype=bool)
    for n in range(FRAMES):
        for j in range(22):
            for k in range(3):
                keys = np.flatnonzero(observed[:, j, k])
                near[n, j, k] = (
                    len(keys) > 0 and not observed[n, j, k] and np.abs(keys - n).min() < radius
                )
    s = equations.curvature(x1_hat, R_J)
    trust = equations.frame_trust(s, t, c.c0, c.lambda_s, c.p, c.tau_min, form)
    q = equations.influence_weights(R_J, form)
    pi = equations.joint_trust(trust, q, near.any(axis=2), c.pi_min, c.pi_max, form)
    r = np.diag(np.linalg.inv(R_J))
    variance = np.full(observed.shape, np.inf)
    for n, j, k in np.argwhere(near):
        variance[n, j, k] = equations.variance_from_trust(pi[n, j], r[j])
    return variance


@pytest.mark.parametrize("form", ["printed", "released"])
@pytest.mark.parametrize("t", [0.0, 0.37, 0.8, 0.99])
def test_variances_are_those_of_the_equations(t, form):
    guides = Guides(WISH.rows(FRAMES), R_J, replace(SETTINGS, form=form), torch.float64)
    x = np.random.default_rng(0).normal(size=(2, FRAMES, 22, 3)).cumsum(1)
    ours = guides.variance(torch.as_tensor(x), t).numpy()
    m = len(WISH.rows(FRAMES).y)
    assert not ours[:, :m].any()
    columns = guides.rows.A.indices[m:]
    for clip in range(2):
        expected = variance_by_the_equations(x[clip], t, form).ravel()
        np.testing.assert_allclose(ours[clip, m:], expected[columns], rtol=1e-10)
        assert np.isfinite(ours[clip, m:]).sum() == np.isfinite(expected).sum()


@pytest.mark.parametrize("form", ["printed", "released"])
@pytest.mark.parametrize("frames", [3, 4, 8, 9])
def test_trust_is_that_of_the_equations_for_odd_and_even_lengths(frames, form):
    guides = Guides(pf.pin("head", 1, [0, 1, 2]).rows(frames), R_J, GuideSettings(form=form))
    x = np.random.default_rng(1).normal(size=(2, frames, 22, 3)).cumsum(1)
    ours = guides.frame_trust(torch.as_tensor(x, dtype=torch.float32), 0.4)
    c = SETTINGS
    for clip in range(2):
        s = equations.curvature(x[clip], R_J)
        expected = equations.frame_trust(s, 0.4, c.c0, c.lambda_s, c.p, c.tau_min, form)
        np.testing.assert_allclose(ours[clip], expected, rtol=1e-5)


@pytest.mark.parametrize("frames", [1, 2])
def test_what_is_too_short_to_bend_is_trusted_fully(frames):
    guides = Guides(pf.pin("head", 0, [0, 1, 2]).rows(frames), R_J)
    x = torch.randn(2, frames, 22, 3)
    # By hand, at t = 1: c0 times tau_min, over 1 and no curvature.
    torch.testing.assert_close(guides.frame_trust(x, 1.0), torch.full((2, frames), 3.0 * 0.1))


def test_a_resting_body_is_trusted_fully_where_it_rests():
    guides = Guides(pf.pin("head", 0, [0, 1, 2]).rows(9), R_J)
    x = torch.zeros(1, 9, 22, 3)
    x[0, 7:] = 1.0  # bends at frames 6 and 7 only, so that the median is 0
    trust = guides.frame_trust(x, 0.0)[0]
    torch.testing.assert_close(trust[:6], torch.full((6,), 3.0))
    assert (trust[6:8] == 0).all()


def test_axes_of_one_joint_may_have_keyframes_of_their_own():
    wish = pf.pin("head", 2, [1.0], axes="y") & pf.pin("head", [6, 8], [[3.0], [5.0]], axes="x")
    guides = Guides(wish.rows(10), R_J)
    column = guides.rows.A.indices[3:]
    frame, axis = column // 66, column % 3
    height = axis == 1
    np.testing.assert_array_equal(guides.rows.y[3:][height], 1.0)
    np.testing.assert_array_equal(guides.distance.numpy()[height], np.abs(frame[height] - 2))
    assert dict(zip(frame[~height], guides.rows.y[3:][~height], strict=True)) == {
        **dict.fromkeys(range(6), 3.0), 7: 4.0, 9: 5.0,
    }  # fmt: skip


def test_targets_are_the_interpolated_observations():
    observed, values = observed_and_values()
    line, has_guide = equations.interpolate_observations(values, observed)
    guides = Guides(WISH.rows(FRAMES), R_J)
    m = len(WISH.rows(FRAMES).y)
    columns = guides.rows.A.indices[m:]
    np.testing.assert_array_equal(np.sort(columns), np.flatnonzero((has_guide & ~observed).ravel()))
    np.testing.assert_allclose(guides.rows.y[m:], line.ravel()[columns], atol=1e-12)
    batch = guides.targets(np.stack([guides.rows.y[:m], 2 * guides.rows.y[:m]]))
    np.testing.assert_allclose(batch[1], 2 * batch[0], atol=1e-12)


def test_a_guided_projection_is_the_dense_formula_with_those_variances():
    frames = 6
    wish = pf.pin("head", [1, 4], [[0, 1, 2], [1, 1, 1]])
    guides = Guides(wish.rows(frames), R_J, SETTINGS, torch.float64)
    x = torch.randn(
        1, frames, 22, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(0)
    )
    variance = guides.variance(x, 0.6)
    ours = Projector(guides.rows, dtype=torch.float64).project(x, variance)
    active = np.isfinite(variance[0].numpy())
    R = equations.kinematic_metric(
        frames, equations.kinematic_laplacian(pf.skeleton.EDGES, 22), 10, 1
    )
    dense = equations.project(
        x.numpy().ravel(), guides.rows.A.toarray()[active], guides.rows.y[active], R,
        np.diag(variance[0].numpy()[active]),
    )  # fmt: skip
    np.testing.assert_allclose(ours.numpy().ravel(), dense, atol=1e-9)


@pytest.mark.parametrize("axes", ["xyz", "xy", "y"])
@pytest.mark.parametrize("std", [0.0, 0.05])
def test_one_elimination_for_three_axes_is_three(axes, std):
    """With pins of whole points and with others, and where axes have keyframes of their own."""
    random = np.random.default_rng(0)
    three = pf.pin(["head", "left_wrist"], [2, 9], random.normal(size=(2, 2, 3)))
    other = pf.pin("pelvis", [5, 7], random.normal(size=(2, len(axes))), axes, std=std)
    step = ProjectionStep(three & other, 12, dtype=torch.float64)
    x = torch.as_tensor(random.normal(size=(3, 12, 22, 3)).cumsum(1))
    for t in (0.0, 0.5, 0.9):
        looked_at = step.projector.project(x, step.guides.variance(x, t))
        torch.testing.assert_close(step(x, t), looked_at, rtol=0, atol=1e-12)
    assert step.known.alike == (axes == "xyz" or all(b.axes == 1 for b in step.projector.blocks))


def test_every_frame_pinned_leaves_nothing_to_guide():
    rows = pf.pin("head", None, np.zeros((8, 3))).rows(8)
    assert len(Guides(rows, R_J)) == 0
    assert len(Guides(pf.loop().rows(8), R_J)) == 0


def test_a_lone_keyframe_is_copied_to_both_sides():
    guides = Guides(pf.pin("head", 3, [1.0, 2.0, 3.0]).rows(8), R_J)
    np.testing.assert_array_equal(
        guides.rows.y, np.repeat([1.0, 2.0, 3.0], [8, 8, 8])[np.r_[0, 8, 16, 1:8, 9:16, 17:24]]
    )


def test_guides_take_the_neighbours_of_a_keyframe_along_and_let_them_go_later():
    x = torch.zeros(1, 30, 22, 3)
    rows = pf.pin("left_wrist", 15, [0.3, 0.3, 0.3]).rows(30)
    guides = Guides(rows, R_J)
    projector = Projector(guides.rows)

    def neighbours(t):
        return projector.project(x, guides.variance(x, t))[0, :, 20, 0]

    early, late, alone = neighbours(0.2), neighbours(0.95), Projector(rows).project(x)[0, :, 20, 0]
    assert early[15] == late[15] == alone[15] == torch.tensor(0.3)
    assert alone[14] == 0
    assert early[14] > 0.25 > late[14] > 0.01
    assert early[7] > 0.25
    assert late[7] == 0


def test_the_two_forms_differ_where_joints_share_a_budget():
    x = torch.randn(1, FRAMES, 22, 3, generator=torch.Generator().manual_seed(0)).cumsum(1)
    printed = Guides(WISH.rows(FRAMES), R_J, GuideSettings()).variance(x, 0.1)
    released = Guides(WISH.rows(FRAMES), R_J, GuideSettings(form="released")).variance(x, 0.1)
    assert torch.isinf(printed).equal(torch.isinf(released))
    active = torch.isfinite(printed) & (printed > 0)
    assert (released / printed)[active].max() > 1.5


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"form": "derived"}, "guides: form is 'printed' or 'released', not 'derived'"),
        ({"pi_min": 0.0}, "guides: trust is bounded by 0 < pi_min <= pi_max <= 1"),
        ({"pi_max": 1.5}, "guides: trust is bounded by 0 < pi_min <= pi_max <= 1"),
    ],
)
def test_settings_that_make_no_sense_are_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        GuideSettings(**wrong)
