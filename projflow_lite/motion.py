"""The Motion a user gets back: joint positions, what was asked for, and how exactly it was met."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from projflow_lite.skeleton import FPS, bone_lengths, check_positions, joint_index, shown

if TYPE_CHECKING:
    from projflow_lite.constraints import Wish


@dataclass(frozen=True)
class Motion:
    """One motion, or a batch of motions made together.

    Attributes:
        positions: ``(frames, 22, 3)`` or ``(batch, frames, 22, 3)``, metres, y up.
        prompt: the text it was made from, or one text per motion of a batch.
        wish: the constraints it was made to obey, if any.
        fps: frames per second.

    Raises:
        ValueError: if the shape does not end in ``(frames, 22, 3)``, a value is not finite, or
            there is not one prompt for each motion.
    """

    positions: NDArray
    prompt: str | list[str] | None = None
    wish: Wish | None = field(default=None, repr=False)
    fps: float = FPS

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", check_positions(self.positions, "Motion"))
        texts = self.prompt if isinstance(self.prompt, list) else [self.prompt] * len(self)
        if len(texts) != len(self) or not all(isinstance(text, str | None) for text in texts):
            raise ValueError(
                f"Motion: one prompt for each of {len(self)} motions, not {shown(self.prompt)}"
            )
        if self.wish is not None and not hasattr(self.wish, "markers"):
            raise ValueError(f"Motion: not a wish: {shown(self.wish)}")
        if not isinstance(self.fps, int | float | np.number) or not 0 < self.fps < np.inf:
            raise ValueError(f"Motion: fps is a number above 0, not {shown(self.fps)}")

    @property
    def frames(self) -> int:
        """Number of frames."""
        return self.positions.shape[-3]

    @property
    def residual(self) -> float:
        """Largest ``|A x - y|`` over the hard rows of the wish, metres; 0 without a wish."""
        return 0.0 if self.wish is None else self.wish.residual(self.positions)

    def joint(self, joint: str | int) -> NDArray:
        """Path of one joint, ``(..., frames, 3)``, metres."""
        return self.positions[..., joint_index(joint, "Motion.joint"), :]

    def bone_lengths(self) -> NDArray:
        """Length of every bone in every frame, ``(..., frames, 21)``, metres."""
        return bone_lengths(self.positions)

    def __len__(self) -> int:
        """Number of motions: 1, or the size of the batch."""
        return int(np.prod(self.positions.shape[:-3]))

    def __getitem__(self, index: int) -> Motion:
        """One motion of a batch, counted from 0.

        Raises:
            IndexError: if the batch has no such motion.
            TypeError: if the index is no whole number.
        """
        if isinstance(index, bool) or not isinstance(index, int | np.integer):
            raise TypeError(f"Motion: an index is a whole number, not {shown(index)}")
        if not -len(self) <= index < len(self):
            raise IndexError(f"Motion: index {index} in a batch of {len(self)}")
        batch = self.positions.reshape(-1, *self.positions.shape[-3:])
        prompt = self.prompt[index] if isinstance(self.prompt, list) else self.prompt
        return replace(self, positions=batch[index], prompt=prompt)

    def __iter__(self) -> Iterator[Motion]:
        """Go through the motions of a batch one by one."""
        return (self[index] for index in range(len(self)))

    def save(self, path: str | Path) -> None:
        """Write positions, prompt and frame rate to an ``.npz`` file that needs no pickle."""
        prompts = [self.prompt] if isinstance(self.prompt, str) else (self.prompt or [])
        np.savez_compressed(
            path, positions=self.positions, fps=self.fps, prompt=np.array(prompts, dtype=str)
        )

    @classmethod
    def load(cls, path: str | Path) -> Motion:
        """Read a file written by `save`; the wish is not stored.

        Raises:
            FileNotFoundError: if there is no such file.
            ValueError: if the file is damaged or is not a motion; the message names it.
        """
        if isinstance(path, str | Path) and not Path(path).exists():
            raise FileNotFoundError(f"Motion.load: there is no file at {path}")
        try:
            with np.load(path, allow_pickle=False) as data:
                positions, fps = data["positions"], float(data["fps"])
                prompts = [str(text) for text in data["prompt"]]
            single = prompts[0] if len(prompts) == 1 else None
            return cls(positions, prompt=single if len(prompts) <= 1 else prompts, fps=fps)
        except Exception as error:
            reason = str(error).split(". ")[0]  # the first sentence says what, the others advise
            raise ValueError(
                f"Motion.load: {path} is not a readable motion file ({reason})"
            ) from error
