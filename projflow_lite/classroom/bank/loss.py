"""Answers to ProjFlow eq. 3, the flow-matching loss."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


@wrong("projflow:3")
def mean_over_everything(v, x0, x1):
    """The average is taken over all coordinates; only samples are averaged, coordinates summed."""
    return np.mean((v - (x1 - x0)) ** 2)


@wrong("projflow:3")
def sum_over_samples(v, x0, x1):
    """The samples are summed, not averaged: the loss grows with the batch."""
    return np.sum((v - (x1 - x0)) ** 2)


@wrong("projflow:3")
def mean_over_frames_too(v, x0, x1):
    """The average is taken over samples and frames; the frames of one motion are summed."""
    return np.mean(np.sum((v - (x1 - x0)) ** 2, axis=(2, 3)))


@wrong("projflow:3")
def target_reversed(v, x0, x1):
    """The straight velocity has the wrong sign: it leads from data to noise."""
    return np.sum((v - (x0 - x1)) ** 2) / len(v)


@wrong("projflow:3")
def target_is_the_data(v, x0, x1):
    """The velocity is compared with the data x1 itself; the noise is left out."""
    return np.sum((v - x1) ** 2) / len(v)


@wrong("projflow:3")
def norm_not_squared(v, x0, x1):
    """The norm of each sample is averaged without being squared."""
    return np.mean(np.sqrt(np.sum((v - (x1 - x0)) ** 2, axis=(1, 2, 3))))


@wrong("projflow:3")
def root_of_the_loss(v, x0, x1):
    """There is a root around the average; the loss is the average of the squares."""
    return np.sqrt(np.sum((v - (x1 - x0)) ** 2) / len(v))


@wrong("projflow:3")
def absolute_values(v, x0, x1):
    """The absolute values of the deviations are added up, not their squares."""
    return np.sum(np.abs(v - (x1 - x0))) / len(v)


@wrong("projflow:3")
def square_of_the_sum(v, x0, x1):
    """The deviations are summed before they are squared, so they cancel each other."""
    return np.mean(np.sum(v - (x1 - x0), axis=(1, 2, 3)) ** 2)


@wrong("projflow:3")
def factor_one_half(v, x0, x1):
    """There is a factor one half that this loss does not have."""
    return 0.5 * np.sum((v - (x1 - x0)) ** 2) / len(v)


@wrong("projflow:3")
def one_loss_per_sample(v, x0, x1):
    """The losses of the samples come back one by one; their average is missing."""
    return np.sum((v - (x1 - x0)) ** 2, axis=(1, 2, 3))


@wrong("projflow:3")
def divided_by_one_less(v, x0, x1):
    """The sum is divided by the number of samples less one, as a variance would be."""
    return np.sum((v - (x1 - x0)) ** 2) / (len(v) - 1)


@right("projflow:3")
def sum_then_mean(v, x0, x1):
    """Sum within each sample, average over samples."""
    return ((v - x1 + x0) ** 2).sum(axis=(1, 2, 3)).mean()


@right("projflow:3")
def by_loops(v, x0, x1):
    """Explicit loops over samples and coordinates."""
    total = 0.0
    for v_b, noise, data in zip(v, x0, x1, strict=True):
        for a, b, c in zip(v_b.flat, noise.flat, data.flat, strict=True):
            total += (a - c + b) ** 2
    return total / v.shape[0]


@right("projflow:3")
def squared_norm_of_rows(v, x0, x1):
    """Norms of the samples written as rows, squared again, as an array without axes."""
    rows = (v - (x1 - x0)).reshape(len(v), -1)
    return np.array(np.mean(np.linalg.norm(rows, axis=1) ** 2))


@right("projflow:3")
def by_einsum(v, x0, x1):
    """One contraction of the deviation with itself."""
    off = v + x0 - x1
    return np.einsum("bnjc,bnjc->", off, off) / len(off)
