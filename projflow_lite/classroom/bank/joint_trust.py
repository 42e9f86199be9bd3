"""Answers to ProjFlow eq. 52, the trust of a joint."""

from __future__ import annotations

import numpy as np

from .shelves import right, wrong


def _share(weights, total):
    """Divide by a sum that may be empty."""
    return np.divide(weights, total, out=np.zeros(weights.shape), where=total > 0)


@wrong("projflow:52")
def budget_clipped_first(pi_frame, q, active, pi_min, pi_max):
    """The frame's trust is clipped before it is shared, as in the public code but not in eq. 52."""
    share = _share(q * active, (active @ q)[:, None])
    budget = np.clip(pi_frame, pi_min, pi_max)[:, None]
    return np.where(active, np.clip(budget * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def not_clipped(pi_frame, q, active, pi_min, pi_max):
    """The clip to pi_min and pi_max is missing."""
    return pi_frame[:, None] * _share(q * active, (active @ q)[:, None])


@wrong("projflow:52")
def clipped_from_above_only(pi_frame, q, active, pi_min, pi_max):
    """The trust is kept below pi_max, but pi_min is forgotten."""
    return np.minimum(pi_frame[:, None] * _share(q * active, (active @ q)[:, None]), pi_max)


@wrong("projflow:52")
def inactive_joints_get_the_minimum(pi_frame, q, active, pi_min, pi_max):
    """Joints that are not active are clipped up to pi_min; they should have 0."""
    share = _share(q * active, (active @ q)[:, None])
    return np.clip(pi_frame[:, None] * share, pi_min, pi_max)


@wrong("projflow:52")
def sum_over_all_joints(pi_frame, q, active, pi_min, pi_max):
    """The sum below the line takes all joints; it should take the active ones of the frame."""
    return np.where(active, np.clip(pi_frame[:, None] * q / q.sum(), pi_min, pi_max), 0)


@wrong("projflow:52")
def sum_over_frames(pi_frame, q, active, pi_min, pi_max):
    """The sum below the line runs over the frames of a joint; it should run over joints."""
    share = _share(q * active, (q * active).sum(axis=0))
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def equal_shares(pi_frame, q, active, pi_min, pi_max):
    """The weights q are forgotten: all active joints get the same share."""
    share = _share(1.0 * active, active.sum(axis=1, keepdims=True))
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def everyone_gets_all(pi_frame, q, active, pi_min, pi_max):
    """Every active joint gets the whole trust of the frame; it should be shared."""
    return np.where(active, np.clip(pi_frame, pi_min, pi_max)[:, None], 0)


@wrong("projflow:52")
def weights_not_divided(pi_frame, q, active, pi_min, pi_max):
    """The weights are not divided by their sum."""
    return np.where(active, np.clip(pi_frame[:, None] * q, pi_min, pi_max), 0)


@wrong("projflow:52")
def divided_by_the_largest(pi_frame, q, active, pi_min, pi_max):
    """The weights are divided by the largest active one, not by their sum."""
    share = _share(q * active, (q * active).max(axis=1, keepdims=True))
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def divided_by_the_mean(pi_frame, q, active, pi_min, pi_max):
    """The weights are divided by their mean over the active joints, not by their sum."""
    mean = _share((active @ q)[:, None], active.sum(axis=1, keepdims=True))
    share = _share(q * active, mean)
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def coordinates_counted(pi_frame, q, active, pi_min, pi_max):
    """The sum counts each joint three times, once per axis; it should count joints."""
    share = _share(q * active, 3 * (active @ q)[:, None])
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def reciprocal_weights(pi_frame, q, active, pi_min, pi_max):
    """One over q is shared; eq. 51 has taken the reciprocal already."""
    share = _share(active / q, (active @ (1 / q))[:, None])
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def softmax(pi_frame, q, active, pi_min, pi_max):
    """The shares are a softmax of q; eq. 52 shares in proportion to q."""
    share = _share(np.exp(q) * active, (active @ np.exp(q))[:, None])
    return np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)


@wrong("projflow:52")
def nothing_divided_by_nothing(pi_frame, q, active, pi_min, pi_max):
    """A frame without an active joint divides 0 by 0; multiplying NaN by 0 does not help."""
    share = q * active / (active @ q)[:, None]
    return np.clip(pi_frame[:, None] * share, pi_min, pi_max) * active


@wrong("projflow:52")
def overwrites_the_budget(pi_frame, q, active, pi_min, pi_max):
    """The result is written over the argument pi_frame, which the caller still needs."""
    share = _share(q * active, (active @ q)[:, None])
    trust = np.where(active, np.clip(pi_frame[:, None] * share, pi_min, pi_max), 0)
    pi_frame[:] = trust.sum(axis=1)
    return trust


@right("projflow:52")
def joint_by_joint(pi_frame, q, active, pi_min, pi_max):
    """Loops over frames and joints, returned as nested lists."""
    trust = []
    for budget, flags in zip(pi_frame, active, strict=True):
        total = sum(weight for weight, flag in zip(q, flags, strict=True) if flag)
        row = []
        for weight, flag in zip(q, flags, strict=True):
            row.append(min(max(budget * weight / total, pi_min), pi_max) if flag else 0.0)
        trust.append(row)
    return trust


@right("projflow:52")
def only_where_active(pi_frame, q, active, pi_min, pi_max):
    """Fill the active places of an array of zeros."""
    trust = np.zeros(active.shape)
    n, j = np.nonzero(active)
    total = np.bincount(n, weights=q[j], minlength=len(pi_frame))
    trust[n, j] = np.clip(pi_frame[n] * q[j] / total[n], pi_min, pi_max)
    return trust
