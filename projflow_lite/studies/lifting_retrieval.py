"""Motion retrieval: of clips that exist, the one whose drawing is nearest to the wanted one.

A stock of clips, of the kind that the prior was trained on, is drawn through the same camera. Those
whose captions share most words with the prompt are kept, and of them the one is taken whose drawn
points are nearest, as they stand. Sketch2Anim's own baseline compares learnt embeddings of text and
sketch instead.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from data_synth import Clips, make_clips
from projflow_lite.prior.text import words_of
from projflow_lite.studies.lifting_pictures import Shot

SIZE, KEPT = 4096, 64
"""Clips in stock, and how many captions are kept at least."""

SEED = 77_001
"""Of the stock: training data, like all seeds of `make_clips`."""


@cache
def stock(size: int, frames: int) -> Clips:
    """The clips to choose from."""
    return make_clips(size, frames, SEED)


def retrieve(
    clips: Clips, shot: Shot, drawings: NDArray, prompts: list[str], kept: int = KEPT
) -> NDArray:
    """A clip of the stock for every drawing, ``(drawings, frames, 22, 3)`` metres.

    Args:
        clips: the stock.
        shot: how it was drawn.
        drawings: ``(drawings, frames, 22, 2)``, metres.
        prompts: one for each drawing.
        kept: how many captions are kept at least; more where several fit equally well.
    """
    asked = shot.asked(drawings.shape[1])
    have, wanted = (
        d[:, asked].reshape(len(d), -1) for d in (shot.drawn(clips.positions), drawings)
    )
    squares = (have**2).sum(1) - 2 * wanted @ have.T  # and a constant for every drawing
    shared = common_words(prompts, clips.captions)
    least = np.sort(shared, axis=1)[:, -min(kept, shared.shape[1])]
    nearest = np.where(shared >= least[:, None], squares, np.inf).argmin(1)
    return clips.positions[nearest]


def common_words(prompts: list[str], captions: list[str]) -> NDArray[np.float64]:
    """Share of the words of either that both have, ``(prompts, captions)``, 0 to 1."""
    index: dict[str, int] = {}
    for text in prompts + captions:
        for word in words_of(text):
            index.setdefault(word, len(index))
    a, b = (np.zeros((len(texts), len(index))) for texts in (prompts, captions))
    for matrix, texts in ((a, prompts), (b, captions)):
        for k, text in enumerate(texts):
            matrix[k, [index[word] for word in words_of(text)]] = 1
    both = a @ b.T
    return both / np.maximum(a.sum(1)[:, None] + b.sum(1) - both, 1)
