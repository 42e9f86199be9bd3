"""A small judge of motion and text: both become points, and what belongs together lies close.

The papers' FID and R-precision are measured in the space of a network trained on HumanML3D. This
one is trained on the synthetic motion of the package, so its numbers compare rows of one table and
are not comparable with those of a paper. How it was trained: evaluator_training.py.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import as_file, files
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional

from projflow_lite.prior.checkpoint import description, read, write
from projflow_lite.prior.text import TextEncoder, Vocabulary, words_of
from projflow_lite.skeleton import FPS, N_JOINTS, check_positions, shown

FORMAT = "projflow_lite evaluator 1"
SHIPPED = "evaluator.safetensors"
SHORTEST, LONGEST = 20, 196
CHANNELS = 2 * 3 * N_JOINTS


@dataclass(frozen=True)
class Sizes:
    """Sizes of the network: channels of each motion layer, of the text encoder, of a point."""

    motion: Sequence[int] = (128, 192, 192)
    text: int = 128
    embedding: int = 64


class MotionEncoder(nn.Module):
    """Three convolutions over time, each of which halves the frame rate, then mean and maximum."""

    def __init__(self, sizes: Sizes) -> None:
        super().__init__()
        self.mean: torch.Tensor
        self.std: torch.Tensor
        self.register_buffer("mean", torch.zeros(CHANNELS, 1))
        self.register_buffer("std", torch.ones(CHANNELS, 1))
        widths = (CHANNELS, *sizes.motion)
        self.convolutions = nn.ModuleList(
            nn.Conv1d(inputs, outputs, 5, stride=2, padding=2)
            for inputs, outputs in pairwise(widths)
        )
        self.out = nn.Sequential(
            nn.Linear(2 * widths[-1], widths[-1]), nn.SiLU(), nn.Linear(widths[-1], sizes.embedding)
        )

    def forward(self, positions: torch.Tensor) -> torch.Tensor:
        """``(batch, frames, 22, 3)`` metres to ``(batch, embedding)``; any number of frames."""
        x = (channels(positions) - self.mean) / self.std
        for convolution in self.convolutions:
            x = functional.silu(convolution(x))
        return self.out(torch.cat([x.mean(-1), x.amax(-1)], dim=1))


def channels(positions: torch.Tensor) -> torch.Tensor:
    """Where the joints are, seen from below the pelvis of frame 0, and how fast they move.

    Args:
        positions: ``(batch, frames, 22, 3)`` metres.

    Returns:
        ``(batch, 132, frames)``, metres and metres a second.
    """
    ground = positions[:, :1, :1] * torch.tensor([1.0, 0.0, 1.0])
    speed = positions.diff(dim=1) * FPS
    speed = torch.cat([speed[:, :1], speed], dim=1)
    return torch.cat([(positions - ground).flatten(2), speed.flatten(2)], dim=2).mT


class Evaluator(nn.Module):
    """Places motions and captions in one space, where Euclidean distance says how well they fit.

    Args:
        vocabulary: the words it was trained with.
        sizes: of the network.
        recipe: how it was trained, for the record.
    """

    def __init__(
        self, vocabulary: Vocabulary, sizes: Sizes | None = None, recipe: dict | None = None
    ) -> None:
        super().__init__()
        self.vocabulary, self.sizes, self.recipe = vocabulary, sizes or Sizes(), recipe or {}
        self.motion = MotionEncoder(self.sizes)
        self.text = nn.Sequential(
            TextEncoder(len(vocabulary), self.sizes.text),
            nn.Linear(self.sizes.text, self.sizes.embedding),
        )

    @torch.inference_mode()
    def embed_motion(self, positions: NDArray | Sequence[NDArray]) -> NDArray:
        """Points of motions.

        Args:
            positions: ``(motions, frames, 22, 3)`` metres, facing +z in frame 0, 20 frames a
                second; or a list of single motions ``(frames, 22, 3)`` of different lengths.

        Returns:
            ``(motions, 64)``.

        Raises:
            ValueError: for another shape, values that are not finite, or a length outside 20..196.
        """
        clips = [check_positions(clip, "embed_motion") for clip in positions]
        lengths = np.array([clip.shape[-3] for clip in clips])
        for frames in lengths[(lengths < SHORTEST) | (lengths > LONGEST)]:
            raise ValueError(f"embed_motion: {frames} frames; it takes {SHORTEST} to {LONGEST}")
        points = np.zeros((len(clips), self.sizes.embedding), np.float32)
        for frames in np.unique(lengths):
            places = np.flatnonzero(lengths == frames)
            for part in np.split(places, range(256, len(places), 256)):
                together = np.stack([clips[k] for k in part]).astype(np.float32)
                points[part] = self.motion(torch.from_numpy(together)).numpy()
        return points

    @torch.inference_mode()
    def embed_text(self, captions: Sequence[str]) -> NDArray:
        """Points of captions, ``(captions, 64)``; equal captions have equal points.

        Words that it does not know are left out, with a warning that names them.

        Raises:
            ValueError: if what is given is not a list of texts, or none of a caption is known.
        """
        if isinstance(captions, str) or not all(isinstance(text, str) for text in captions):
            raise ValueError("embed_text: captions is a list of texts, one for each motion")
        unique = list(dict.fromkeys(captions))
        known = [self.known_part(text) for text in unique]
        points = self.text(self.vocabulary.encode(known)).numpy()
        place = {text: k for k, text in enumerate(unique)}
        return points[[place[text] for text in captions]]

    def known_part(self, caption: str) -> str:
        """The words of a caption that the evaluator learnt."""
        if unknown := self.vocabulary.unknown(caption):
            names = ", ".join(f"'{word}'" for word in dict.fromkeys(unknown))
            warnings.warn(f"evaluator: it never saw {names}; left out", stacklevel=3)
        known = [word for word in words_of(caption) if word in self.vocabulary.index]
        if not known:
            raise ValueError(f"evaluator: it knows no word of '{caption}'")
        return " ".join(known)


def save_evaluator(evaluator: Evaluator, path: str | Path) -> None:
    """Write an evaluator, its words and its recipe to one file, in half precision."""
    tensors = {k: v.detach().half().contiguous() for k, v in evaluator.state_dict().items()}
    about = {
        "format": FORMAT,
        "words": evaluator.vocabulary.words,
        "sizes": asdict(evaluator.sizes),
        "recipe": evaluator.recipe,
    }
    write(tensors, {"evaluator": json.dumps(about)}, path)


def load_evaluator(path: str | Path | None = None) -> Evaluator:
    """Load an evaluator; without a path, the one shipped in the package.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if the file is damaged or is not an evaluator; the message names it.
    """
    if path is None:
        return shipped()
    tensors, metadata = read(path)
    about = description(metadata, "evaluator", FORMAT, path, "load_evaluator")
    try:
        sizes = Sizes(**about["sizes"])
        evaluator = Evaluator(Vocabulary(about["words"]), sizes, about["recipe"])
        evaluator.load_state_dict({name: value.float() for name, value in tensors.items()})
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        reason = shown(str(error).splitlines()[-1].strip())
        raise ValueError(f"load_evaluator: {path} does not fit its own sizes: {reason}") from error
    return evaluator.eval().requires_grad_(False)


@cache
def shipped() -> Evaluator:
    """The evaluator in the package, read once."""
    with as_file(files("projflow_lite.scores") / SHIPPED) as path:
        return load_evaluator(path)
