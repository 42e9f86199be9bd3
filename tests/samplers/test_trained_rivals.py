"""Rivals that were trained for control: what they tell the network, and what they do with it."""

import numpy as np
import pytest
import torch
from rival_flow import FRAMES, PINS, ROWS, SHAPE, STD, STEPS, velocity
from rival_flow import sample as sampled

from projflow_lite.samplers import METHODS, GuideSettings, condmdi, control_branch, flow_times
from projflow_lite.samplers.gmd_imputation import known_coordinates

TRAINED = ["control_branch", "condmdi"]
KNOWN = known_coordinates(PINS, FRAMES, torch.float64)


class Seeing:
    """The flow of known answers; its endpoint goes a given share of the way to what is known."""

    noise_std = STD

    def __init__(self, method, share=0.5):
        self.trained_for, self.share, self.told = method, share, []

    def __call__(self, x_t, t, text=None, observed=None):
        self.told.append((text, observed))
        v = velocity(x_t, t)
        if observed is None:
            return v
        x1_hat = x_t + (1 - t) * v
        each = observed.repeat(len(x_t) // len(observed.reshape(-1, *SHAPE[1:])), 1, 1, 1)
        miss = (each - x1_hat).nan_to_num(0.0)
        return v + self.share * miss / (1 - t)


def sample(method, share=0.5, **options):
    return sampled(method=method, prior=Seeing(method, share), **options)


def error(positions):
    return np.abs(positions - KNOWN.values.numpy())[..., KNOWN.mask.numpy()].mean()


@pytest.mark.parametrize("method", TRAINED)
def test_the_network_is_told_the_pins_in_every_step_and_nothing_else(method):
    prior = Seeing(method)
    sampled(method=method, prior=prior, prompt="a person walks", steps=4)
    A, y, _ = PINS.rows(FRAMES)
    expected = np.full(FRAMES * 66, np.nan)
    expected[A.toarray().argmax(1)] = y
    assert len(prior.told) == 4
    for text, observed in prior.told:
        assert text == "a person walks"
        np.testing.assert_array_equal(observed.numpy().ravel(), expected)


@pytest.mark.parametrize("method", TRAINED)
def test_a_network_that_does_not_look_gives_the_plain_sample(method):
    plain = sampled(None, steps=flow_times(STEPS), solver="euler").positions
    np.testing.assert_allclose(sample(method, 0.0).positions, plain, atol=1e-12)


@pytest.mark.parametrize("method", TRAINED)
def test_as_far_as_the_network_goes_so_far_goes_the_sample(method):
    """A network that goes all the way is exact: the last endpoint is the sample."""
    errors = [error(sample(method, share).positions) for share in (0.0, 0.3, 0.6, 1.0)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-12 < 0.01 < errors[0]


@pytest.mark.parametrize("method", TRAINED)
def test_the_loop_is_eulers(method):
    """One step at a time, with the velocity written out."""
    steps = []
    end = sample(method, 0.3, callback=steps.append).positions[None]
    states = [*(step.x_t.numpy() for step in steps[1:]), end]
    for step, after in zip(steps, states, strict=True):
        v = Seeing(method, 0.3)(step.x_t, step.t, None, KNOWN.observed).numpy()
        x = step.x_t.numpy()
        np.testing.assert_allclose(step.x1_hat, x + (1 - step.t) * v, atol=1e-12)
        np.testing.assert_allclose(after, x + (step.t_next - step.t) * v, atol=1e-12)


def test_imputation_on_top_is_exact_at_the_end_or_stops_before():
    mask, values = KNOWN.mask.numpy(), KNOWN.values.numpy()
    whole = sample("condmdi", 0.3, until=1.0).positions
    np.testing.assert_array_equal(whole[mask], values[mask])
    steps = []
    half = sample("condmdi", 0.3, until=0.5, callback=steps.append).positions
    for step in steps:
        x1_hat = step.x1_hat.numpy()[0]
        x1 = np.where(mask, values, x1_hat) if step.t < 0.5 else x1_hat
        np.testing.assert_array_equal(step.x1_projected.numpy()[0], x1)
    assert 0 < error(half) < error(sample("condmdi", 0.3).positions)


@pytest.mark.parametrize("method", TRAINED)
def test_guidance_doubles_the_batch_and_tells_both_halves(method):
    """The prompt changes nothing here, so no guidance does; each motion keeps its own targets."""
    plain = sample(method, batch=3, prompt="a person walks").positions
    led = sample(method, batch=3, prompt="a person walks", guidance=2.5).positions
    np.testing.assert_allclose(led, plain, atol=1e-12)


def test_every_motion_may_have_targets_of_its_own():
    x0 = STD * torch.randn(2, *SHAPE[1:], dtype=torch.float64)
    other = known_coordinates(PINS, FRAMES, torch.float64)
    other.values = torch.stack([KNOWN.values, KNOWN.values + 1])
    times = [0.0, 0.5, 1.0]
    for name, sampler in (("control_branch", control_branch), ("condmdi", condmdi)):
        both = sampler(Seeing(name, 1.0), other, x0, times)
        difference = (both - other.values)[:, KNOWN.mask].abs().max()
        assert difference < 1e-12


@pytest.mark.parametrize("method", TRAINED)
def test_batches_seeds_and_precisions(method):
    options = {"batch": 2, "dtype": torch.float32, "steps": 4}
    first, again, other = (sample(method, seed=s, **options).positions for s in (1, 1, 2))
    assert first.shape == (2, *SHAPE[1:])
    assert first.dtype == np.float32
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-3


@pytest.mark.parametrize("method", TRAINED)
def test_what_it_cannot_do_is_refused(method):
    def refused(match, **options):
        with pytest.raises(ValueError, match=match):
            sampled(method=method, **({"prior": Seeing(method)} | options))

    loader = METHODS[method].model
    match = rf"{method} needs a prior that was trained to see keyframes; take {loader}\(\) from "
    refused(match, prior=velocity)
    refused(match, prior=Seeing("another"))
    refused(f"{method} overwrites exact pins, but row 0", wish=ROWS)
    refused(f"{method} has no metric and no guides", metric="euclidean")
    refused(f"{method} has no metric and no guides", guides=GuideSettings())
    refused(f"{method}: callback is a function of a Step, not 'x'", callback="x")
    refused("takes wishes and no goal", goal=lambda x: x.sum((1, 2, 3)))
    if method == "condmdi":
        refused("condmdi: until is a number from 0 to 1, not 2", until=2)


def test_a_prior_that_sees_keyframes_is_a_prior_for_every_other_method():
    exact = sampled(prior=Seeing("condmdi"), method="projflow")
    assert exact.residual < 1e-12
    free = sampled(None, prior=Seeing("condmdi")).positions
    np.testing.assert_array_equal(free, sampled(None).positions)
