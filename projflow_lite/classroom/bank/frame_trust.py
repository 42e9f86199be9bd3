"""Answers to ProjFlow eq. 15, the trust in the guides of a frame."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


def _tau(t, tau_min):
    """The decay of eq. 16."""
    return tau_min + (1 - tau_min) * (1 - t)


@wrong("projflow:15")
def mean_for_median(s, t, c0, lambda_s, p, tau_min):
    """The mean stands in for the median: one jump would change the trust everywhere."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (s / np.mean(s)) ** p)


@wrong("projflow:15")
def lower_median(s, t, c0, lambda_s, p, tau_min):
    """The median is the lower of the two middle values, as torch gives it; eq. 15 means halfway."""
    s_med = np.sort(s)[(len(s) - 1) // 2]
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (s / s_med) ** p)


@wrong("projflow:15")
def unsorted_median(s, t, c0, lambda_s, p, tau_min):
    """The frame in the middle of the motion stands in for the median; sort the values first."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (s / s[len(s) // 2]) ** p)


@wrong("projflow:15")
def maximum_for_median(s, t, c0, lambda_s, p, tau_min):
    """The largest curvature stands in for the median."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (s / np.max(s)) ** p)


@wrong("projflow:15")
def median_forgotten(s, t, c0, lambda_s, p, tau_min):
    """The curvature is not divided by its median."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * s**p)


@wrong("projflow:15")
def clipped_to_one(s, t, c0, lambda_s, p, tau_min):
    """The trust is clipped to 1; eq. 15 is not clipped."""
    return np.minimum(_tau(t, tau_min) * c0 / (1 + lambda_s * (s / np.median(s)) ** p), 1)


@wrong("projflow:15")
def decay_forgotten(s, t, c0, lambda_s, p, tau_min):
    """The decay in time, tau, is forgotten."""
    return c0 / (1 + lambda_s * (s / np.median(s)) ** p)


@wrong("projflow:15")
def time_for_decay(s, t, c0, lambda_s, p, tau_min):
    """The time itself stands in for the decay, so that trust grows."""
    return t * c0 / (1 + lambda_s * (s / np.median(s)) ** p)


@wrong("projflow:15")
def strength_inside_the_power(s, t, c0, lambda_s, p, tau_min):
    """lambda_s is raised to the power as well; the power acts on the ratio alone."""
    return _tau(t, tau_min) * c0 / (1 + (lambda_s * s / np.median(s)) ** p)


@wrong("projflow:15")
def power_around_everything(s, t, c0, lambda_s, p, tau_min):
    """The power is taken of the whole denominator; it acts on the ratio alone."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * s / np.median(s)) ** p


@wrong("projflow:15")
def power_forgotten(s, t, c0, lambda_s, p, tau_min):
    """The power p is forgotten."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * s / np.median(s))


@wrong("projflow:15")
def always_squared(s, t, c0, lambda_s, p, tau_min):
    """The ratio is always squared, whatever p is."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (s / np.median(s)) ** 2)


@wrong("projflow:15")
def one_forgotten(s, t, c0, lambda_s, p, tau_min):
    """The 1 below the line is forgotten: a frame that does not bend would get infinity."""
    return _tau(t, tau_min) * c0 / (lambda_s * (s / np.median(s)) ** p)


@wrong("projflow:15")
def ratio_upside_down(s, t, c0, lambda_s, p, tau_min):
    """The ratio is upside down: frames that bend get more trust, not less."""
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (np.median(s) / s) ** p)


@wrong("projflow:15")
def exponential_penalty(s, t, c0, lambda_s, p, tau_min):
    """The penalty is an exponential; in eq. 15 it stands below the line."""
    return _tau(t, tau_min) * c0 * np.exp(-lambda_s * (s / np.median(s)) ** p)


@wrong("projflow:15")
def strength_forgotten(s, t, c0, lambda_s, p, tau_min):
    """c0 is forgotten."""
    return _tau(t, tau_min) / (1 + lambda_s * (s / np.median(s)) ** p)


@wrong("projflow:15")
def sorted_in_place(s, t, c0, lambda_s, p, tau_min):
    """The argument s is sorted in place to find its median: the frames lose their order."""
    s.sort()
    s_med = (s[(len(s) - 1) // 2] + s[len(s) // 2]) / 2
    return _tau(t, tau_min) * c0 / (1 + lambda_s * (s / s_med) ** p)


@right("projflow:15")
def frame_by_frame(s, t, c0, lambda_s, p, tau_min):
    """A loop over the frames with the median of the standard library's kind."""
    ordered = sorted(s)
    s_med = 0.5 * (ordered[(len(s) - 1) // 2] + ordered[len(s) // 2])
    tau = 1 - (1 - tau_min) * t
    return [tau * c0 / (1 + lambda_s * (s_n / s_med) ** p) for s_n in s]


@right("projflow:15")
def without_a_ratio(s, t, c0, lambda_s, p, tau_min):
    """Multiplied out: the median's power above and below the line."""
    unit = np.quantile(s, 0.5) ** p
    return (tau_min * t + 1 - t) * c0 * unit / (unit + lambda_s * s**p)
