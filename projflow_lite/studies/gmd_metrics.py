r"""One wish, three metrics, three bodies: DDNM, GMD and ProjFlow as one family.

Each moves a pose the shortest way to where a joint is wanted, and calls another thing short:

.. math:: \hat x_1^* = \hat x_1 + R^{-1} A^\top (A R^{-1} A^\top)^{-1} (y - A \hat x_1)

DDNM measures positions, R = I: the joint goes alone. ProjFlow adds what bones cost: neighbours
follow. GMD measures in projected space, :math:`R = (k A' B S^{-1} F)^\top (k A' B S^{-1} F)`, where
:math:`S^{-1} F x` are its features: the place of the pelvis, and the other joints as seen from it.
"""

from __future__ import annotations

from typing import Any

import ipywidgets as widgets
import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite import equations as eq
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.motion import Motion
from projflow_lite.prior.features import mixing_matrix, mixing_of_positions
from projflow_lite.skeleton import JOINTS, N_JOINTS, bone_lengths, joint_index
from projflow_lite.widgets import Viewer
from projflow_lite.widgets.standing import standing_pose

NAMES = ("DDNM: R = I", "GMD: R = k² AᵀA", "ProjFlow: R = w L + λ I")
COLUMNS = ("pelvis goes, cm", "head goes, cm", "worst bone, %")
GROWING, HELD = 20, 10
"""Frames in which the pull grows, and in which it stays."""


def pulled(pose: ArrayLike, joint: str | int, pull: ArrayLike, R: ArrayLike) -> NDArray:
    """A pose with one joint moved to where it is wanted, the shortest way in a metric.

    Args:
        pose: ``(22, 3)``, metres.
        joint: which one is wanted elsewhere.
        pull: how far along x, y and z, metres.
        R: ``(66, 66)``, the metric on one frame, joint by joint.

    Returns:
        ``(22, 3)``.

    Source: ProjFlow eq. 7 for one hard pin.
    """
    x, p = np.asarray(pose, float), joint_index(joint, "pulled")
    A = np.eye(3 * N_JOINTS)[3 * p : 3 * p + 3]
    y = x[p] + np.asarray(pull, float)
    return eq.project(x.ravel(), A, y, R, np.zeros((3, 3))).reshape(N_JOINTS, 3)


def metric_of_gmd(
    c: float, spreads: tuple[float, float], orthogonal: bool = True, seed: int = 0
) -> NDArray:
    """GMD's emphasis as a metric on joint positions, ``(66, 66)``.

    Args:
        c: how much more the place of the pelvis counts.
        spreads: of the place and of the body, metres, see `projflow_lite.prior.features`.
        orthogonal: whether A' is; a Gaussian one couples everything with everything.
        seed: of A'.

    Source: `projflow_lite.equations.emphasis_metric`, on features.
    """
    A, k = mixing_matrix(c, seed, orthogonal)
    return eq.emphasis_metric(mixing_of_positions(A, spreads), k)


def three_metrics(
    c: float, spreads: tuple[float, float], orthogonal: bool = True
) -> tuple[NDArray, NDArray, NDArray]:
    """The metrics of DDNM, GMD and ProjFlow on the positions of one frame, each ``(66, 66)``."""
    plain = np.eye(3 * N_JOINTS)
    kinematic = np.kron(kinematic_joint_metric(), np.eye(3))
    return plain, metric_of_gmd(c, spreads, orthogonal), kinematic


