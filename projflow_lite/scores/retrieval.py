"""Does a motion show what its prompt says? Asked by finding the prompt among 32."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist


class RPrecision(NamedTuple):
    """Share of motions whose own text is the nearest, among the nearest two, and three.

    ``motions`` is how many of those given could be counted.
    """

    top1: float
    top2: float
    top3: float
    motions: int


def r_precision(
    text_embeddings: ArrayLike, motion_embeddings: ArrayLike, batch: int = 32
) -> RPrecision:
    """How often a motion's own text is found among those of its batch.

    The texts of a batch are ranked by their Euclidean distance to the motion. The order given
    decides who is in a batch; batches are exactly `batch` long, and what is left over at the end
    is dropped: ``motions`` of the result says how many counted. A guess is right in 1, 2 and 3 of
    32 cases. Texts at the very same distance, such as a caption that occurs twice, are taken in
    random order: what counts is the chance to be among the first.

    Args:
        text_embeddings: ``(motions, features)``.
        motion_embeddings: ``(motions, features)``, in the same order.
        batch: number of texts to choose from.

    Raises:
        ValueError: if the shapes differ, or there is not one whole batch.

    Source: HumanML3D's evaluation, as ProjFlow reports it.
    """
    text, motion = matched(text_embeddings, motion_embeddings, "r_precision")
    batches = len(text) // batch if batch > 1 else 0
    if batches == 0:
        raise ValueError(
            f"r_precision: {len(text)} motions do not fill one batch of {batch}; give more"
        )
    hits = np.zeros(3)
    for k in range(batches):
        part = slice(k * batch, (k + 1) * batch)
        distance = cdist(motion[part], text[part])
        own = distance.diagonal()[:, None]
        nearer, ties = (distance < own).sum(1), (distance == own).sum(1)
        hits += [np.clip((top - nearer) / ties, 0, 1).sum() for top in (1, 2, 3)]
    top1, top2, top3 = hits / (batches * batch)
    return RPrecision(float(top1), float(top2), float(top3), batches * batch)


def matching_score(text_embeddings: ArrayLike, motion_embeddings: ArrayLike) -> float:
    """Mean Euclidean distance between a motion and its own text; less is better.

    Args:
        text_embeddings: ``(motions, features)``.
        motion_embeddings: ``(motions, features)``, in the same order.

    Raises:
        ValueError: if the shapes differ or there is nothing to score.

    Source: HumanML3D's evaluation, as ProjFlow reports it.
    """
    text, motion = matched(text_embeddings, motion_embeddings, "matching_score")
    return float(np.linalg.norm(text - motion, axis=-1).mean())


def matched(text: ArrayLike, motion: ArrayLike, who: str) -> tuple[NDArray, NDArray]:
    """Both as arrays of one shape, or say what is wrong with them."""
    a, b = np.asarray(text, float), np.asarray(motion, float)
    if a.ndim != 2 or a.shape != b.shape or len(a) == 0:
        raise ValueError(
            f"{who}: texts {a.shape} and motions {b.shape} are not (motions, features)"
        )
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise ValueError(f"{who}: an embedding is not finite")
    return a, b
