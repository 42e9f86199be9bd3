"""The body: 22 joints in the HumanML3D order, the bones between them, and nothing else.

Positions are metres in world coordinates, y up, facing +z, left is +x, 20 frames a second.
An array of positions always ends in ``(..., frames, joints, 3)``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from difflib import get_close_matches
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

FPS = 20

JOINTS: tuple[str, ...] = (
    "pelvis",
    "left_hip",
    "right_hip",
    "spine1",
    "left_knee",
    "right_knee",
    "spine2",
    "left_ankle",
    "right_ankle",
    "spine3",
    "left_foot",
    "right_foot",
    "neck",
    "left_collar",
    "right_collar",
    "head",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
)
N_JOINTS = len(JOINTS)

CHAINS: tuple[tuple[int, ...], ...] = (
    (0, 2, 5, 8, 11),
    (0, 1, 4, 7, 10),
    (0, 3, 6, 9, 12, 15),
    (9, 14, 17, 19, 21),
    (9, 13, 16, 18, 20),
)

EDGES: tuple[tuple[int, int], ...] = tuple(
    sorted(
        (bone for chain in CHAINS for bone in pairwise(chain)),
        key=lambda bone: bone[1],
    )
)
"""The 21 bones as ``(parent, child)``, in the order of the child."""

PARENTS: tuple[int, ...] = (-1, *(parent for parent, _ in EDGES))
"""Parent of every joint; the pelvis has none (-1). A parent always comes before its child."""

MIRROR: tuple[int, ...] = tuple(
    JOINTS.index(name.replace("left", "\0").replace("right", "left").replace("\0", "right"))
    for name in JOINTS
)
"""The joint on the other side of the body; joints of the spine map to themselves."""

LOWER_BODY: tuple[str, ...] = tuple(
    name for name in JOINTS if name.endswith(("pelvis", "hip", "knee", "ankle", "foot"))
)
"""Pelvis and legs."""

UPPER_BODY: tuple[str, ...] = tuple(name for name in JOINTS if name not in LOWER_BODY)
"""Spine, head and arms."""

CONTROLLED: tuple[str, ...] = (
    "pelvis", "left_foot", "right_foot", "head", "left_wrist", "right_wrist",
)  # fmt: skip
"""The joints that comparisons of papers pin."""

ANKLES: tuple[int, int] = (JOINTS.index("left_ankle"), JOINTS.index("right_ankle"))
FEET: tuple[int, int] = (JOINTS.index("left_foot"), JOINTS.index("right_foot"))
"""Indices of the balls of the feet: the joints that slide."""

# Share of a body's mass in each segment, the joints at its ends, and how far along it its centre
# lies: Winter, Biomechanics and Motor Control of Human Movement; a hand counts at its wrist.
SEGMENTS = (
    (0.0145, "ankle", "foot", 0.500), (0.0465, "knee", "ankle", 0.433),
    (0.1000, "hip", "knee", 0.433), (0.0280, "shoulder", "elbow", 0.436),
    (0.0160, "elbow", "wrist", 0.430), (0.0060, "wrist", "wrist", 0.0),
)  # fmt: skip
TRUNK = {"pelvis": 0.142, "spine1": 0.0695, "spine2": 0.0695, "spine3": 0.108, "neck": 0.108}
HEAD = {"head": 0.081}


def mass_shares() -> NDArray[np.float64]:
    """Share of the body's mass that counts at every joint, ``(22,)``, summing to 1."""
    share = np.zeros(N_JOINTS)
    for name, part in (TRUNK | HEAD).items():
        share[JOINTS.index(name)] += part
    for side in ("left", "right"):
        for part, near, far, along in SEGMENTS:
            share[JOINTS.index(f"{side}_{near}")] += part * (1 - along)
            share[JOINTS.index(f"{side}_{far}")] += part * along
    return share


MASS: tuple[float, ...] = tuple(mass_shares())
"""Share of the body's mass at every joint: ``MASS @ positions`` is the centre of mass."""


THE_JOINTS = (
    "the joints are pelvis, spine1 to spine3, neck, head, and left_ or right_ "
    "hip, knee, ankle, foot, collar, shoulder, elbow, wrist"
)


def shown(value: object) -> str:
    """A value for an error message: on one line, and shortened if it is long."""
    shape = getattr(value, "shape", ())
    if hasattr(value, "dtype") and isinstance(shape, tuple) and shape:
        return f"an array of shape {tuple(shape)}"
    text = " ".join(repr(value).split())
    return text if len(text) <= 48 else f"{text[:45]}..."


