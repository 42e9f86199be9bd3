"""What a `Projector` may be given, and what is said when it is something else."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import ArrayLike
from scipy import sparse

from projflow_lite.constraints import Rows
from projflow_lite.skeleton import N_JOINTS, number_array, shown

PRECISIONS = (torch.float32, torch.float64)


def check_rows(rows: Rows, dtype: torch.dtype) -> Rows:
    """Refuse rows whose shapes do not match, that are not finite, or that say nothing.

    Returns:
        The same, with the matrix in rows, each entry once: other code counts entries.
    """
    if not isinstance(rows, tuple) or len(rows) != 3 or not sparse.issparse(rows[0]):
        raise ValueError(f"Projector: rows are those of wish.rows(frames), not {shown(rows)}")
    A, y, variance = rows
    m = A.shape[0]
    if np.shape(y) != (m,) or np.shape(variance) != (m,):
        raise ValueError(
            f"Projector: {m} rows, but y {np.shape(y)} and variance {np.shape(variance)}"
        )
    if A.shape[1] == 0 or A.shape[1] % (N_JOINTS * 3):
        raise ValueError(f"Projector: A has {A.shape[1]} columns, not a multiple of {N_JOINTS * 3}")
    in_rows = A.copy() if isinstance(A, sparse.csr_matrix) else sparse.csr_matrix(A)
    entries = in_rows.data
    for name, values in (("A", entries), ("y", y), ("variance", variance)):
        number_array(values, f"Projector: {name}")
    if not (np.isfinite(entries).all() and np.isfinite(y).all() and np.isfinite(variance).all()):
        raise ValueError("Projector: A, y and variance must be finite")
    if np.min(variance, initial=0.0) < 0:
        raise ValueError(f"Projector: row {np.argmin(variance)} has a negative variance")
    largest = np.abs(y).max(initial=0.0)
    if largest > torch.finfo(dtype).max:
        raise ValueError(f"Projector: a target of {largest:.3g} m is more than {dtype} holds")
    in_rows = in_rows.astype(np.float64, copy=False)
    in_rows.sum_duplicates()
    in_rows.eliminate_zeros()
    empty = np.flatnonzero(np.diff(in_rows.indptr) == 0)
    if len(empty):
        raise ValueError(f"Projector: row {empty[0]} of A is zero")
    return Rows(in_rows, np.asarray(y, dtype=np.float64), np.asarray(variance, dtype=np.float64))


def check_precision(dtype: torch.dtype) -> None:
    """Refuse what is not a precision to project in."""
    if not any(dtype is known for known in PRECISIONS):
        raise ValueError(f"Projector: dtype is torch.float32 or torch.float64, not {shown(dtype)}")


def check_device(device: str | torch.device) -> None:
    """Refuse a device that is not there, before torch says it in five lines."""
    try:
        torch.empty(0, device=device)
    except Exception:  # each kind of device fails in a way of its own
        raise ValueError(f"Projector: torch has no device {shown(device)} here") from None


def check_motion(x: torch.Tensor, frames: int, dtype: torch.dtype, device: torch.device) -> None:
    """Refuse a motion of another shape, precision or device than the projector's."""
    if not isinstance(x, torch.Tensor):
        raise ValueError(f"Projector: a motion is a torch tensor here, not {shown(x)}")
    if x.shape[-3:] != (frames, N_JOINTS, 3):
        raise ValueError(
            f"Projector: expected shape (..., {frames}, {N_JOINTS}, 3), got {tuple(x.shape)}"
        )
    if x.dtype != dtype:
        raise ValueError(f"Projector: made for {dtype}, the motion is {x.dtype}; convert one")
    if x.device != device:
        raise ValueError(f"Projector: it is on {device}, the motion on {x.device}; move one")


def check_batch(values: torch.Tensor, motions: int, what: str) -> None:
    """Refuse sets of values that are neither one for all motions nor one for each."""
    if values.ndim > 1 and len(values) not in (1, motions):
        raise ValueError(f"Projector: {len(values)} sets of {what} for {motions} motions")


def check_variance(
    variance: torch.Tensor, rows: int, motions: int, known: bool = False
) -> torch.Tensor:
    """Refuse variances that are not one for each row; unless `known`, also below 0 or NaN."""
    if not isinstance(variance, torch.Tensor):
        raise ValueError(f"Projector: variance is a torch tensor here, not {shown(variance)}")
    if variance.ndim not in (1, 2):
        raise ValueError(f"Projector: variance is (m,) or (batch, m), not {tuple(variance.shape)}")
    if variance.shape[-1] != rows:
        raise ValueError(f"Projector: {variance.shape[-1]} variances, {rows} rows")
    check_batch(variance, motions, "variances")
    if not known and not lowest(variance) >= 0:  # nor is NaN
        raise ValueError("Projector: a variance is negative or not a number")
    return variance


def check_solved(left: torch.Tensor, tolerance: float) -> None:
    """Refuse what rows as firm as hard ones left over, metres, when they cannot all be met."""
    if not holds(left.abs() <= tolerance):
        raise ValueError(
            "Projector: with variances this small soft rows imply or contradict others; "
            "raise them, or leave rows out"
        )


def as_targets(y: ArrayLike | torch.Tensor, rows: int) -> torch.Tensor:
    """Targets as a tensor ``(m,)`` or ``(batch, m)`` that keeps its gradient."""
    if not isinstance(y, torch.Tensor):
        y = torch.from_numpy(number_array(y, "Projector: targets").astype(np.float64))
    wanted = y.ndim in (1, 2) and y.shape[-1] == rows and not y.is_complex()
    if not wanted or not holds(torch.isfinite(y)):
        raise ValueError(f"Projector: expected (..., {rows}) finite targets")
    return y


def lowest(values: torch.Tensor) -> float:
    """The smallest of a tensor, NaN if one is in it; one pass, and no table of truths."""
    return float("inf") if values.is_meta or values.numel() == 0 else float(values.detach().amin())


def holds(condition: torch.Tensor) -> bool:
    """Whether all of a tensor is true; one without data (device "meta") cannot be asked."""
    return condition.is_meta or bool(condition.all())
