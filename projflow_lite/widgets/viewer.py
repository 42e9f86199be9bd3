"""The viewer: a motion, its ghosts and what was asked of it, to turn, play and scrub."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import anywidget
import numpy as np
import traitlets
from numpy.typing import NDArray

from projflow_lite.motion import Motion
from projflow_lite.skeleton import joint_indices
from projflow_lite.widgets.front_end import float_bytes, module, pack

CAMERA = {"yaw", "pitch", "distance", "target", "orthographic"}
"""Angles in radians, metres from the eye to the target, its x, y, z; without perspective?"""


class Scene(NamedTuple):
    """What the front end draws: ``positions`` ``(bodies, frames, 22, 3)``, metres."""

    positions: NDArray
    names: list[str]
    solid: int


class Viewer(anywidget.AnyWidget):
    """An animated skeleton: play, scrub, orbit (drag), zoom (wheel), reset (double-click).

    Args:
        motion: the motion to show; of a batch the first is drawn full, the others as ghosts.
        *ghosts: motions to compare it with, drawn thin.
        trail: a joint, or several, whose path through space is drawn.
        follow: keep the pelvis in the middle of the picture.
        playing: start at once.
        speed: 1 is real time.
        height: height of the picture in pixels.
        spread: metres between neighbours of a batch; 0 draws them in one place.
        names: a name for each motion in the order given; the prompts if left out.

    Raises:
        ValueError: for an unknown joint, or something that is not a Motion.

    The kernel reads and sets ``frame``, ``playing``, ``speed``, ``follow``, ``loop``, ``height``
    and ``camera`` (a dict of yaw, pitch, distance, target, orthographic; empty: fit the motion).
    """

    _esm = module(
        "theme.js", "camera.js", "body.js", "markers.js", "viewer_grab.js", "viewer.js",
        "viewer_input.js",
    )  # fmt: skip
    _css = module("widgets.css")

    data = float_bytes()  # only Python sets what is shown: nothing of it needs an echo
    shape = traitlets.List(traitlets.Int()).tag(sync=True)
    fps = traitlets.Float(20.0).tag(sync=True)
    names = traitlets.List(traitlets.Unicode()).tag(sync=True)
    solid = traitlets.Int(1).tag(sync=True)
    markers = float_bytes()
    residual = traitlets.Float(None, allow_none=True).tag(sync=True, echo_update=False)

    frame = traitlets.Int(0).tag(sync=True)
    playing = traitlets.Bool(True).tag(sync=True)
    loop = traitlets.Bool(True).tag(sync=True)
    speed = traitlets.Float(1.0).tag(sync=True)
    follow = traitlets.Bool(False).tag(sync=True)
    trail_joints = traitlets.List(traitlets.Int()).tag(sync=True)
    camera = traitlets.Dict().tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)
    # Whether joints can be grabbed; and what was: {"joint", "frame", "at", "done", "count"}.
    grab = traitlets.Bool(False).tag(sync=True)
    pull: traitlets.Dict = traitlets.Dict().tag(sync=True, echo_update=False)

    def __init__(
        self,
        motion: Motion | None = None,
        *ghosts: Motion,
        trail: str | int | Sequence[str | int] | None = None,
        spread: float = 0.0,
        names: Sequence[str] | None = None,
        **traits: Any,
    ) -> None:
        self.spread = spread
        self._motion: Motion | None = None
        super().__init__(**traits)
        self.trail = trail
        if motion is not None:
            self.show(motion, *ghosts, names=names)

    def __repr__(self) -> str:
        # Jupyter shows this text where the front end did not start.
        frames = self.shape[1] if self.shape else 0
        return f"Viewer: {frames} frames. No picture? Rerun the cell, or trust the notebook."

    @property
    def motion(self) -> Motion | None:
        """The motion in focus; set it to replace the picture in place, ghosts and all."""
        return self._motion

    @motion.setter
    def motion(self, motion: Motion) -> None:
        self.show(motion)

    @property
    def trail(self) -> list[int]:
        """Joints whose path is drawn; set it to a name, an index, several of them, or None."""
        return list(self.trail_joints)

    @trail.setter
    def trail(self, joints: str | int | Sequence[str | int] | None) -> None:
        self.trail_joints = [] if joints is None else joint_indices(joints, "view")

    @traitlets.validate("camera")
    def _check_camera(self, proposal: dict[str, Any]) -> dict[str, Any]:
        camera = proposal["value"]
        unknown = set(camera) - CAMERA
        if unknown:
            raise traitlets.TraitError(
                f"Viewer: camera has no '{unknown.pop()}'; it has {', '.join(sorted(CAMERA))}"
            )
        if not all(np.isfinite(value).all() for value in camera.values()):
            raise traitlets.TraitError(f"Viewer: camera has a value that is not finite: {camera}")
        return camera

    @traitlets.validate("speed")
    def _check_speed(self, proposal: dict[str, Any]) -> float:
        if not 0 < proposal["value"] <= 10:
            raise traitlets.TraitError(f"Viewer: speed must be in 0..10, got {proposal['value']}")
        return proposal["value"]

    def show(self, motion: Motion, *ghosts: Motion, names: Sequence[str] | None = None) -> None:
        """Replace what is shown; camera, play state and frame stay as they are."""
        scene = arrange([motion, *ghosts], self.spread, names)
        with self.hold_sync():  # one message: the page never sees half of a change
            self.data = pack(scene.positions)
            self.shape = list(scene.positions.shape)
            self.names = scene.names
            self.solid = scene.solid
            self.fps = float(motion.fps)
            self.markers = pack(marker_records(motion))
            self.residual = None if motion.wish is None else float(motion.residual)
        self._motion = motion


def view(motion: Motion, *ghosts: Motion, **options: Any) -> Viewer:
    """Show a motion in the notebook, with others as ghosts; options as for `Viewer`."""
    return Viewer(motion, *ghosts, **options)


def arrange(motions: Sequence[Motion], spread: float, names: Sequence[str] | None) -> Scene:
    """Stack motions and batches into one scene; the shorter ones hold their last pose.

    Raises:
        ValueError: if something is not a Motion or the number of names is not right.
    """
    for motion in motions:
        if not isinstance(motion, Motion):
            raise ValueError(
                f"view: expected a Motion, got {type(motion).__name__}; "
                "wrap an array of positions as projflow_lite.Motion(positions)"
            )
    if names is not None and len(names) != len(motions):
        raise ValueError(f"view: {len(motions)} motions need as many names, got {len(names)}")
    singles = [single for motion in motions for single in motion]
    frames = max(single.frames for single in singles)
    bodies = []
    for place, single in enumerate(singles):
        held = np.minimum(np.arange(frames), single.frames - 1)
        shift = spread * place if place < len(motions[0]) else 0.0
        bodies.append(single.positions[held] + np.array([shift, 0.0, 0.0]))
    labels = name_bodies(motions, names)
    return Scene(np.stack(bodies), labels, len(motions[0]) if spread else 1)


def name_bodies(motions: Sequence[Motion], names: Sequence[str] | None) -> list[str]:
    """One label for each body: the given names, or the prompt of the motion in focus."""
    labels: list[str] = []
    for place, motion in enumerate(motions):
        if names is not None:
            labels += [names[place]] + [""] * (len(motion) - 1)
        else:
            first = next(iter(motion)).prompt if place == 0 else None
            labels += [str(first or "")] + [""] * (len(motion) - 1)
    return labels


def marker_records(motion: Motion) -> NDArray[np.float64]:
    """What the page draws for each marker of the wish, ``(k, 7)``.

    Columns: joint, frame, target x, y, z (metres, NaN where free), standard deviation (metres),
    residual: the largest distance along a constrained axis, metres, worst of a batch.
    """
    wish: Any = motion.wish
    if wish is None:
        return np.empty((0, 7))
    markers = wish.markers(motion.frames)
    joint, frame = np.asarray(markers.joint, int), np.asarray(markers.frame, int)
    target = np.asarray(markers.target, float).reshape(len(joint), 3)
    batch = motion.positions.reshape(-1, *motion.positions.shape[-3:])
    distance = np.abs(batch[:, frame, joint] - target)
    residual = np.where(np.isnan(distance), 0.0, distance).max(axis=(0, 2), initial=0.0)
    return np.column_stack([joint, frame, target, np.asarray(markers.std, float), residual])
