"""How different are motions from each other: all of a set, and those made for one prompt?"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.skeleton import number_array, shown


def diversity(embeddings: ArrayLike, pairs: int = 300, seed: int = 0) -> float:
    """Mean distance of random pairs of a set. Best is not most, but as much as the data has.

    Args:
        embeddings: ``(motions, features)``.
        pairs: how many pairs are drawn; no motion is paired with itself.
        seed: of the draw.

    Raises:
        ValueError: for a wrong shape, fewer than two motions, or no pair.

    Source: HumanML3D's evaluation; ProjFlow's and BMM's tables.
    """
    e = as_embeddings(embeddings, pairs, "diversity")
    if e.ndim != 2 or len(e) < 2 or pairs < 1:
        raise ValueError(
            f"diversity: embeddings (at least 2, features) and a pair, not {e.shape} and {pairs}"
        )
    return float(pair_distances(e, pairs, np.random.default_rng(seed)).mean())


def multimodality(embeddings: ArrayLike, pairs: int = 10, seed: int = 0) -> float:
    """Mean distance of random pairs of motions that were made for one and the same prompt.

    Args:
        embeddings: ``(prompts, motions for each, features)``; the papers take 100 prompts.
        pairs: how many pairs are drawn for each prompt; no motion is paired with itself.
        seed: of the draw.

    Raises:
        ValueError: for a wrong shape, fewer than two motions a prompt, or no pair.

    Source: HumanML3D's evaluation; BMM eq. 7.
    """
    e = as_embeddings(embeddings, pairs, "multimodality")
    if e.ndim != 3 or len(e) < 1 or e.shape[1] < 2 or pairs < 1:
        raise ValueError(
            "multimodality: embeddings (prompts, at least 2, features) and a pair, "
            f"not {e.shape} and {pairs}"
        )
    random = np.random.default_rng(seed)
    return float(np.mean([pair_distances(one, pairs, random) for one in e]))


def pair_distances(points: NDArray, pairs: int, random: np.random.Generator) -> NDArray:
    """Distances ``(pairs,)`` between random points ``(points, features)`` and random others."""
    first = random.integers(len(points), size=pairs)
    second = (first + random.integers(1, len(points), size=pairs)) % len(points)
    return np.linalg.norm(points[first] - points[second], axis=-1)


def as_embeddings(embeddings: ArrayLike, pairs: int, who: str) -> NDArray:
    """Embeddings as finite numbers, or say that they, or the number of pairs, are none."""
    e = number_array(embeddings, f"{who}: embeddings").astype(float)
    if not np.isfinite(e).all():
        raise ValueError(f"{who}: an embedding is not finite")
    if isinstance(pairs, bool) or not isinstance(pairs, int | np.integer):
        raise ValueError(f"{who}: pairs is a whole number, not {shown(pairs)}")
    return e
