"""Answers to ProjFlow eq. 9, partly fresh noise, and eq. 10, the next state."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


@wrong("projflow:9")
def no_roots(x0, eps, eta):
    """The weights have no roots: the variance of the mixture falls below 1."""
    return (1 - eta) * x0 + eta * eps


@wrong("projflow:9")
def shares_swapped(x0, eps, eta):
    """Old and fresh noise have changed places: eta = 0 must keep x0."""
    return np.sqrt(eta) * x0 + np.sqrt(1 - eta) * eps


@wrong("projflow:9")
def root_of_the_fresh_part_only(x0, eps, eta):
    """The weight of the old noise lacks its root."""
    return (1 - eta) * x0 + np.sqrt(eta) * eps


@wrong("projflow:9")
def root_of_the_old_part_only(x0, eps, eta):
    """The weight of the fresh noise lacks its root."""
    return np.sqrt(1 - eta) * x0 + eta * eps


@wrong("projflow:9")
def eta_taken_for_a_standard_deviation(x0, eps, eta):
    """eta is treated as a standard deviation; it is a share of the variance."""
    return np.sqrt(1 - eta**2) * x0 + eta * eps


@wrong("projflow:9")
def fresh_noise_added_on_top(x0, eps, eta):
    """Fresh noise is added but no old noise is taken away: the variance grows above 1."""
    return x0 + np.sqrt(eta) * eps


@wrong("projflow:9")
def squares_for_roots(x0, eps, eta):
    """The weights are squared where their roots belong."""
    return (1 - eta) ** 2 * x0 + eta**2 * eps


@wrong("projflow:9")
def fresh_noise_subtracted(x0, eps, eta):
    """The fresh noise has a minus sign; that is as random, but not what eq. 9 computes."""
    return np.sqrt(1 - eta) * x0 - np.sqrt(eta) * eps


@wrong("projflow:9")
def noise_of_its_own(x0, eps, eta):
    """The function draws noise of its own and ignores the argument eps."""
    own = np.random.default_rng(0).standard_normal(x0.shape)
    return np.sqrt(1 - eta) * x0 + np.sqrt(eta) * own


@wrong("projflow:9")
def one_root_minus_the_other(x0, eps, eta):
    """The old noise gets one minus the root of eta; the root belongs around all of 1 - eta."""
    return (1 - np.sqrt(eta)) * x0 + np.sqrt(eta) * eps


@wrong("projflow:9")
def overwrites_the_old_noise(x0, eps, eta):
    """The result is written over the argument x0, which the caller still needs."""
    if x0.dtype.kind != "f":
        return np.sqrt(1 - eta) * x0 + np.sqrt(eta) * eps
    x0 *= np.sqrt(1 - eta)
    x0 += np.sqrt(eta) * eps
    return x0


@right("projflow:9")
def as_an_angle(x0, eps, eta):
    """The two weights as cosine and sine of one angle."""
    angle = np.arcsin(np.sqrt(eta))
    return np.cos(angle) * x0 + np.sin(angle) * eps


@right("projflow:9")
def powers_of_one_half(x0, eps, eta):
    """Roots as powers, in plain Python for the weights."""
    return x0 * (1.0 - eta) ** 0.5 + eps * eta**0.5


@right("projflow:9")
def stacked_noise(x0, eps, eta):
    """Both noises stacked and contracted with their weights."""
    return np.einsum("k,k...->...", np.sqrt([1 - eta, eta]), np.stack([x0, eps]))


@wrong("projflow:10")
def endpoint_and_noise_swapped(x1, noise, t_next):
    """Endpoint and noise have changed places: the last step would end in pure noise."""
    return (1 - t_next) * x1 + t_next * noise


@wrong("projflow:10")
def roots_in_recomposition(x1, noise, t_next):
    """The weights have roots; those belong to the mixing of noise, eq. 9."""
    return np.sqrt(t_next) * x1 + np.sqrt(1 - t_next) * noise


@wrong("projflow:10")
def variance_kept(x1, noise, t_next):
    """The noise gets the weight that keeps a variance, not what the time leaves of 1."""
    return t_next * x1 + np.sqrt(1 - t_next**2) * noise


@wrong("projflow:10")
def noise_forgotten(x1, noise, t_next):
    """The noise is left out."""
    return t_next * x1


@wrong("projflow:10")
def noise_in_full(x1, noise, t_next):
    """The noise keeps its full weight until the end; it must fade to nothing at t = 1."""
    return t_next * x1 + noise


@wrong("projflow:10")
def endpoint_in_full(x1, noise, t_next):
    """The endpoint has its full weight from the start; it must grow from nothing."""
    return x1 + (1 - t_next) * noise


@wrong("projflow:10")
def noise_subtracted(x1, noise, t_next):
    """The noise is subtracted where it should be added."""
    return t_next * x1 - (1 - t_next) * noise


@wrong("projflow:10")
def endpoint_only(x1, noise, t_next):
    """The endpoint comes back as it is; it has to be put back on a path."""
    return 1.0 * x1


@wrong("projflow:10")
def noise_taken_for_the_velocity(x1, noise, t_next):
    """The noise is treated as a velocity and followed for the time that is left."""
    return t_next * (x1 + (1 - t_next) * noise)


@wrong("projflow:10")
def state_stored_like_the_input(x1, noise, t_next):
    """The result is stored in the number type of x1, and integers lose what is after the point."""
    result = np.empty_like(x1)
    result[...] = t_next * x1 + (1 - t_next) * noise
    return result


@wrong("projflow:10")
def overwrites_the_endpoint(x1, noise, t_next):
    """The result is written over the argument x1, which the caller still needs."""
    if x1.dtype.kind != "f":
        return t_next * x1 + (1 - t_next) * noise
    x1 *= t_next
    x1 += (1 - t_next) * noise
    return x1


@right("projflow:10")
def walk_from_the_noise(x1, noise, t_next):
    """Start at the noise and walk towards the endpoint."""
    return noise + t_next * (x1 - noise)


@right("projflow:10")
def average_of_two(x1, noise, t_next):
    """A weighted average along a new axis."""
    return np.average([x1, noise], axis=0, weights=[t_next, 1 - t_next])


@right("projflow:10")
def row_by_row(x1, noise, t_next):
    """A loop along the first axis."""
    rows = [t_next * a + (1 - t_next) * b for a, b in zip(x1, noise, strict=True)]
    return np.array(rows)
