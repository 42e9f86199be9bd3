"""Wrong answers that students really give, and right ones in other styles.

The docstring of a wrong answer says what the mistake is; a student whose function comes to the
same numbers reads it.
"""

from . import (
    applications,
    curvature,
    ddnm,
    flow,
    frame_trust,
    guides,
    influence,
    joint_trust,
    loss,
    metric,
    noise,
    posterior,
    projection,
    trust,
)
from .shelves import right_answers, wrong_answers

TOPICS = (
    applications,
    curvature,
    ddnm,
    flow,
    frame_trust,
    guides,
    influence,
    joint_trust,
    loss,
    metric,
    noise,
    posterior,
    projection,
    trust,
)
"""The modules whose functions stand on the shelves."""

__all__ = ["TOPICS", "right_answers", "wrong_answers"]
