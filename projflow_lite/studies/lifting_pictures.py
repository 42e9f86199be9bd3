"""What the study of lifting draws: one pose and the paths of some joints, seen by a known camera.

As in ProjFlow's section 4.3.2 all joints are drawn in frame 0, and a subset of them from there on,
here in every frame. The camera is a distant one; its pitch, yaw and scale are drawn from the
paper's ranges. A drawing is kept in metres: what the picture shows, divided by the camera's scale.
"""

from __future__ import annotations

from functools import reduce
from operator import and_
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from projflow_lite.constraints import Orthographic, Wish, lift
from projflow_lite.constraints.cameras import rotation
from projflow_lite.skeleton import CONTROLLED, N_JOINTS, joint_index

JOINTS = CONTROLLED
CROSS = "cross"
"""A task: the paths of a random choice of one to six of `JOINTS`, as Sketch2Anim's code draws it.
"""

PITCH, YAW, SCALE = (0.0, 30.0), (-45.0, 45.0), (0.8, 1.2)
"""Ranges of the camera, degrees and picture units a metre; its roll is 0 (section 5.1)."""


class Shot(NamedTuple):
    """How a batch of motions was drawn.

    Attributes:
        camera: where it was seen from.
        joints: indices of those whose paths are drawn, rising.
    """

    camera: Orthographic
    joints: tuple[int, ...]

    def drawn(self, positions: NDArray) -> NDArray[np.float64]:
        """The drawing ``(..., frames, 22, 2)`` of motions ``(..., frames, 22, 3)``, metres."""
        return self.camera.project(positions) / self.camera.scale

    def asked(self, frames: int) -> NDArray[np.bool_]:
        """Which points are in the drawing, ``(frames, 22)``."""
        shown = np.zeros((frames, N_JOINTS), dtype=bool)
        shown[0], shown[:, self.joints] = True, True
        return shown

    def wish(self, drawing: NDArray) -> Wish:
        """That the camera see a motion as it is drawn.

        Args:
            drawing: ``(frames, 22, 2)``, metres.
        """
        points, later = drawing * self.camera.scale, range(1, len(drawing))
        pose = [lift(self.camera, j, 0, points[0, j]) for j in range(N_JOINTS)]
        paths = [lift(self.camera, j, later, points[1:, j]) for j in self.joints]
        return reduce(and_, pose + paths)

    def targets(self, drawings: NDArray) -> NDArray[np.float64]:
        """Targets ``(clips, m)`` of the rows of `wish`, for drawings ``(clips, frames, 22, 2)``."""
        parts = [drawings[:, 0], *(drawings[:, 1:, j] for j in self.joints)]
        return np.concatenate([part.reshape(len(drawings), -1) for part in parts], axis=1)


def draw_camera(random: np.random.Generator) -> Orthographic:
    """A camera from the paper's ranges."""
    pitch, yaw, scale = (float(random.uniform(*bounds)) for bounds in (PITCH, YAW, SCALE))
    return Orthographic(pitch, yaw, 0.0, scale)


def draw_joints(random: np.random.Generator) -> tuple[int, ...]:
    """One to six of `JOINTS`, drawn without repetition."""
    chosen = random.choice(len(JOINTS), random.integers(1, len(JOINTS) + 1), replace=False)
    return tuple(sorted(joint_index(JOINTS[k]) for k in chosen))


def draw_shot(task: str, seed: int) -> Shot:
    """The shot of a batch: a camera, and the joint that the task names or, in `CROSS`, several."""
    random = np.random.default_rng([seed, 2])
    camera = draw_camera(random)
    joints = draw_joints(random) if task == CROSS else (joint_index(task, "lifting"),)
    return Shot(camera, joints)


def line_of_sight(camera: Orthographic) -> NDArray[np.float64]:
    """Unit vector ``(3,)`` from the body to the camera: what is measured along it is depth."""
    return rotation(camera.pitch, camera.yaw, camera.roll)[2]


def in_space(camera: Orthographic, drawing: NDArray, depth: NDArray) -> NDArray[np.float64]:
    """Points ``(..., 3)`` of space that are drawn at ``(..., 2)``, at a depth ``(...)``, metres."""
    axes = rotation(camera.pitch, camera.yaw, camera.roll)
    return np.concatenate([drawing, depth[..., None]], axis=-1) @ axes


class Errors(NamedTuple):
    """How far motions are from what was drawn, each ``(clips,)``.

    Attributes:
        pose_2d, pose_3d: mean distance of the joints in frame 0, each seen from its own pelvis:
            picture units, and metres. The papers' MPJPE.
        path_2d, path_3d: mean distance along the drawn paths, absolute: likewise.
        residual: largest miss of a drawn coordinate, metres.
    """

    pose_2d: NDArray
    pose_3d: NDArray
    path_2d: NDArray
    path_3d: NDArray
    residual: NDArray


def errors_of(shot: Shot, made: NDArray, drawn: NDArray) -> Errors:
    """How far motions are from those that were drawn.

    Args:
        shot: how the latter were drawn.
        made: ``(clips, frames, 22, 3)`` metres.
        drawn: the same shape.
    """
    flat = [shot.drawn(positions) for positions in (made, drawn)]
    asked, scale = shot.asked(made.shape[1]), shot.camera.scale
    miss = np.abs(flat[0] - flat[1])[:, asked]
    return Errors(
        scale * pose_distance(*flat),
        pose_distance(made, drawn),
        scale * np.linalg.norm(flat[0] - flat[1], axis=-1)[:, :, shot.joints].mean((1, 2)),
        np.linalg.norm(made - drawn, axis=-1)[:, :, shot.joints].mean((1, 2)),
        miss.reshape(len(made), -1).max(1),
    )


def pose_distance(a: NDArray, b: NDArray) -> NDArray:
    """Mean distance ``(clips,)`` of the joints in frame 0, each pose seen from its pelvis."""
    first, second = (x[:, 0] - x[:, 0, :1] for x in (a, b))
    return np.linalg.norm(first - second, axis=-1).mean(1)
