r"""Imputation: overwrite what is known of a predicted motion (GMD section 4.1 (c)).

.. math:: \tilde x_1 = (1 - M) \odot \hat x_1 + M \odot y

Nothing else moves: where ProjFlow's metric spreads a correction over the body, this one hopes that
the network will follow in the steps to come. What it leaves behind depends on what a motion is
written in. Of joint positions the pelvis is one, and leaves the body. GMD's features say where the
pelvis is, and where other joints are as seen from it: there the body goes along, as it is, and its
feet slide. The latter is also a projection, with a metric in which limbs that keep their places as
seen from the pelvis cost nothing.
"""

from __future__ import annotations

import numpy as np
import torch

from projflow_lite.constraints import AXES, Wish, describe_row, is_coordinate
from projflow_lite.equations import point_to_point
from projflow_lite.skeleton import JOINTS, N_JOINTS

GROUND = (0, 2)
"""The axes x and z."""


class Imputation:
    """Coordinates that are known, and their values.

    Args:
        mask: ``(frames, joints, 3)`` booleans, True where a coordinate is known.
        values: same shape, or one set for each motion ``(batch, frames, joints, 3)``; metres,
            anything finite where the mask is False.
        along: whether the body goes along with its pelvis, as it does in GMD's features.
    """

    def __init__(self, mask: torch.Tensor, values: torch.Tensor, along: bool = False) -> None:
        self.mask, self.values, self.along = mask, values, along

    def __call__(self, x1_hat: torch.Tensor) -> torch.Tensor:
        """Overwrite ``(batch, frames, joints, 3)``."""
        moved = x1_hat + self.of_pelvis(self.values - x1_hat) if self.along else x1_hat
        return torch.where(self.mask, self.values, moved)

    @property
    def observed(self) -> torch.Tensor:
        """What is known as one tensor of the shape of `values`, NaN where nothing is."""
        return torch.where(self.mask, self.values, torch.nan)

    def protect(self, push: torch.Tensor) -> torch.Tensor:
        """Set a push to 0 wherever something is imputed."""
        free = push - self.of_pelvis(push) if self.along else push
        return torch.where(self.mask, 0.0, free)

    def of_pelvis(self, change: torch.Tensor) -> torch.Tensor:
        """How the pelvis changes where it is known, 0 elsewhere: ``(batch, frames, 1, 3)``."""
        return torch.where(self.mask[:, :1], change[..., :1, :], 0.0)

    def taking_along(self, along: bool) -> Imputation:
        """The same with the body going along, or not."""
        return Imputation(self.mask, self.values, along)

    def miss(self, x: torch.Tensor, p: float = 1.0) -> torch.Tensor:
        r"""How far motions are from what is known, ``(batch,)``: GMD eq. 12.

        Args:
            x: ``(batch, frames, joints, 3)``, metres.
            p: norm of the miss of one joint in one frame: 1, or 2 for its length.
        """
        e = torch.where(self.mask, x - self.values, 0.0)
        return torch.linalg.vector_norm(e, p, dim=-1).sum((1, 2))

    def over(self, other: Imputation) -> Imputation:
        """Both, and where both know a coordinate, this one."""
        values = torch.where(self.mask, self.values, other.values)
        return Imputation(self.mask | other.mask, values, self.along)

    def line(self) -> Imputation:
        """Straight lines over the ground between keyframes of the pelvis; what is known stays.

        Raises:
            ValueError: if the pelvis is pinned nowhere on the ground.

        Source: GMD section 5.2, the point-to-point trajectory.
        """
        mask, values = self.mask.clone(), self.values.clone()
        for axis in GROUND:
            keys = self.mask[:, 0, axis].nonzero()[:, 0].tolist()
            if len(keys):
                known = self.values[..., keys, 0, axis].reshape(-1, len(keys)).T
                z, between = point_to_point(keys, known, len(mask))  # one line for each motion
                mask[:, 0, axis] = torch.as_tensor(between[0].copy())
                values[..., 0, axis] = torch.as_tensor(z).view_as(values[..., 0, axis])
        if not mask[:, 0, GROUND].any():
            raise ValueError(
                "gmd: straight lines need keyframes of the pelvis, in x or z: pin some, or "
                "leave lines out with switch=0"
            )
        return self.over(Imputation(mask, values))


def known_coordinates(
    wish: Wish | None, frames: int, dtype: torch.dtype = torch.float32
) -> Imputation:
    """What a wish lets one overwrite: exact pins, and nothing else.

    Args:
        wish: pins; None knows nothing.
        frames: of the motion.
        dtype: of the motions.

    Raises:
        ValueError: for a row that is no exact pin, or pins that contradict each other.
    """
    mask = np.zeros(frames * N_JOINTS * 3, dtype=bool)
    values = np.zeros(frames * N_JOINTS * 3)
    if wish is not None:
        A, y, variance = wish.rows(frames)
        other = np.flatnonzero(~is_coordinate(A) | (variance > 0))
        if len(other):
            raise ValueError(
                f"gmd: imputation takes exact pins, but row {other[0]} ({describe_row(A, other[0])}"
                ") is not one; ask for it as a goal instead: goal=reach(wish)"
            )
        column = A.indices
        mask[column], values[column] = True, y
        clash = np.flatnonzero(np.abs(values[column] - y) > 1e-6)
        if len(clash):
            point, axis = divmod(column[clash[0]], 3)
            frame, joint = divmod(point, N_JOINTS)
            raise ValueError(
                f"gmd: two pins contradict each other: {JOINTS[joint]}, frame {frame}, "
                f"{AXES[axis]} = {y[clash[0]]:g} and {values[column[clash[0]]]:g}"
            )
    shape = (frames, N_JOINTS, 3)
    return Imputation(
        torch.as_tensor(mask).view(shape), torch.as_tensor(values, dtype=dtype).view(shape)
    )
