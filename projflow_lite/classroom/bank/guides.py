"""Answers to ProjFlow eq. 14, the reach of the guides, and eq. 16, their fading."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


@wrong("projflow:14")
def radii_swapped(t, l_min, l_max):
    """The radii have changed places: the guides' reach grows with time."""
    return (1 - np.asarray(t)) * l_min + np.asarray(t) * l_max


@wrong("projflow:14")
def rounded_to_frames(t, l_min, l_max):
    """The radius is rounded to whole frames; it may have any value."""
    return np.round((1 - np.asarray(t)) * l_max + np.asarray(t) * l_min)


@wrong("projflow:14")
def geometric(t, l_min, l_max):
    """The radius shrinks by factors, a geometric average; eq. 14 is a straight line."""
    return l_max ** (1 - np.asarray(t)) * l_min ** np.asarray(t)


@wrong("projflow:14")
def shrinks_by_the_small_radius(t, l_min, l_max):
    """The radius shrinks by t l_min; it should shrink by t (l_max - l_min)."""
    return l_max - np.asarray(t) * l_min


@wrong("projflow:14")
def small_radius_on_top(t, l_min, l_max):
    """The smaller radius is added in full at all times: at the start the reach is too far."""
    return (1 - np.asarray(t)) * l_max + l_min


@wrong("projflow:14")
def small_radius_forgotten(t, l_min, l_max):
    """l_min is forgotten: the guides would vanish."""
    return (1 - np.asarray(t)) * l_max


@wrong("projflow:14")
def difference_only(t, l_min, l_max):
    """This is the part that shrinks; the part that stays, l_min, is missing."""
    return (1 - np.asarray(t)) * (l_max - l_min)


@wrong("projflow:14")
def floor_instead_of_line(t, l_min, l_max):
    """l_min is a floor under a line that goes to zero; it should be the line's end."""
    return np.maximum((1 - np.asarray(t)) * l_max, l_min)


@wrong("projflow:14")
def quadratic(t, l_min, l_max):
    """The time left is squared: the reach shrinks too fast at first."""
    return l_min + (l_max - l_min) * (1 - np.asarray(t)) ** 2


@wrong("projflow:14")
def one_time_only(t, l_min, l_max):
    """This works for a single time only, not for many at once."""
    return (1 - float(t)) * l_max + float(t) * l_min


@wrong("projflow:14")
def cosine_schedule(t, l_min, l_max):
    """The radius follows a cosine, as some noise schedules do; eq. 14 is a straight line."""
    return l_min + (l_max - l_min) * (1 + np.cos(np.pi * np.asarray(t))) / 2


@right("projflow:14")
def from_the_large_radius(t, l_min, l_max):
    """Start at the larger radius and lose a share of the difference."""
    return l_max - np.asarray(t) * (l_max - l_min)


@right("projflow:14")
def by_interpolation(t, l_min, l_max):
    """Linear interpolation of a table of two times."""
    return np.interp(t, [0, 1], [l_max, l_min])


@right("projflow:14")
def time_by_time(t, l_min, l_max):
    """A function of one time, made to work on arrays."""
    return np.vectorize(lambda now: l_min + (1 - now) * (l_max - l_min))(t)


@wrong("projflow:16")
def fades_from_above_one(t, tau_min):
    """The part that stays is added to a part that fades from 1: the factor starts above 1."""
    return tau_min + (1 - np.asarray(t))


@wrong("projflow:16")
def grows_with_time(t, tau_min):
    """The factor grows with time; it should fade."""
    return tau_min + (1 - tau_min) * np.asarray(t)


@wrong("projflow:16")
def floor_under_a_line(t, tau_min):
    """tau_min is a floor under a line that goes to zero; it should be the line's end."""
    return np.maximum(tau_min, 1 - np.asarray(t))


@wrong("projflow:16")
def part_that_stays_forgotten(t, tau_min):
    """This is the part that fades; the part that stays, tau_min, is missing."""
    return (1 - tau_min) * (1 - np.asarray(t))


@wrong("projflow:16")
def fades_from_the_minimum(t, tau_min):
    """The factor starts at tau_min and fades to nothing; it should start at 1."""
    return tau_min * (1 - np.asarray(t))


@wrong("projflow:16")
def fades_to_nothing(t, tau_min):
    """tau_min is forgotten: the factor fades to nothing."""
    return 1 - np.asarray(t)


@wrong("projflow:16")
def fades_by_factors(t, tau_min):
    """The factor fades exponentially, with the right ends; eq. 16 is a straight line."""
    return tau_min ** np.asarray(t)


@wrong("projflow:16")
def loses_only_the_minimum(t, tau_min):
    """The factor loses tau_min until the end; it should lose all but tau_min."""
    return 1 - tau_min * np.asarray(t)


@wrong("projflow:16")
def fades_quadratically(t, tau_min):
    """The time left is squared: the factor fades too fast at first."""
    return tau_min + (1 - tau_min) * (1 - np.asarray(t)) ** 2


@wrong("projflow:16")
def exponential_without_end(t, tau_min):
    """The fading part is an exponential, which never reaches its end."""
    return tau_min + (1 - tau_min) * np.exp(-np.asarray(t))


@wrong("projflow:16")
def single_time_only(t, tau_min):
    """This works for a single time only, not for many at once."""
    return tau_min + (1 - tau_min) * (1 - float(t))


@right("projflow:16")
def what_is_lost(t, tau_min):
    """1 less what is lost by now."""
    return 1 - (1 - tau_min) * np.asarray(t)


@right("projflow:16")
def average_of_both_ends(t, tau_min):
    """The weighted average of the start, 1, and the end."""
    return (1 - np.asarray(t)) * 1 + np.asarray(t) * tau_min


@right("projflow:16")
def table_of_two_times(t, tau_min):
    """Linear interpolation of a table of two times."""
    return np.interp(t, [0, 1], [1, tau_min])
