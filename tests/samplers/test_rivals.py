"""Rivals that overwrite or project, and what all of them have in common at the one door."""

import numpy as np
import pytest
import torch
from rival_flow import (
    DOWNHILL,
    PINS,
    RIVALS,
    ROWS,
    SHAPE,
    SOFT,
    STEPS,
    dense,
    fresh_noise,
    replayed,
    sample,
    velocity,
)

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.samplers import METHODS, GuideSettings, flow_times


@pytest.mark.parametrize("eta", [0.0, "ddpm"])
@pytest.mark.parametrize("wish", [PINS, ROWS], ids=["pins", "rows"])
def test_ddnm_is_projflow_without_metric_guides_and_fresh_noise_bit_for_bit(wish, eta):
    same = {"metric": "euclidean", "guides": False, "noise": "implied", "eta": eta}
    same |= {"steps": flow_times(STEPS), "solver": "euler"}
    theirs = sample(wish, method="ddnm", eta=eta)
    np.testing.assert_array_equal(theirs.positions, sample(wish, **same).positions)
    assert theirs.residual < 1e-12
    if eta == 0:  # its default
        np.testing.assert_array_equal(theirs.positions, sample(wish, method="ddnm").positions)
        for other in ({"metric": "kinematic"}, {"noise": "original"}, {"eta": "paper"}):
            assert np.abs(theirs.positions - sample(wish, **same | other).positions).max() > 1e-3


def test_ddnm_projects_by_the_pseudo_inverse():
    A, y, _ = dense(ROWS)
    steps, _ = replayed(wish=ROWS, method="ddnm")
    for step in steps:
        x1_hat = step.x1_hat.numpy().ravel()
        expected = equations.ddnm(x1_hat, A, y)
        np.testing.assert_allclose(step.x1_projected.numpy().ravel(), expected, atol=1e-10)
        kept = x1_hat - np.linalg.pinv(A) @ (A @ x1_hat)
        np.testing.assert_allclose(kept + np.linalg.pinv(A) @ y, expected, atol=1e-10)


def pinned():
    """Mask of the pinned coordinates and their values, from the rows."""
    A, y, _ = dense(PINS)
    mask, values = A.any(0).reshape(SHAPE), (A.T @ y).reshape(SHAPE)
    return mask, values


def test_replacement_leads_known_coordinates_along_a_straight_line():
    mask, values = pinned()
    steps, states = replayed(method="replacement")
    x0 = next(fresh_noise())
    for step, x in zip(steps, states, strict=True):
        t = step.t_next
        np.testing.assert_allclose(x[mask], (t * values + (1 - t) * x0)[mask], atol=1e-12)
        followed = step.x_t + (t - step.t) * velocity(step.x_t, step.t)
        np.testing.assert_array_equal(x[~mask], followed.numpy()[~mask])
    np.testing.assert_array_equal(states[-1][mask], values[mask])


def test_replacement_with_fresh_noise_draws_it_in_every_step():
    mask, values = pinned()
    steps, states = replayed(method="replacement", noise="fresh")
    noise = fresh_noise()
    next(noise)
    for step, x, fresh in zip(steps, states, noise, strict=False):
        t = step.t_next
        np.testing.assert_allclose(x[mask], (t * values + (1 - t) * fresh)[mask], atol=1e-12)


def test_imputation_is_gmds_without_its_guidance():
    ours = sample(method="imputation").positions
    np.testing.assert_array_equal(ours, sample(method="gmd", pull=0.0, until=1.0).positions)
    mask, values = pinned()
    np.testing.assert_array_equal(ours[mask[0]], values[mask])
    steps, _ = replayed(method="imputation", until=0.5)
    for step in steps:
        x1 = np.where(mask, values, step.x1_hat) if step.t < 0.5 else step.x1_hat
        np.testing.assert_array_equal(step.x1_projected, x1)


@pytest.mark.parametrize("method", RIVALS)
def test_batches_seeds_and_precisions(method):
    first, again, other = (
        sample(method=method, seed=s, batch=2, dtype=torch.float32, steps=4).positions
        for s in (1, 1, 2)
    )
    assert first.shape == (2, *SHAPE[1:])
    assert first.dtype == np.float32
    assert np.isfinite(first).all()
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-3


