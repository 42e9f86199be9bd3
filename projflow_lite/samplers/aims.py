"""What GMD and the rivals of ProjFlow make of a wish; none has a metric or guides to choose.

Each function is an ``aim`` of `projflow_lite.samplers.Method`; those of rivals take the name of the
method first, which their errors begin with.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import ArrayLike

from projflow_lite.constraints import Wish, describe_row, is_coordinate
from projflow_lite.row_blocks import independent_rows
from projflow_lite.samplers.gmd_imputation import Imputation, known_coordinates
from projflow_lite.samplers.guides import GuideSettings
from projflow_lite.samplers.misfit import Misfit
from projflow_lite.samplers.step import ProjectionStep
from projflow_lite.skeleton import N_JOINTS


def any_rows(
    who: str,
    wish: Wish,
    frames: int,
    metric: str | ArrayLike,
    dtype: torch.dtype,
    guides: bool | GuideSettings,
) -> Misfit:
    """Any linear wish, to walk downhill on."""
    refuse_choices(who, metric, guides)
    return Misfit(wish, frames, dtype)


def exact_rows(
    who: str,
    wish: Wish,
    frames: int,
    metric: str | ArrayLike,
    dtype: torch.dtype,
    guides: bool | GuideSettings,
) -> ProjectionStep:
    """Any linear wish without variances, to project onto with R = I."""
    refuse_choices(who, metric, guides)
    A, _, variance = wish.rows(frames)
    soft = np.flatnonzero(variance > 0)
    if len(soft):
        raise ValueError(
            f"sample: {who} takes exact wishes, but row {soft[0]} ({describe_row(A, soft[0], 2)}) "
            "is soft; leave std out, or take projflow"
        )
    return ProjectionStep(wish, frames, "euclidean", dtype, guides=False)


def exact_pins(
    who: str,
    wish: Wish,
    frames: int,
    metric: str | ArrayLike,
    dtype: torch.dtype,
    guides: bool | GuideSettings,
) -> Imputation:
    """Coordinates that are known, to overwrite."""
    refuse_choices(who, metric, guides)
    rows = wish.rows(frames)
    other = np.flatnonzero(~is_coordinate(rows.A) | (rows.variance > 0))
    if len(other):
        raise ValueError(
            f"sample: {who} overwrites exact pins, but row {other[0]} "
            f"({describe_row(rows.A, other[0], 2)}) is not one; take projflow or dps"
        )
    independent_rows(rows, np.eye(N_JOINTS))  # refuses pins that contradict each other
    return known_coordinates(wish, frames, dtype)


def pins_to_impute(
    wish: Wish | None,
    frames: int,
    metric: str | ArrayLike,
    dtype: torch.dtype,
    guides: bool | GuideSettings,
) -> Imputation:
    """What GMD asks in every step: known coordinates, without a metric and without guides."""
    if has_chosen(metric, guides):
        raise ValueError("sample: gmd overwrites, it has no metric and no guides; leave them out")
    return known_coordinates(wish, frames, dtype)


def has_chosen(metric: str | ArrayLike, guides: bool | GuideSettings) -> bool:
    """Whether something was chosen that only ProjFlow has."""
    return not isinstance(metric, str) or metric != "kinematic" or isinstance(guides, GuideSettings)


def refuse_choices(who: str, metric: str | ArrayLike, guides: bool | GuideSettings) -> None:
    """Refuse what only ProjFlow has, if it was chosen."""
    if has_chosen(metric, guides):
        raise ValueError(f"sample: {who} has no metric and no guides to choose; leave them out")
