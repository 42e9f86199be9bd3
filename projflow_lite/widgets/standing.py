"""A person standing still: the body behind the path pad before there is any motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import JOINTS

_RIGHT_HALF = {
    "right_hip": (-0.09, 0.86, 0.0),
    "right_knee": (-0.10, 0.47, 0.02),
    "right_ankle": (-0.10, 0.08, -0.02),
    "right_foot": (-0.11, 0.02, 0.11),
    "right_collar": (-0.08, 1.36, -0.01),
    "right_shoulder": (-0.19, 1.38, -0.01),
    "right_elbow": (-0.26, 1.13, -0.02),
    "right_wrist": (-0.29, 0.88, 0.05),
}
_SPINE = {
    "pelvis": (0.0, 0.93, 0.0),
    "spine1": (0.0, 1.05, 0.0),
    "spine2": (0.0, 1.18, 0.0),
    "spine3": (0.0, 1.24, 0.0),
    "neck": (0.0, 1.45, 0.0),
    "head": (0.0, 1.55, 0.03),
}


def standing_pose() -> NDArray[np.float64]:
    """A standing pose as one frame, ``(1, 22, 3)``, metres; facing +z, feet on the ground."""
    places = dict(_SPINE)
    for name, (x, y, z) in _RIGHT_HALF.items():
        places[name] = (x, y, z)
        places[name.replace("right", "left")] = (-x, y, z)
    return np.array([[places[name] for name in JOINTS]])
