"""Answers to ProjFlow eq. 18, variance from trust, and eq. 46, trust from variance."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


@wrong("projflow:18")
def prior_variance_forgotten(pi, r):
    """r is forgotten: that holds in the Euclidean metric only."""
    return (1 - pi) / pi


@wrong("projflow:18")
def fraction_upside_down(pi, r):
    """The fraction is upside down: trust over distrust, so that full trust gives infinity."""
    return r * pi / (1 - pi)


@wrong("projflow:18")
def trust_missing_below_the_line(pi, r):
    """The trust is missing below the line."""
    return r * (1 - pi)


@wrong("projflow:18")
def one_missing(pi, r):
    """The minus one is missing: a fully trusted guide would not be hard."""
    return r / pi


@wrong("projflow:18")
def bracket_missing(pi, r):
    """A bracket is missing: r multiplies only the first term, the 1 is subtracted from all."""
    return r * 1 / pi - 1


@wrong("projflow:18")
def prior_variance_below_the_line(pi, r):
    """r is below the line where it should be above."""
    return (1 - pi) / (pi * r)


@wrong("projflow:18")
def distrust_added(pi, r):
    """1 + pi stands where 1 - pi belongs."""
    return r * (1 + pi) / pi


@wrong("projflow:18")
def standard_deviation(pi, r):
    """This is the standard deviation; the variance is its square."""
    return np.sqrt(r * (1 - pi) / pi)


@wrong("projflow:18")
def floor_under_the_variance(pi, r):
    """A small number is the least variance: a fully trusted guide is then not hard."""
    return np.maximum(r * (1 - pi) / pi, 1e-3)


@wrong("projflow:18")
def x_axis_for_all(pi, r):
    """The first entry of the last axis is read for all: y and z get the variance of x."""
    return np.broadcast_to((r * (1 - pi) / pi)[..., :1], r.shape)


@wrong("projflow:18")
def overwrites_the_trust(pi, r):
    """The result is written over the argument pi, which the caller still needs."""
    pi[...] = r * (1 - pi) / pi
    return pi


@right("projflow:18")
def reciprocal_form(pi, r):
    """The form of eq. 47."""
    return r * (1 / pi - 1)


@right("projflow:18")
def total_less_prior(pi, r):
    """The total variance that makes r the wanted share, less r itself."""
    return r / pi - r


@right("projflow:18")
def entry_by_entry(pi, r):
    """A loop over all entries, returned as nested lists."""
    pairs = zip(pi.ravel(), r.ravel(), strict=True)
    return np.array([(b - a * b) / a for a, b in pairs]).reshape(pi.shape).tolist()


@wrong("projflow:46")
def euclidean_weight(variance, r):
    """r is taken to be 1: that is the weight in the Euclidean metric, eq. 42."""
    return 1 / (1 + variance)


@wrong("projflow:46")
def share_of_the_measurement(variance, r):
    """This is the share of the measurement's variance; the more certain it is, the less it gets."""
    return variance / (r + variance)


@wrong("projflow:46")
def odds_instead_of_share(variance, r):
    """r is divided by the variance alone, not by the sum of both: hard rows get infinity."""
    return r / variance


@wrong("projflow:46")
def share_upside_down(variance, r):
    """The fraction is upside down: shares cannot exceed 1."""
    return (r + variance) / r


@wrong("projflow:46")
def one_above_the_line(variance, r):
    """There is a 1 above the line where r belongs."""
    return 1 / (r + variance)


@wrong("projflow:46")
def standard_deviations_added(variance, r):
    """The root of the variance is used; variances add up, standard deviations do not."""
    return r / (r + np.sqrt(variance))


@wrong("projflow:46")
def variances_squared(variance, r):
    """Both variances are squared as if they were standard deviations."""
    return r**2 / (r**2 + variance**2)


@wrong("projflow:46")
def variance_subtracted(variance, r):
    """The variances are subtracted below the line; they add up."""
    return r / (r - variance)


@wrong("projflow:46")
def exponential_share(variance, r):
    """An exponential stands in for the share: the same at zero variance, different elsewhere."""
    return np.exp(-variance / r)


@wrong("projflow:46")
def clipped_share(variance, r):
    """The trust is clipped to at least 0.02; that belongs to eq. 52, not here."""
    return np.clip(r / (r + variance), 0.02, 1)


@wrong("projflow:46")
def share_of_the_x_axis(variance, r):
    """The first entry of the last axis is read for all: y and z get the trust of x."""
    return np.broadcast_to((r / (r + variance))[..., :1], r.shape)


@wrong("projflow:46")
def overwrites_the_variance(variance, r):
    """The result is written over the argument variance, which the caller still needs."""
    variance[...] = r / (r + variance)
    return variance


@right("projflow:46")
def share_in_units_of_r(variance, r):
    """The Euclidean weight of a variance measured in units of r."""
    return 1 / (1 + variance / r)


@right("projflow:46")
def what_the_measurement_leaves(variance, r):
    """1 minus the share of the measurement."""
    return 1 - variance / (r + variance)


@right("projflow:46")
def share_entry_by_entry(variance, r):
    """A function of two numbers, made to work on arrays."""
    return np.vectorize(lambda own, prior: prior / (prior + own))(variance, r)
