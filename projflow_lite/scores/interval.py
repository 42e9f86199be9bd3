"""How sure is a mean of a few repetitions?"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from projflow_lite.skeleton import number_array


class Interval(NamedTuple):
    """A mean, and how far its confidence interval reaches to either side."""

    mean: float
    half_width: float


def interval(values: ArrayLike, confidence: float = 0.95) -> Interval:
    r"""Mean of repeated measurements and half the width of its confidence interval.

    .. math:: \bar v \pm t_{n-1} \, s / \sqrt{n}

    Few repetitions need Student's :math:`t`: with three of them it is 4.3, not 1.96.

    Args:
        values: ``(repetitions,)``; one repetition gives a half width of NaN.
        confidence: of the interval, between 0 and 1.

    Raises:
        ValueError: if there is no value, more than one axis, or no such confidence.
    """
    v = number_array(values, "interval: values").astype(float)
    if v.ndim != 1 or len(v) == 0:
        raise ValueError(f"interval: one number for each repetition, not shape {v.shape}")
    if not np.isfinite(v).all():
        raise ValueError("interval: a measurement is not finite")
    if not 0 < confidence < 1:
        raise ValueError(f"interval: confidence is between 0 and 1, not {confidence!r}")
    if len(v) == 1:
        return Interval(float(v[0]), float("nan"))
    t = stats.t.ppf((1 + confidence) / 2, len(v) - 1)
    return Interval(float(v.mean()), float(t * v.std(ddof=1) / np.sqrt(len(v))))
