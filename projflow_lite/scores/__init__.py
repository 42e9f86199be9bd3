"""How good a motion is: does it obey, is it physical, is it like the data, does it fit its prompt.

Real motion does not score zero on most of these: print a held-out row beside a generated one.
``score_clips`` gives all of them for a set of clips; it and ``load_evaluator`` need torch, the
others numpy and scipy only.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from projflow_lite.scores.control import ControlErrors, control_errors
from projflow_lite.scores.interval import Interval, interval
from projflow_lite.scores.likeness import frechet_distance, kinetic_features, pose_features
from projflow_lite.scores.physics import (
    bone_length_error,
    foot_skating,
    mean_jerk,
    worst_acceleration,
)
from projflow_lite.scores.retrieval import RPrecision, matching_score, r_precision
from projflow_lite.scores.variety import diversity, multimodality

if TYPE_CHECKING:
    from projflow_lite.scores.clips import score_clips
    from projflow_lite.scores.evaluator import Evaluator, load_evaluator

_HOME = {"score_clips": "clips", "Evaluator": "evaluator", "load_evaluator": "evaluator"}

__all__ = [
    "ControlErrors",
    "Evaluator",
    "Interval",
    "RPrecision",
    "bone_length_error",
    "control_errors",
    "diversity",
    "foot_skating",
    "frechet_distance",
    "interval",
    "kinetic_features",
    "load_evaluator",
    "matching_score",
    "mean_jerk",
    "multimodality",
    "pose_features",
    "r_precision",
    "score_clips",
    "worst_acceleration",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"projflow_lite.scores.{_HOME[name]}"), name)
    raise AttributeError(f"module 'projflow_lite.scores' has no attribute '{name}'")
