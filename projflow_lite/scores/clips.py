"""Every score that a set of clips allows, in one call."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from projflow_lite.motion import Motion
from projflow_lite.scores.evaluator import Evaluator, load_evaluator
from projflow_lite.scores.likeness import frechet_distance, kinetic_features
from projflow_lite.scores.physics import (
    bone_length_error,
    foot_skating,
    mean_jerk,
    worst_acceleration,
)
from projflow_lite.scores.retrieval import matching_score, r_precision
from projflow_lite.scores.variety import diversity
from projflow_lite.skeleton import check_positions

CHOICES = 32
"""Captions to choose from in R-precision."""


def score_clips(
    positions: NDArray | Sequence[NDArray] | str | Path,
    captions: Sequence[str] | None = None,
    reference: NDArray | Sequence[NDArray] | None = None,
    evaluator: Evaluator | None = None,
    seed: int = 0,
) -> dict[str, float]:
    """Score a set of clips. Score real or held-out clips too: they do not reach zero either.

    Args:
        positions: ``(clips, frames, 22, 3)`` metres, y up, facing +z in frame 0, 20 frames a
            second; or a list of single clips ``(frames, 22, 3)`` of different lengths; or the path
            of a file written by `Motion.save`.
        captions: what each clip should show; by default the prompts in the file, if it has some.
        reference: clips of the data to compare with, the more the better.
        evaluator: what embeds; by default the shipped one.
        seed: of the pairs that are drawn for the diversity.

    Returns:
        Always ``bone error %``, ``worst acceleration`` (m/s², mean over clips), ``skating gmd``,
        ``skating bmm``, ``jerk`` (m/s³) and, of two clips or more, ``diversity``. With a reference
        ``FID`` and ``kinetic distance``. With captions ``matching`` and, of 32 clips or more,
        ``R top 1`` to ``R top 3``; clips that do not fill a batch of 32 do not count there.

    Raises:
        ValueError: for clips of a wrong shape, or another number of captions than of clips.
    """
    if isinstance(positions, str | Path):
        motions = list(Motion.load(positions))
        positions = [motion.positions for motion in motions]
        prompts = [motion.prompt for motion in motions if isinstance(motion.prompt, str)]
        captions = prompts if captions is None and len(prompts) == len(motions) else captions
    clips = as_list(positions)
    if captions is not None and len(captions) != len(clips):
        raise ValueError(f"score_clips: {len(captions)} captions for {len(clips)} clips")
    judge = load_evaluator() if evaluator is None else evaluator
    motion = judge.embed_motion(clips)
    row = physics(clips)
    if len(clips) > 1:
        row["diversity"] = diversity(motion, seed=seed)
    if reference is not None:
        data = as_list(reference)
        row["FID"] = frechet_distance(motion, judge.embed_motion(data))
        row["kinetic distance"] = frechet_distance(kinetic(clips), kinetic(data))
    if captions is not None:
        text = judge.embed_text(list(captions))
        row["matching"] = matching_score(text, motion)
        if len(clips) >= CHOICES:
            found = r_precision(text, motion, CHOICES)
            row |= {"R top 1": found.top1, "R top 2": found.top2, "R top 3": found.top3}
    return row


def physics(clips: Sequence[NDArray]) -> dict[str, float]:
    """Scores that need nothing but the clips, each a mean over them."""
    scored = {
        "bone error %": [100 * bone_length_error(clip) for clip in clips],
        "worst acceleration": [worst_acceleration(clip) for clip in clips],
        "skating gmd": [foot_skating(clip) for clip in clips],
        "skating bmm": [foot_skating(clip, definition="bmm") for clip in clips],
        "jerk": [mean_jerk(clip) for clip in clips],
    }
    return {name: float(np.mean(values)) for name, values in scored.items()}


def kinetic(clips: Sequence[NDArray]) -> NDArray:
    """Kinetic features ``(clips, 12)`` of clips of different lengths."""
    return np.stack([kinetic_features(clip) for clip in clips])


def as_list(positions: NDArray | Sequence[NDArray]) -> list[NDArray]:
    """Single clips ``(frames, 22, 3)``, checked."""
    clips = [check_positions(clip, "score_clips") for clip in positions]
    if not clips:
        raise ValueError("score_clips: there is no clip")
    for clip in clips:
        if clip.ndim != 3:
            raise ValueError(f"score_clips: a clip is (frames, 22, 3), not {clip.shape}")
    return clips
