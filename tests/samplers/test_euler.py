"""Steps without a wish, against a flow whose solution is known."""

import itertools

import numpy as np
import pytest
import torch
from scipy import integrate

from projflow_lite.constraints import pin
from projflow_lite.samplers import ProjectionStep, euler, projflow
from projflow_lite.samplers.euler import lead, multistep

MEAN, STD = 0.7, 0.3


def gaussian_flow(x_t, t, text=None):
    """Velocity of the flow from N(0, 1) to N(MEAN, STD^2)."""
    gain = STD**2 * t / (t**2 * STD**2 + (1 - t) ** 2)
    return (MEAN + gain * (x_t - t * MEAN) - x_t) / (1 - t)


def error(solve, steps):
    """How far the end is from the exact one: a Gaussian flow only moves and scales."""
    x0 = torch.randn(4, 3, 22, 3, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    times = [1 - (1 - k / steps) ** 2 for k in range(steps + 1)]
    return float((euler(solve(times), x0, times) - (MEAN + STD * x0)).abs().max())


def test_euler_is_of_first_order_and_multistep_of_second():
    first = [error(lambda times: gaussian_flow, steps) for steps in (40, 80, 160)]
    second = [
        error(lambda times: multistep(gaussian_flow, times), steps) for steps in (40, 80, 160)
    ]
    for coarse, fine in itertools.pairwise(first):
        assert coarse / fine == pytest.approx(2, rel=0.1)
    for coarse, fine in itertools.pairwise(second):
        assert coarse / fine > 3.5
    assert second[0] < first[0] / 10


@pytest.mark.parametrize(("t", "t_next"), [(0.0, 0.3), (0.4, 0.5), (0.9, 0.999)])
def test_the_lead_is_what_the_integral_says(t, t_next):
    """x' = (x1(s) - x) / (1 - s) by variation of constants, with x1(s) = s - t."""
    integral, _ = integrate.quad(lambda s: (s - t) / (1 - s) ** 2, t, t_next)
    resting = 1 - (1 - t_next) / (1 - t)  # what an endpoint of 1 that rests would give
    assert lead(t, t_next) == pytest.approx((1 - t_next) * integral / resting, rel=1e-9)


def test_one_step_is_euler_s_and_the_last_one_ends_in_the_network_s_endpoint():
    x0 = torch.randn(1, 3, 22, 3)
    times = [0.0, 1.0]
    assert torch.equal(
        euler(multistep(gaussian_flow, times), x0, times), euler(gaussian_flow, x0, times)
    )
    seen = []

    def watched(x_t, t, text=None):
        v = gaussian_flow(x_t, t)
        seen.append(x_t + (1 - t) * v)
        return v

    times = [0.0, 0.3, 0.7, 1.0]
    end = euler(multistep(watched, times), x0, times)
    assert len(seen) == 3  # one call a step
    torch.testing.assert_close(end, seen[-1])


def test_a_field_forgets_the_sample_before():
    times = [0.0, 0.2, 0.5, 1.0]
    field, x0 = multistep(gaussian_flow, times), torch.randn(2, 3, 22, 3)
    first = euler(field, x0, times)
    euler(field, torch.randn(5, 3, 22, 3), times)
    assert torch.equal(euler(field, x0, times), first)


def test_a_time_that_is_no_step_is_refused():
    with pytest.raises(ValueError, match="none of the times"):
        multistep(gaussian_flow, [0.0, 0.5, 1.0])(torch.zeros(1, 3, 22, 3), 0.4)


def test_a_wish_is_met_exactly_between_steps_of_second_order():
    target = np.array([0.1, 1.2, 0.3], dtype=np.float32)
    project = ProjectionStep(pin("left_wrist", 4, target), 9)
    times = [0.0, 0.2, 0.5, 0.8, 1.0]
    x = projflow(
        multistep(gaussian_flow, times), project, torch.randn(2, 9, 22, 3), times,
        torch.Generator().manual_seed(0), eta=0.0,
    )  # fmt: skip
    np.testing.assert_array_equal(x[:, 4, 20].numpy(), np.stack([target] * 2))