class MetricFamily(widgets.VBox):
    """Three bodies pulled at one joint, each by the shortest way in its own metric.

    From left to right: DDNM, GMD, ProjFlow. The pull grows as the picture plays; the thin bodies
    stand where they stood.

    Args:
        spreads: of the place and of the body, metres, as an emphasised prior has them.
        pose: ``(22, 3)``, metres; by default a standing person.

    ``.bodies`` is the three at full pull, ``(3, 22, 3)``, and ``.numbers`` their rows of
    `COLUMNS`.
    """

    def __init__(self, spreads: tuple[float, float], pose: ArrayLike | None = None) -> None:
        self.spreads = spreads
        self.pose = standing_pose()[0] if pose is None else np.asarray(pose, float)
        slim = {"description_width": "80px"}
        self.joint = widgets.Dropdown(
            options=JOINTS, value="left_wrist", description="joint", style=slim,
            layout={"width": "220px"},
        )  # fmt: skip
        self.pull = [
            widgets.FloatSlider(
                value=value, min=-0.6, max=0.6, step=0.02, description=f"pull {axis}, m",
                style=slim, layout={"width": "280px"},
            )
            for axis, value in zip("xyz", (0.3, 0.2, 0.3), strict=True)
        ]  # fmt: skip
        self.c = widgets.FloatLogSlider(
            value=10, min=-1, max=2, step=0.1, description="emphasis c", style=slim,
            layout={"width": "280px"}, readout_format=".1f",
        )  # fmt: skip
        self.mixing = widgets.Dropdown(
            options=[("orthogonal", True), ("Gaussian, as in the paper", False)], value=True,
            description="A'", style=slim, layout={"width": "280px"},
        )  # fmt: skip
        camera = {"yaw": 0.3, "pitch": 0.15, "distance": 5.0, "target": [1.2, 0.85, 0.0]}
        self.viewer = Viewer(
            height=360, spread=1.2, playing=False, camera=camera, layout={"flex": "1 1 420px"}
        )
        self.table = widgets.HTML(layout={"flex": "1 1 330px"})
        wrap = {"flex_flow": "row wrap", "width": "100%", "grid_gap": "4px 12px"}
        super().__init__([
            widgets.Box([self.joint, *self.pull, self.c, self.mixing], layout=wrap),
            widgets.Box([self.viewer, self.table], layout=wrap),
        ])  # fmt: skip
        for control in (self.joint, *self.pull, self.c, self.mixing):
            control.observe(self._show, "value")
        self._show()
        self.viewer.frame = GROWING

    def _show(self, change: dict[str, Any] | None = None) -> None:
        """Pull anew: each body goes along a straight line, for the projection is linear."""
        R = three_metrics(self.c.value, self.spreads, self.mixing.value)
        pull = [slider.value for slider in self.pull]
        self.bodies = np.stack([pulled(self.pose, self.joint.value, pull, each) for each in R])
        grown = np.minimum(np.arange(GROWING + HELD) / GROWING, 1)[:, None, None]
        moving = self.pose + grown * (self.bodies - self.pose)[:, None]
        still = np.broadcast_to(self.pose, moving.shape[1:])
        at = self.viewer.spread * np.arange(3)[:, None, None, None] * [1.0, 0.0, 0.0]
        ghosts = [Motion(still + shift) for shift in at]
        names = ["from left to right: DDNM, GMD, ProjFlow", "the pose before", "", ""]
        self.viewer.show(Motion(moving), *ghosts, names=names)
        self.numbers = [self._row(body) for body in self.bodies]
        self.table.value = table(self.numbers)

    def _row(self, body: NDArray) -> tuple[float, ...]:
        away = 100 * np.linalg.norm(body - self.pose, axis=-1)
        before, after = (bone_lengths(each[None])[0] for each in (self.pose, body))
        worst = 100 * np.abs(after / before - 1).max()
        return float(away[0]), float(away[JOINTS.index("head")]), float(worst)


def table(numbers: list[tuple[float, ...]]) -> str:
    """What each body did, as HTML."""
    cell = '<td style="text-align: right; padding: 2px 8px">{:.1f}</td>'
    head = "".join(f'<th style="text-align: right; padding: 2px 8px">{c}</th>' for c in COLUMNS)
    lines = [
        f'<tr><td style="white-space: nowrap">{name}</td>'
        f"{''.join(cell.format(value) for value in row)}</tr>"
        for name, row in zip(NAMES, numbers, strict=True)
    ]
    return f"<table><tr><th></th>{head}</tr>{''.join(lines)}</table>"
