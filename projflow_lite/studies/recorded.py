"""Clips of recorded motion out of a file: read, checked, and brought to where a motion begins."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import N_JOINTS, joint_index
from projflow_lite.studies.keyframes import FRAMES

RECORDED, OWN = "recorded", "recorded (known bones)"

HOLDS = (
    f"it is an .npz file with an array x60 (clips, {FRAMES}, {N_JOINTS}, 3) of at least 32 clips: "
    "metres, y up, 20 frames a second, joints in the order of projflow_lite.skeleton.JOINTS, "
    "facing +z in frame 0; and, if lengths of bones were guessed for some clips, skeleton60 "
    '(clips,), "nearest" for these'
)
"""What a file must hold."""

FEWEST = 32


def read_recorded(path: str | Path | None) -> dict[str, NDArray[np.float32]]:
    """Recorded clips ``(clips, 60, 22, 3)``, metres, the pelvis over the origin in frame 0.

    Args:
        path: of the file, see `HOLDS`.

    Returns:
        All clips, and if there are enough of them those whose bones were not guessed.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if no file was named, or it does not hold what it must.
    """
    if path is None:
        raise ValueError(f"real-wishes: name a file of recorded clips by --real FILE; {HOLDS}")
    held = arrays_of(path)
    x = held.get("x60")
    if x is None or x.ndim != 4 or x.shape[1:] != (FRAMES, N_JOINTS, 3) or x.dtype.kind != "f":
        found = "none" if x is None else f"{x.dtype} {x.shape}"
        raise ValueError(f"real-wishes: {path} has no such x60 (found: {found}); {HOLDS}")
    if len(x) < FEWEST:
        raise ValueError(f"real-wishes: {path} has {len(x)} clips; {HOLDS}")
    x = checked(x.astype(np.float32), path)
    sets = {RECORDED: x}
    known = held.get("skeleton60", np.full(len(x), "")) != "nearest"
    if FEWEST <= known.sum() < len(x):
        sets[OWN] = x[known]
    return sets


def arrays_of(path: str | Path) -> dict[str, NDArray]:
    """The arrays of an ``.npz`` file, none of them pickled."""
    try:
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in ("x60", "skeleton60") if name in file.files}
    except (AttributeError, EOFError, TypeError, ValueError, zipfile.BadZipFile):
        raise ValueError(f"real-wishes: {path} cannot be read; {HOLDS}") from None


def checked(x: NDArray[np.float32], path: str | Path) -> NDArray[np.float32]:
    """Clips moved over the origin; refused if they are not finite, not upright or turned away."""
    if not np.isfinite(x).all():
        clip, frame = np.argwhere(~np.isfinite(x))[0][:2]
        raise ValueError(f"real-wishes: {path}, clip {clip}, frame {frame} is not finite")
    height = float(np.median(x[:, :, 0, 1]))
    if not 0.3 < height < 2:
        raise ValueError(
            f"real-wishes: {path}, the pelvis is {height:.3g} high: not metres with y up; {HOLDS}"
        )
    left, right = (joint_index(name, "real-wishes") for name in ("left_hip", "right_hip"))
    across = x[:, 0, left] - x[:, 0, right]
    facing = across[:, 0] / np.maximum(np.linalg.norm(across, axis=-1), 1e-9)
    if np.median(facing) < 0.5:
        raise ValueError(f"real-wishes: {path}, bodies do not face +z in frame 0; {HOLDS}")
    moved = x.copy()
    moved[..., [0, 2]] -= x[:, :1, :1, [0, 2]]
    return moved
