"""Prompts as numbers: a vocabulary of whole words, and a small encoder trained with the flow."""

from __future__ import annotations

import re
import warnings
from collections import Counter
from collections.abc import Iterable, Sequence

import torch
from torch import nn


def words_of(prompt: str) -> list[str]:
    """Split a prompt into lower-case words."""
    return re.findall(r"[a-z]+", prompt.lower())


class Vocabulary:
    """The words a prior has seen in training. Word 0 stands for padding.

    Args:
        words: every known word, each once.
    """

    def __init__(self, words: Sequence[str]) -> None:
        self.words = tuple(words)
        self.index = {word: i + 1 for i, word in enumerate(self.words)}

    @classmethod
    def of(cls, captions: Iterable[str]) -> Vocabulary:
        """The vocabulary of a set of captions, in alphabetical order."""
        return cls(sorted(Counter(word for text in captions for word in words_of(text))))

    def __len__(self) -> int:
        """Number of words, padding included."""
        return len(self.words) + 1

    def unknown(self, prompt: str) -> list[str]:
        """The words of a prompt that were never seen."""
        return [word for word in words_of(prompt) if word not in self.index]

    def encode(self, prompts: Sequence[str | None], reader: str = "prior") -> torch.Tensor:
        """Word numbers of several prompts, ``(prompts, longest)``, padded with 0.

        None stands for "no prompt" and becomes a row of zeros. Unknown words are left out, with a
        warning that names them and the `reader` that does not know them.
        """
        for prompt in dict.fromkeys(prompts):
            if prompt is not None and (never := self.unknown(prompt)):
                names = ", ".join(f"'{word}'" for word in never)
                warnings.warn(f"prompt: the {reader} never saw {names}; left out", stacklevel=3)
        rows = [
            [self.index[word] for word in words_of(prompt or "") if word in self.index]
            for prompt in prompts
        ]
        ids = torch.zeros(len(rows), max([1, *map(len, rows)]), dtype=torch.long)
        for i, row in enumerate(rows):
            ids[i, : len(row)] = torch.tensor(row, dtype=torch.long)
        return ids


class TextEncoder(nn.Module):
    """Word embeddings, each looking at its neighbours, averaged over the prompt.

    The neighbours matter: "left" means one thing before "hand" and another after "to the".

    Args:
        words: size of the vocabulary, padding included.
        width: length of the vector that stands for the prompt.
    """

    def __init__(self, words: int, width: int) -> None:
        super().__init__()
        self.embed = nn.Embedding(words, width, padding_idx=0)
        self.neighbours = nn.Conv1d(width, width, 3, padding=1)
        self.mix = nn.Sequential(nn.SiLU(), nn.Linear(width, width))
        self.nothing = nn.Parameter(torch.zeros(width))

    def forward(self, ids: torch.Tensor) -> torch.Tensor:
        """Word numbers ``(batch, words)`` to ``(batch, width)``; an empty row is no prompt."""
        known = (ids > 0).unsqueeze(-1).float()
        x = self.embed(ids)
        x = torch.nn.functional.silu(x + self.neighbours(x.mT).mT) * known
        mean = self.mix(x.sum(1) / known.sum(1).clamp(min=1))
        return torch.where(known.any(1), mean, self.nothing)
