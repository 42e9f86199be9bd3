"""Small numbers to put into every equation: by the name of the argument, or for one function."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

TWO_FRAMES = [[[0.0, 1.0, 0.0], [0.5, 1.5, 0.0]], [[0.0, 1.0, 0.2], [0.5, 1.5, 0.3]]]
"""Two joints in two frames, ``(2, 2, 3)`` metres."""

CHAIN = [[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]
"""Laplacian of three joints in a row."""

BY_NAME: dict[str, Any] = {
    "t": 0.5, "t_next": 0.6, "eta": 0.5, "w_kin": 10.0, "ridge": 1.0, "s": 1.0,
    "l_min": 3.0, "l_max": 10.0, "c0": 3.0, "lambda_s": 1.0, "p": 2.0, "tau_min": 0.1,
    "pi_min": 0.02, "pi_max": 0.99, "frames": 2, "joints": 2, "scale": 10.0, "steps": 5,
    "x0": [1.0, 0.0], "x1": [0.0, 2.0], "x_t": [0.5, 1.0], "v": [-1.0, 2.0], "eps": [0.0, -1.0],
    "x": [1.0, 2.0], "x1_hat": [1.0, 2.0], "delta": [0.5, 0.0], "noise": [0.1],
    "A": [[1.0, 0.0]], "y": [2.0], "R": [[2.0, -1.0], [-1.0, 2.0]], "Sigma": [[0.1]],
    "M": [[1.0, 0.0], [0.0, 0.0]], "M_obs": [[1.0, 0.0], [0.0, 0.0]],
    "M_aug": [[0.0, 0.0], [0.0, 1.0]], "y_obs": [2.0, 0.0], "y_src": [0.0, 3.0],
    "L": CHAIN, "R_J": [[11.0, -10.0, 0.0], [-10.0, 21.0, -10.0], [0.0, -10.0, 11.0]],
    "R_cam": [[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]],
    "joint_a": 0, "joint_b": 1, "d": [0.5, 0.5, 0.0], "selected": None,
    "x_i": 1.0, "y_i": 2.0, "variance": 0.1, "pi": 0.5, "r": 0.3,
    "rows": [0, 1], "features": 3, "alpha_bar": 0.5, "mask": [1.0, 0.0],
    "gradient": [0.5, -1.0], "mean": [1.0, 2.0],
}  # fmt: skip
"""What an argument is as a rule; equations of ProjFlow live in the plane."""

TABLE = [[1.0, 2.0], [0.0, 1.0], [3.0, -1.0]]
"""Three features in two frames, as GMD writes motions."""

ROTATION = [[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]
HALF = [[1.0, 0.0], [1.0, 0.0]]
"""Both coordinates of a trajectory, known in the first of two frames."""

BY_FUNCTION: dict[str, dict[str, Any]] = {
    "flow_matching_loss": {"v": [[-1.0, 2.0]], "x0": [[1.0, 0.0]], "x1": [[0.0, 1.5]]},
    "recompose": {"noise": [0.5, -1.0]},
    "frame_trust": {"s": [0.2, 1.0, 2.0, 3.0]},
    "curvature": {
        "x1_hat": [[[0.0, 0.0, 0.0]], [[0.0, 0.1, 0.0]], [[0.0, 0.4, 0.0]]], "R_J": [[1.0]],
    },
    "orthographic_projection": {"x": TWO_FRAMES},
    "relative_position": {"x": TWO_FRAMES},
    "loop_gap": {"x": TWO_FRAMES},
    "euclidean_masked_update": {"y": [2.0, 0.0], "Sigma": [[0.0, 0.0], [0.0, 0.0]]},
    "euclidean_masked_average": {"y": [2.0, 0.0], "Sigma": [[0.0, 0.0], [0.0, 0.0]]},
    "masked_update": {"y": [2.0, 0.0], "Sigma": [[0.0, 0.0], [0.0, 0.0]]},
    "masked_average": {"y": [2.0, 0.0], "Sigma": [[0.0, 0.0], [0.0, 0.0]]},
    "joint_trust": {
        "pi_frame": [1.5, 0.6], "q": [0.3, 0.4, 0.3], "active": [[1, 1, 0], [0, 1, 0]],
    },
    "take_trajectory": {"x": TABLE},
    "fill_trajectory": {"z": [[1.0, 2.0], [0.0, 1.0]]},
    "emphasise": {"x": TABLE, "A": ROTATION},
    "impute": {"x0": TABLE, "z": [[5.0, 5.0], [5.0, 5.0]], "mask": [*HALF, [0.0, 0.0]]},
    "unemphasise": {"x_proj": TABLE, "A": ROTATION},
    "impute_emphasised": {
        "x0_proj": TABLE, "z": [[5.0, 5.0], [5.0, 5.0]], "mask": [*HALF, [0.0, 0.0]],
        "A": ROTATION,
    },
    "unprojected_step": {"gradient": TABLE, "A": ROTATION},
    "guided_mean_emphasised": {
        "mean_proj": TABLE, "delta_mu": TABLE, "mask": [[1.0, 0.0]] * 3, "A": ROTATION,
    },
    "keyframe_goal_of_motion": {"x": TABLE, "y": [[2.0, 2.0], [0.0, 0.0]], "mask": HALF, "p": 1.0},
    "keyframe_goal": {
        "z": [[1.0, 2.0], [0.0, 1.0]], "y": [[2.0, 2.0], [0.0, 0.0]], "mask": HALF, "p": 1.0,
    },
    "imputation_region": {"mask": HALF},
    "point_to_point": {"frames": [1, 4], "positions": [[0.0, 0.0], [1.0, 2.0]]},
}  # fmt: skip
"""Where it is something else."""

FORMS = {"derived": ("derived", "printed"), "printed": ("printed", "released")}
"""Readings to choose from, by the one that a function takes by default."""

RELEASED = ("projection_correction", "project", "point_to_point")
"""Functions whose other reading is that of public code, and not a misprint."""


def example(function: Callable[..., Any]) -> dict[str, Any] | None:
    """Arguments to call a function of `equations` with; None if one of them is a function.

    The argument `form` is left out.
    """
    own = BY_FUNCTION.get(function.__name__, {})
    names = [name for name in inspect.signature(function).parameters if name != "form"]
    if any(name not in own and name not in BY_NAME for name in names):
        return None
    return {name: own.get(name, BY_NAME.get(name)) for name in names}


def forms(function: Callable[..., Any]) -> tuple[str, ...]:
    """Readings of an equation that a function can compute, its own choice first; often none."""
    form = inspect.signature(function).parameters.get("form")
    if form is None:
        return ()
    return ("derived", "released") if function.__name__ in RELEASED else FORMS[form.default]
