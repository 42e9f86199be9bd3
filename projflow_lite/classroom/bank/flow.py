"""Answers to ProjFlow eq. 2, the straight path, and eq. 5, the predicted endpoint."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


@wrong("projflow:2")
def ends_swapped(x0, x1, t):
    """Noise and data have changed places: at t = 0 the data comes out."""
    return t * x0 + (1 - t) * x1


@wrong("projflow:2")
def roots_as_in_diffusion(x0, x1, t):
    """The weights have roots, as in a diffusion model; the path of flow matching has none."""
    return np.sqrt(1 - t) * x0 + np.sqrt(t) * x1


@wrong("projflow:2")
def circular_path(x0, x1, t):
    """The weights are a cosine and a sine: that path is an arc, not a straight line."""
    return np.cos(np.pi * t / 2) * x0 + np.sin(np.pi * t / 2) * x1


@wrong("projflow:2")
def noise_never_leaves(x0, x1, t):
    """Data is added but no noise is taken away: the weights do not add up to 1."""
    return x0 + t * x1


@wrong("projflow:2")
def difference_with_wrong_sign(x0, x1, t):
    """The path is started at x0, but along x1 + x0 where the difference x1 - x0 belongs."""
    return x0 + t * (x1 + x0)


@wrong("projflow:2")
def backwards(x0, x1, t):
    """The path leaves x0 in the direction x0 - x1, away from the data."""
    return x0 + t * (x0 - x1)


@wrong("projflow:2")
def velocity_instead_of_position(x0, x1, t):
    """This is the velocity of the path, not the point on it."""
    return x1 - x0


@wrong("projflow:2")
def halfway_always(x0, x1, t):
    """The time is ignored: the point is halfway whatever t is."""
    return (x0 + x1) / 2


@wrong("projflow:2")
def time_cut_to_whole_number(x0, x1, t):
    """The time is made a whole number and is 0 until the very end."""
    return (1 - int(t)) * x0 + int(t) * x1


@wrong("projflow:2")
def result_stored_like_the_input(x0, x1, t):
    """The result is stored in the number type of x0, and integers lose what is after the point."""
    result = np.empty_like(x0)
    result[...] = (1 - t) * x0 + t * x1
    return result


@wrong("projflow:2")
def overwrites_the_noise(x0, x1, t):
    """The result is written over the argument x0, which the caller still needs."""
    if x0.dtype.kind != "f":
        return (1 - t) * x0 + t * x1
    x0 *= 1 - t
    x0 += t * x1
    return x0


@wrong("projflow:2")
def flattened(x0, x1, t):
    """The numbers are right but come back as one long vector; the shape of x0 is lost."""
    return ((1 - t) * x0 + t * x1).ravel()


@right("projflow:2")
def from_the_start(x0, x1, t):
    """Start at the noise and walk the share t of the way."""
    return x0 + t * (x1 - x0)


@right("projflow:2")
def from_the_end(x0, x1, t):
    """Start at the data and walk back."""
    return x1 - (1 - t) * (x1 - x0)


@right("projflow:2")
def coordinate_by_coordinate(x0, x1, t):
    """A loop over all coordinates, returned as nested lists."""
    pairs = zip(x0.ravel().tolist(), x1.ravel().tolist(), strict=True)
    return np.reshape([(1 - t) * a + t * b for a, b in pairs], x0.shape).tolist()


@wrong("projflow:5")
def time_passed_instead_of_time_left(x_t, v, t):
    """The velocity is followed for the time that has passed, t, where the time left belongs."""
    return x_t + t * v


@wrong("projflow:5")
def towards_the_noise(x_t, v, t):
    """The velocity is subtracted: that leads away from the data."""
    return x_t - (1 - t) * v


@wrong("projflow:5")
def implied_noise_instead(x_t, v, t):
    """This is where the path started, the implied noise, not where it ends."""
    return x_t - t * v


@wrong("projflow:5")
def whole_unit_of_time(x_t, v, t):
    """The velocity is followed for a whole unit of time, however much of it has passed."""
    return x_t + v


@wrong("projflow:5")
def velocity_taken_for_the_endpoint(x_t, v, t):
    """State and velocity are averaged, as if the velocity were a point of the path."""
    return t * x_t + (1 - t) * v


@wrong("projflow:5")
def state_shrunk(x_t, v, t):
    """State and velocity are both multiplied by the time left; the state needs no weight."""
    return (1 - t) * (x_t + v)


@wrong("projflow:5")
def root_of_time_left(x_t, v, t):
    """The time left stands under a root, as the noise of a diffusion model would."""
    return x_t + np.sqrt(1 - t) * v


@wrong("projflow:5")
def one_step_of_fifty(x_t, v, t):
    """This is a single Euler step of length 1/50, not the rest of the path."""
    return x_t + v / 50


@wrong("projflow:5")
def noise_predictor(x_t, v, t):
    """v is treated as a prediction of the noise, as in a diffusion model; it is a velocity."""
    return (x_t - (1 - t) * v) / t


@wrong("projflow:5")
def accelerated(x_t, v, t):
    """Half of the time left squared belongs to an acceleration; v is a velocity."""
    return x_t + (1 - t) ** 2 / 2 * v


@wrong("projflow:5")
def overwrites_the_state(x_t, v, t):
    """The result is written over the argument x_t, which the caller still needs."""
    if x_t.dtype.kind != "f":
        return x_t + (1 - t) * v
    x_t += (1 - t) * v
    return x_t


@wrong("projflow:5")
def endpoint_stored_like_the_input(x_t, v, t):
    """The result is stored in the number type of x_t, and integers lose what is after the point."""
    result = np.zeros_like(x_t)
    result[...] = x_t + (1 - t) * v
    return result


@right("projflow:5")
def noise_plus_velocity(x_t, v, t):
    """Go back to the implied noise, then one whole unit of time forward."""
    return (x_t - t * v) + v


@right("projflow:5")
def many_small_steps(x_t, v, t):
    """Four Euler steps with the same velocity."""
    for _ in range(4):
        x_t = x_t + (1 - t) / 4 * v
    return x_t


@right("projflow:5")
def sum_of_two_weights(x_t, v, t):
    """State and velocity stacked and contracted with their weights."""
    return np.tensordot([1.0, 1.0 - t], np.stack([x_t, v]), axes=1)
