"""How good a motion is: does it obey, is it physical, is it like the data.

Real motion does not score zero on most of these: print a held-out row beside a generated one.
"""

from projflow_lite.scores.control import ControlErrors, control_errors
from projflow_lite.scores.likeness import frechet_distance, kinetic_features, pose_features
from projflow_lite.scores.physics import (
    bone_length_error,
    foot_skating,
    mean_jerk,
    worst_acceleration,
)

__all__ = [
    "ControlErrors",
    "bone_length_error",
    "control_errors",
    "foot_skating",
    "frechet_distance",
    "kinetic_features",
    "mean_jerk",
    "pose_features",
    "worst_acceleration",
]