@pytest.mark.parametrize("method", ["ddnm", *DOWNHILL])
def test_any_linear_wish_will_do(method):
    wish = pf.loop() & pf.lift(pf.Orthographic(), "left_wrist", [1, 2], [[0.1, 0.4], [0.2, 0.5]])
    options = {"iterations": 20, "rate": 0.3, "decorrelate": 0.0} if method == "dno" else {}
    free, led = sample(None), sample(wish, method=method, **options)
    assert wish.residual(led.positions) < wish.residual(free.positions)


@pytest.mark.parametrize("method", RIVALS)
def test_what_is_no_number_or_has_another_shape_is_refused(method):
    def refused(match, **options):
        with pytest.raises(ValueError, match=match):
            sample(method=method, **options)

    refused("sample: the prior returned", prior=lambda x, t, text=None: x[:, :, :1])
    refused("contradict each other", wish=pf.pin("head", [1, 1], [[0, 0, 0], [0, 0, 1]]))
    refused("frame 9 is outside 0..5", wish=pf.pin("head", 9, [0, 0, 0]))
    refused(f"sample: {method} has no metric and no guides", metric="euclidean")
    refused(f"sample: {method} has no metric and no guides", guides=GuideSettings())
    refused(f"{method}: callback is a function of a Step, not 'x'", callback="x")
    refused("takes wishes and no goal", goal=lambda x: x.sum((1, 2, 3)))
    with pytest.raises(ValueError, match="y is nan, not a number"):
        sample(pf.pin("head", 1, [0, float("nan"), 0]), method=method)
    assert sample(method=method, guides=False, steps=2).positions.shape == SHAPE[1:]


WRONG = [
    (
        {"method": "ddnm", "wish": SOFT},
        "sample: ddnm takes exact wishes, but row 9 (right_wrist, frame 2, x) is soft; leave std "
        "out, or take projflow",
    ),
    (
        {"method": "replacement", "wish": ROWS},
        "sample: replacement overwrites exact pins, but row 0 (-1 * head, frame 1, x + left_wrist, "
        "frame 1, x) is not one; take projflow or dps",
    ),
    (
        {"method": "imputation", "wish": pf.pin("head", 1, [0, 0, 0], std=0.1)},
        "sample: imputation overwrites exact pins, but row 0 (head, frame 1, x) is not one; take "
        "projflow or dps",
    ),
    (
        {"method": "replacement", "noise": "old"},
        "replacement: noise is 'original' or 'fresh', not 'old'",
    ),
    ({"method": "imputation", "until": 2}, "gmd: until is a flow time from 0 to 1, not 2"),
    ({"method": "ddnm", "eta": 2}, "projflow: eta is a share of 0 to 1, not 2"),
    ({"method": "flowdps", "step": 3}, "flowdps: step is a number from 0 to 2, not 3"),
    (
        {"method": "flowdps", "iterations": 0},
        "flowdps: iterations is a whole number of at least 1, not 0",
    ),
    ({"method": "pnp_flow", "alpha": -1}, "pnp_flow: alpha is a number of 0 or more, not -1"),
    (
        {"method": "pnp_flow", "draws": 1.5},
        "pnp_flow: draws is a whole number of at least 1, not 1.5",
    ),
    ({"method": "flowchef", "step": "1"}, "flowchef: step is a number from 0 to 2, not '1'"),
    (
        {"method": "dps", "scale": float("nan")},
        "dps: scale is a number of 0 or more, not nan",
    ),
    (
        {"method": "dps", "through": "both"},
        "dps: through is 'network' or 'endpoint', not 'both'",
    ),
    ({"method": "dno", "rate": True}, "dno: rate is a number of 0 or more, not True"),
    (
        {"method": "dno", "solver_steps": -1},
        "dno: solver_steps is a whole number of at least 1, not -1",
    ),
]


@pytest.mark.parametrize(("options", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_options_say_what_and_what_to_do(options, message):
    with pytest.raises(ValueError, match=".") as caught:
        sample(**options)
    assert str(caught.value) == message


def test_every_method_has_a_name():
    assert set(RIVALS) <= set(METHODS)
    with pytest.raises(ValueError, match="method is one of projflow, gmd, .*, condmdi, not 'ddmn'"):
        sample(method="ddmn")
