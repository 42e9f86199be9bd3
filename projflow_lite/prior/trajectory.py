r"""The small model of GMD's first stage: where the pelvis goes on the ground, and nothing else.

A flow on trajectories z ``(batch, frames, 1, 2)``: one point, its x and z in metres. It is told a
prompt, and plans; the body comes in the second stage. A planner can be tiny: two numbers a frame
and no bones. Otherwise it is the prior: the same U-Net that draws splines, the same training.
"""

from __future__ import annotations

import json
from importlib.resources import as_file, files
from pathlib import Path

import torch

from projflow_lite.prior.checkpoint import description, pack, read, unpack, write
from projflow_lite.prior.model import Prior
from projflow_lite.prior.network import Network
from projflow_lite.skeleton import N_JOINTS

FORMAT = "projflow_lite trajectory model 1"
SHIPPED = "trajectory.safetensors"
GROUND = (0, 2)
"""The axes x and z."""


class TrajectoryNetwork(Network):
    """The network of the prior with 2 channels instead of 66, and no limbs.

    Args:
        words: size of the vocabulary, padding included.
        widths: channels at half and quarter frame rate.
        condition: length of the vector that carries flow time and prompt.
        mean: what was taken out of the trajectory to centre it; not needed here.
    """

    channels = len(GROUND)

    def __init__(
        self,
        words: int,
        widths: tuple[int, int] = (40, 64),
        condition: int = 96,
        mean: torch.Tensor | None = None,
    ) -> None:
        super().__init__(words, widths, condition)

    def see(self, x: torch.Tensor) -> torch.Tensor:
        """Trajectories as channels over time, ``(batch, 2, frames)``."""
        return x.flatten(2).mT

    def say(self, curves: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        """Trajectories from what was drawn; there are no limbs to even."""
        return curves.unsqueeze(2)


class TrajectoryModel(Prior):
    r"""A flow on trajectories ``(batch, frames, 1, 2)``, metres.

    Calling it gives the velocity, as with a `Prior`. `project` takes the trajectory out of a
    motion, `unproject` puts one into an otherwise empty motion.
    """

    network_type = TrajectoryNetwork
    points = (1, len(GROUND))

    def project(self, motion: torch.Tensor) -> torch.Tensor:
        """Take the trajectory out of motions: ``(..., 22, 3)`` to ``(..., 1, 2)``, metres.

        Raises:
            ValueError: for another shape.

        Source: GMD section 4 (c).
        """
        if motion.shape[-2:] != (N_JOINTS, 3):
            raise ValueError(
                f"project: expected shape (..., {N_JOINTS}, 3), got {tuple(motion.shape)}"
            )
        return motion[..., :1, list(GROUND)]

    def unproject(self, z: torch.Tensor) -> torch.Tensor:
        """Put trajectories into otherwise empty motions: ``(..., 1, 2)`` to ``(..., 22, 3)``.

        Everything but the pelvis' x and z is 0: this is no pose, it is where a pose should be.

        Raises:
            ValueError: for another shape.

        Source: GMD section 4 (d).
        """
        if z.shape[-2:] != self.points:
            raise ValueError(f"unproject: expected shape (..., 1, 2), got {tuple(z.shape)}")
        motion = z.new_zeros(*z.shape[:-2], N_JOINTS, 3)
        motion[..., :1, list(GROUND)] = z
        return motion


def save_trajectory_model(model: TrajectoryModel, path: str | Path) -> None:
    """Write a trajectory model to one file, weights in half precision.

    Args:
        model: what to save.
        path: where; replaced in one step.
    """
    tensors, about = pack(model)
    write(tensors, {"trajectory model": json.dumps({"format": FORMAT} | about)}, path)


def load_trajectory_model(path: str | Path | None = None) -> TrajectoryModel:
    """Load a trajectory model; without a path, the one shipped in the package.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if the file is damaged or is something else; the message names it.
    """
    if path is None:
        with as_file(files("projflow_lite.prior") / SHIPPED) as shipped:
            return load_trajectory_model(shipped)
    tensors, metadata = read(path)
    about = description(metadata, "trajectory model", FORMAT, path, "load_trajectory_model")
    return unpack(tensors, about, path, "load_trajectory_model", TrajectoryModel)
