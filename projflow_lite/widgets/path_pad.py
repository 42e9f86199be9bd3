"""The path pad: draw a path with mouse, touch or keys in a plane measured in metres."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import anywidget
import numpy as np
import traitlets
from numpy.typing import ArrayLike, NDArray

from projflow_lite.motion import Motion
from projflow_lite.skeleton import CHAINS, JOINTS, check_positions, joint_index
from projflow_lite.widgets.front_end import float_bytes, module, pack, unpack

PLANES: dict[str, tuple[int, int]] = {"xy": (0, 1), "zy": (2, 1), "xz": (0, 2)}
"""The two world axes of each plane, across the page and up the page: ``positions[..., axes]``."""

BOUNDS: dict[str, tuple[float, float, float, float]] = {
    "xy": (-1.1, 1.1, 0.0, 2.1),
    "zy": (-0.8, 1.4, 0.0, 2.1),
    "xz": (-2.0, 2.0, -0.5, 3.5),
}
"""Across from, across to, up from, up to, metres: room to stand in, or for a few steps."""


class PathPad(anywidget.AnyWidget):
    """Draw a path in a plane of the world; `path` is what was drawn, in metres.

    Planes: ``"xy"`` the body seen from the front (its left, +x, on the right of the page),
    ``"zy"`` from its right side (forward, +z, to the right), ``"xz"`` from above (forward up the
    page, the body's left on the left).

    Args:
        plane: ``"xy"``, ``"zy"`` or ``"xz"``.
        samples: number of points of the path, usually one for each frame.
        bounds: across from, across to, up from, up to, metres; by default fits a standing person.
        smoothing: standard deviation of the Gaussian along the path, metres.
        timing: ``"even"`` spreads the points evenly, ``"drawn"`` keeps the rhythm of the hand.
        live: send the path while it is being drawn, too.
        height: height of the drawing in pixels.

    Raises:
        traitlets.TraitError: for a value outside these.

    ``version`` grows by one whenever a stroke is finished: observe it to react exactly once.
    """

    _esm = module("theme.js", "curve.js", "plane.js", "path_pad.js")
    _css = module("widgets.css")

    plane = traitlets.Enum(list(PLANES), "xy").tag(sync=True)
    bounds = traitlets.List(traitlets.Float()).tag(sync=True)
    samples = traitlets.Int(60).tag(sync=True)
    smoothing = traitlets.Float(0.03).tag(sync=True)
    timing = traitlets.Enum(["even", "drawn"], "even").tag(sync=True)
    live = traitlets.Bool(False).tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)

    path_data = float_bytes()
    version = traitlets.Int(0).tag(sync=True)

    reference: traitlets.List = traitlets.List().tag(sync=True)
    joint_path: traitlets.List = traitlets.List().tag(sync=True)
    joint_name = traitlets.Unicode("").tag(sync=True)

    def __init__(
        self, plane: str = "xy", bounds: Sequence[float] | None = None, **traits: Any
    ) -> None:
        # First the plane, which brings bounds of its own, then those asked for.
        super().__init__(plane=plane, **traits)
        self.bounds = list(BOUNDS[plane] if bounds is None else bounds)

    def __repr__(self) -> str:
        # Jupyter shows this text where the front end did not start.
        return f"PathPad: {self.samples} points, {self.plane}. No picture? Rerun the cell."

    @property
    def path(self) -> NDArray[np.float64] | None:
        """The drawn path, ``(samples, 2)``, metres in the axes of the plane; None when empty.

        Setting it (any number of points; None clears) draws it in the page.
        """
        return unpack(self.path_data, -1, 2) if self.path_data else None

    @path.setter
    def path(self, points: ArrayLike | None) -> None:
        with self.hold_sync():
            self.path_data = b"" if points is None else pack(spread(points, self.samples))
            self.version += 1

    def targets(self) -> NDArray[np.float64] | None:
        """The path in space, ``(samples, 3)``, metres, NaN on the axis across the plane."""
        if self.path is None:
            return None
        targets = np.full((len(self.path), 3), np.nan)
        targets[:, PLANES[self.plane]] = self.path
        return targets

    def show_reference(self, motion: Motion | NDArray, joint: str | int | None = None) -> None:
        """Draw a body behind the paper: its first pose, and the path of a joint.

        Args:
            motion: a Motion or positions ``(frames, 22, 3)``, metres.
            joint: the joint whose path to draw, by name or index.
        """
        positions = motion.positions if isinstance(motion, Motion) else motion
        flat = check_positions(positions, "show_reference")[..., PLANES[self.plane]]
        flat = flat.reshape(-1, *flat.shape[-3:])[0]
        with self.hold_sync():
            self.reference = [flat[0, list(chain)].tolist() for chain in CHAINS] + [head(flat[0])]
            if joint is None:
                self.joint_path, self.joint_name = [], ""
            else:
                index = joint_index(joint, "show_reference")
                self.joint_path = flat[:, index].tolist()
                self.joint_name = JOINTS[index].replace("_", " ")

    @traitlets.validate("samples")
    def _check_samples(self, proposal: dict[str, Any]) -> int:
        if not 2 <= proposal["value"] <= 2000:
            raise traitlets.TraitError(f"PathPad: samples must be 2..2000, got {proposal['value']}")
        return proposal["value"]

    @traitlets.validate("smoothing")
    def _check_smoothing(self, proposal: dict[str, Any]) -> float:
        if not 0 <= proposal["value"] <= 1:
            raise traitlets.TraitError(
                f"PathPad: smoothing must be 0..1 metres, got {proposal['value']}"
            )
        return proposal["value"]

    @traitlets.validate("bounds")
    def _check_bounds(self, proposal: dict[str, Any]) -> list[float]:
        value = proposal["value"]
        if len(value) != 4 or not np.isfinite(value).all():
            raise traitlets.TraitError(f"PathPad: bounds are 4 finite metres, got {value}")
        if value[1] - value[0] < 0.05 or value[3] - value[2] < 0.05:
            raise traitlets.TraitError(
                "PathPad: bounds are (across from, across to, up from, up to), "
                f"each pair growing by 5 cm or more, got {value}"
            )
        return value

    @traitlets.validate("reference")
    def _check_reference(self, proposal: dict[str, Any]) -> list[list[list[float]]]:
        return [polyline(line, "reference") for line in proposal["value"]]

    @traitlets.validate("joint_path")
    def _check_joint_path(self, proposal: dict[str, Any]) -> list[list[float]]:
        return polyline(proposal["value"], "joint_path")

    @traitlets.validate("path_data")
    def _check_path(self, proposal: dict[str, Any]) -> bytes:
        data = proposal["value"]
        if len(data) % 8:
            raise traitlets.TraitError(f"PathPad: {len(data)} bytes are not pairs of float32")
        if not np.isfinite(np.frombuffer(data, "<f4")).all():
            raise traitlets.TraitError("PathPad: the path has a value that is not finite")
        return data

    @traitlets.observe("plane")
    def _plane_changed(self, change: dict[str, Any]) -> None:
        """A path means nothing in another plane: start again with the bounds of the new one."""
        with self.hold_sync():
            self.bounds = list(BOUNDS[self.plane])
            self.reference, self.joint_path, self.joint_name = [], [], ""
            self.path_data = b""

    @traitlets.observe("samples")
    def _samples_changed(self, change: dict[str, Any]) -> None:
        if self.path is not None:
            self.path_data = pack(spread(self.path, self.samples))


def head(pose: NDArray) -> list[list[float]]:
    """A circle for the head of a flat pose ``(22, 2)``, metres."""
    neck, skull = pose[JOINTS.index("neck")], pose[JOINTS.index("head")]
    turns = np.linspace(0, 2 * np.pi, 25)[:, None]
    return (
        skull + 0.5 * (skull - neck) + 0.09 * np.hstack([np.cos(turns), np.sin(turns)])
    ).tolist()


def polyline(points: Sequence, who: str) -> list[list[float]]:
    """Points in the plane as plain lists, for JSON.

    Raises:
        traitlets.TraitError: if they are not finite pairs of numbers.
    """
    array = np.asarray(points, float).reshape(-1, 2) if len(points) == 0 else np.asarray(points)
    if array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
        raise traitlets.TraitError(f"PathPad: {who} needs finite (n, 2) points, got {array.shape}")
    return array.tolist()


def spread(points: ArrayLike, samples: int) -> NDArray[np.float64]:
    """Put `samples` points evenly along a polyline ``(n, 2)``; as it is if it has that many.

    Raises:
        ValueError: if the points are not ``(n, 2)``, n >= 1, and finite.
    """
    array = np.asarray(points, float)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) == 0 or not np.isfinite(array).all():
        raise ValueError(f"path: expected finite points (n, 2) in metres, got shape {array.shape}")
    if len(array) == samples:
        return array
    steps = np.linalg.norm(np.diff(array, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, along[-1], samples)
    return np.stack([np.interp(wanted, along, array[:, axis]) for axis in range(2)], axis=1)