KINDS = {
    "b": "True and False", "c": "complex numbers", "U": "text", "S": "bytes",
    "M": "dates", "m": "times", "O": "mixed things", "V": "records",
}  # fmt: skip
"""What numpy calls by a letter, where numbers are due."""


def number_array(value: object, what: str) -> NDArray:
    """Return `value` as an array of real numbers, or say that it is none.

    numpy would read the text "1.5" as a number, take True for 1, drop what is imaginary and look
    under a mask without a word.

    Raises:
        ValueError: if it is not a regular array of real numbers.
    """
    wrong = None
    try:
        array = np.asarray(value)
        wrong = KINDS.get(array.dtype.kind)
    except Exception:  # lists of lists that differ in length, tensors on a graph, ...
        wrong = "rows of different lengths" if isinstance(value, list | tuple) else shown(value)
    if np.ma.is_masked(value):
        wrong = "masked numbers"
    if wrong is not None:
        raise ValueError(f"{what} should be a regular array of numbers, not {wrong}")
    return array


def joint_index(joint: str | int, who: str = "joint_index") -> int:
    """Index of one joint, from its name or from the index itself.

    Args:
        joint: a name of `JOINTS` or an integer in 0..21.
        who: the function to name in an error message.

    Raises:
        ValueError: if there is no such joint; the message proposes the nearest name.
    """
    if isinstance(joint, str):
        if joint in JOINTS:
            return JOINTS.index(joint)
        near = get_close_matches(joint.lower().replace(" ", "_"), JOINTS, n=1)
        hint = f"did you mean '{near[0]}'?" if near else THE_JOINTS
        raise ValueError(f"{who}: {shown(joint)} is not a joint; {hint}")
    if isinstance(joint, bool) or not isinstance(joint, int | np.integer):
        raise ValueError(f"{who}: a joint is a name or an integer, not {shown(joint)}")
    if not 0 <= joint < N_JOINTS:
        raise ValueError(f"{who}: joint {joint} is outside 0..{N_JOINTS - 1}")
    return int(joint)


def joint_indices(joints: str | int | Iterable[str | int], who: str = "joint_indices") -> list[int]:
    """Indices of one or several joints; see `joint_index`."""
    if isinstance(joints, str | int | np.integer):
        joints = [joints]
    # A set has no order in which positions could belong to its joints.
    if not isinstance(joints, Iterable) or isinstance(joints, bytes | Set | Mapping):
        raise ValueError(f"{who}: a joint is a name or an integer, not {shown(joints)}")
    indices = [joint_index(joint, who) for joint in joints]
    if not indices:
        raise ValueError(f"{who}: the list of joints is empty")
    return indices


def bone_lengths(positions: NDArray) -> NDArray:
    """Length of every bone in every frame.

    Args:
        positions: ``(..., frames, 22, 3)``, metres.

    Returns:
        ``(..., frames, 21)``, metres, in the order of `EDGES`.

    Raises:
        ValueError: if they are no positions.
    """
    positions = check_positions(positions, "bone_lengths")
    parent, child = np.transpose(EDGES)
    return np.linalg.norm(positions[..., child, :] - positions[..., parent, :], axis=-1)


def mirror(positions: NDArray) -> NDArray:
    """Reflect a motion left to right: x changes sign and every joint takes its partner's place.

    Raises:
        ValueError: if they are no positions.
    """
    positions = check_positions(positions, "mirror")
    return positions[..., list(MIRROR), :] * np.array([-1.0, 1.0, 1.0], dtype=positions.dtype)


def check_positions(positions: Sequence | NDArray, who: str = "positions") -> NDArray:
    """Return `positions` as an array ``(..., frames, 22, 3)``, or say what is wrong with it.

    Raises:
        ValueError: if the shape does not end in ``(frames, 22, 3)`` or a value is not finite.
    """
    array = number_array(positions, f"{who}: positions")
    if array.size == 0 or array.ndim < 3 or array.shape[-2:] != (N_JOINTS, 3):
        raise ValueError(f"{who}: expected shape (..., frames, {N_JOINTS}, 3), got {array.shape}")
    if not np.isfinite(array).all():
        frame, joint, axis = np.argwhere(~np.isfinite(array))[0][-3:]
        raise ValueError(f"{who}: {JOINTS[joint]}, frame {frame}, {'xyz'[axis]} is not finite")
    return array
