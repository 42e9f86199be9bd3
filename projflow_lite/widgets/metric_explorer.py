"""The metric explorer: pull a joint, and see what three metrics make the rest of the body do."""

from __future__ import annotations

from typing import Any

import anywidget
import numpy as np
import traitlets
from numpy.typing import ArrayLike, NDArray

from projflow_lite.equations.checks import positive_definite, real_array
from projflow_lite.skeleton import EDGES, JOINTS, N_JOINTS, bone_lengths, joint_index
from projflow_lite.widgets.front_end import module
from projflow_lite.widgets.standing import standing_pose

WHO = "MetricExplorer"
LONGEST_PULL = 2.0
"""Metres along an axis: further than any body reaches."""


class MetricExplorer(anywidget.AnyWidget):
    r"""Three copies of a body, one for each metric, that answer the same pull.

    A joint p is pinned where it was pulled to, and the others move the shortest way: by
    :math:`R_J^{-1}[j, p] / R_J^{-1}[p, p]` times the pull (ProjFlow eq. 7 for a single hard pin).
    The metrics are Euclidean, :math:`R_J = I`; kinematic, :math:`R_J = w L + \lambda I` (eq. 50);
    and one of your own. Bones are coloured by how much longer or shorter they became.

    Args:
        metric: your own metric on the joints, ``(22, 22)``, symmetric positive definite. By
            default `equal_strain_metric`: one percent of length costs the same on every bone.
        name: what to call it.
        joint: the joint to pull, by name or index.
        pull: metres along x, y and z.
        w_kin: weight of the differences across bones.
        ridge: :math:`\lambda`, weight of every joint by itself.
        pose: the body at rest, ``(22, 3)``, metres; by default a standing person.
        height: of the picture in pixels.

    Raises:
        ValueError: for an unknown joint, a metric that is no metric, or a pose of another shape.
        traitlets.TraitError: for a pull, weight or ridge out of range.

    The kernel reads and sets ``joint``, ``pull``, ``w_kin``, ``ridge`` and ``metric``.

    Source: ProjFlow eq. 7, 11 and 50.
    """

    _esm = module(
        "theme.js", "camera.js", "body.js", "metric_explorer_algebra.js",
        "metric_explorer_draw.js", "metric_explorer.js", "metric_explorer_input.js",
    )  # fmt: skip
    _css = module("widgets.css", "metric_explorer.css")

    joint = traitlets.Unicode("left_wrist").tag(sync=True)
    pull = traitlets.List(traitlets.Float(), minlen=3, maxlen=3).tag(sync=True)
    w_kin = traitlets.Float(10.0).tag(sync=True)
    ridge = traitlets.Float(1.0).tag(sync=True)
    own = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    own_name = traitlets.Unicode().tag(sync=True)
    rest = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    names = traitlets.List(traitlets.Unicode(), list(JOINTS)).tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)

    def __init__(
        self,
        metric: ArrayLike | None = None,
        name: str | None = None,
        joint: str | int = "left_wrist",
        pull: ArrayLike = (0.3, 0.2, 0.0),
        pose: ArrayLike | None = None,
        **traits: Any,
    ) -> None:
        if name is None:
            name = "equal strain" if metric is None else "your metric"
        super().__init__(
            joint=JOINTS[joint_index(joint, WHO)],
            pull=real_array(WHO, "pull", pull, (3,)).tolist(),
            rest=check_pose(standing_pose()[0] if pose is None else pose).tolist(),
            own=as_metric(equal_strain_metric() if metric is None else metric).tolist(),
            own_name=name,
            **traits,
        )

    def __repr__(self) -> str:
        # Jupyter shows this text where the front end did not start.
        return f"MetricExplorer: {self.joint} pulled by {self.pull} m. No picture? Rerun the cell."

    @property
    def metric(self) -> NDArray[np.float64]:
        """Your own metric, ``(22, 22)``; set it to see another one in place."""
        return np.array(self.own)

    @metric.setter
    def metric(self, metric: ArrayLike) -> None:
        self.own = as_metric(metric).tolist()

    @traitlets.validate("joint")
    def _check_joint(self, proposal: dict[str, Any]) -> str:
        return JOINTS[joint_index(proposal["value"], WHO)]

    @traitlets.validate("pull")
    def _check_pull(self, proposal: dict[str, Any]) -> list[float]:
        pull = proposal["value"]
        if not np.isfinite(pull).all() or np.abs(pull).max() > LONGEST_PULL:
            raise traitlets.TraitError(
                f"{WHO}: pull must be within {LONGEST_PULL:g} m on every axis, got {pull}"
            )
        return pull

    @traitlets.validate("w_kin")
    def _check_weight(self, proposal: dict[str, Any]) -> float:
        if not 0 <= proposal["value"] <= 1e6:
            raise traitlets.TraitError(f"{WHO}: w_kin must be in 0..1e6, got {proposal['value']}")
        return proposal["value"]

    @traitlets.validate("ridge")
    def _check_ridge(self, proposal: dict[str, Any]) -> float:
        if not 1e-6 <= proposal["value"] <= 1e6:
            raise traitlets.TraitError(
                f"{WHO}: ridge must be in 1e-6..1e6, for without one a shift of the whole "
                f"body is free and the metric has no inverse; got {proposal['value']}"
            )
        return proposal["value"]


def equal_strain_metric(
    pose: ArrayLike | None = None, w_kin: float = 10.0, ridge: float = 1.0
) -> NDArray[np.float64]:
    r"""A metric in which one percent of its length costs the same on every bone.

    .. math:: u^\top R_J u = w \sum_{\text{bones}} \frac{\bar\ell^2}{\ell_{ab}^2} (u_a - u_b)^2
              + \lambda \lVert u \rVert^2

    with :math:`\bar\ell` the root mean square of the lengths, so that `w_kin` keeps its meaning.

    Args:
        pose: ``(22, 3)``, metres, whose bones to measure; by default a standing person's.
        w_kin: weight of the differences across bones.
        ridge: weight of every joint by itself.

    Returns:
        ``(22, 22)``.

    Raises:
        ValueError: if the pose has another shape or a bone without length.
    """
    pose = check_pose(standing_pose()[0] if pose is None else pose)
    lengths = bone_lengths(pose[None])[0]
    R_J = ridge * np.eye(N_JOINTS)
    for (a, b), length in zip(EDGES, lengths, strict=True):
        across = np.zeros(N_JOINTS)
        across[[a, b]] = 1.0, -1.0
        R_J += w_kin * (lengths**2).mean() / length**2 * np.outer(across, across)
    return R_J


def as_metric(metric: ArrayLike) -> NDArray[np.float64]:
    """A metric as an array, symmetric to the last bit.

    Raises:
        ValueError: if it is not a finite, symmetric, positive definite ``(22, 22)`` matrix.
    """
    R_J = real_array(WHO, "metric", metric, (N_JOINTS, N_JOINTS))
    positive_definite(WHO, "metric", R_J, "; add a small multiple of the identity to it")
    return (R_J + R_J.T) / 2


def check_pose(pose: ArrayLike) -> NDArray[np.float64]:
    """A pose ``(22, 3)``, metres, whose bones all have a length.

    Raises:
        ValueError: if it has another shape, is not finite, or a bone has no length.
    """
    array = real_array(WHO, "pose", pose, (N_JOINTS, 3))
    short = np.flatnonzero(bone_lengths(array[None])[0] < 1e-6)
    if len(short):
        names = " – ".join(JOINTS[joint] for joint in EDGES[short[0]])
        raise ValueError(f"{WHO}: the bone {names} of the pose has no length")
    return array
