"""The data card: synthetic motion beside recorded motion, in numbers, pictures and a test.

Without a file of recorded motion the card has the synthetic columns only. Of recorded motion
nothing is written but statistics over many clips.
"""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_synth import ACTIONS, held_out, make_clips
from data_synth.angles import HUMAN, joint_angles
from data_synth.captions import SAID, phrases
from data_synth.card import statistics
from data_synth.two_sample import KINDS, two_sample_test
from projflow_lite.prior.text import words_of
from projflow_lite.scores import foot_skating
from projflow_lite.skeleton import FPS, JOINTS, MASS, N_JOINTS
from projflow_lite.studies import data_card_figures as figures
from projflow_lite.studies.data_card_words import card

FAMILIES: dict[str, tuple[str, ...]] = {
    "locomotion": (
        "walk", "run", "jog", "sneak", "walk_backward", "sidestep", "walk_curve", "walk_turn",
        "walk_start", "walk_stop",
    ),
    "whole body": (
        "march", "turn", "jump", "hop", "squat", "sit", "bow", "lunge", "kick", "balance",
    ),
    "hands": (
        "wave", "reach", "point", "clap", "throw", "punch", "carry", "draw", "raise_arms",
    ),
    "two at once, and at ease": (
        "walk_and_wave", "walk_and_point", "walk_and_carry", "sway", "idle",
    ),
}  # fmt: skip
"""Every action, in the family it belongs to."""

FULL = {"walk": 400, "run": 200, "jump": 200, "all": 20 * len(ACTIONS)}
QUICK = {"walk": 60, "run": 40, "jump": 40, "all": 2 * len(ACTIONS)}
"""How many synthetic clips of each set are measured."""

FRAMES = 60
SHORTEST = 25
"""Frames; a recorded clip that is shorter has too few steps to measure."""

MOST_TOLD = 10
"""How many of the features that tell two sets apart are kept."""

FLYING = 0.02
"""Metres that both toes are above their usual lowest place in a flight."""

CONTROLS = 4
"""Pairs of synthetic sets for the two-sample test that should find nothing."""

OWN = "walk, own bones"
"""Recorded walks whose subject's own bone lengths were known."""

Sets = dict[str, list[NDArray]]


def run(out: str | Path, real: str | Path | None = None, quick: bool = False) -> dict[str, Any]:
    """Measure and draw everything, and write the card.

    Args:
        out: a folder; ``data-card.md``, ``pictures/data_card_*.png`` and
            ``results/data-card.json`` are written into it.
        real: an ``.npz`` file of recorded motion, see `read_real`; None for a card without it.
        quick: a tenth of the clips, and only the first control of the two-sample test.

    Returns:
        ``card`` and ``results``, the paths that were written; ``pictures``, a list of paths; and
        ``rows``, the numbers.

    Raises:
        FileNotFoundError: if there is no such file of recorded motion.
        ValueError: if it does not hold what `read_real` asks for.
    """
    out = Path(out)
    recorded = None if real is None else read_real(real)
    counts = QUICK if quick else FULL
    made = {
        name: list(held_out(count, FRAMES, 0, None if name == "all" else [name]).positions)
        for name, count in counts.items()
    }
    numbers: dict[str, Any] = {"recorded from": None if real is None else source_of(real)}
    numbers |= measure(made, recorded, quick)
    for folder in ("pictures", "results"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    pictures = figures.draw(out / "pictures", made, recorded, FAMILIES)
    results = out / "results" / "data-card.json"
    results.write_text(json.dumps(plain(numbers), indent=1) + "\n", encoding="utf-8")
    path = out / "data-card.md"
    path.write_text(card(numbers, pictures, FAMILIES), encoding="utf-8")
    written = [str(picture) for picture in pictures.values()]
    return {"card": str(path), "results": str(results), "pictures": written, "rows": numbers}


def read_real(path: str | Path) -> Sets:
    """Recorded clips by what they show: ``all``, and ``walk``, ``run`` and ``jump`` if labelled.

    Args:
        path: an ``.npz`` file, metres, y up, 20 frames a second, the joints in the order of
            `JOINTS`. It holds ``x60`` ``(n, 60, 22, 3)`` and, if there are, ``label60`` ``(n,)``
            words; ``skeleton60`` ``(n,)``, "nearest" where bone lengths were guessed; ``xshort``
            ``(m, frames, 22, 3)`` with ``label_short`` and ``len_short``, clips of fewer frames
            and how many count; ``x60_hml``, the same on HumanML3D's bones.

    Returns:
        Lists of clips ``(frames, 22, 3)``; ``all`` has those of 60 frames only, ``hml`` the ones
        on HumanML3D's bones, and `OWN` the walks without guessed bone lengths.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it has no ``x60`` of that shape.
    """
    with np.load(path, allow_pickle=False) as file:
        held = {name: file[name] for name in file.files}
    x = held.get("x60")
    if x is None or x.ndim != 4 or x.shape[1:] != (FRAMES, N_JOINTS, 3):
        raise ValueError(f"data_card: {path} has no array x60 (clips, {FRAMES}, {N_JOINTS}, 3)")
    labels = [str(label) for label in held.get("label60", [""] * len(x))]
    clips = list(zip(labels, x, strict=True))
    short = ("xshort", "label_short", "len_short")
    if all(name in held for name in short):
        rows = zip(*(held[name] for name in short), strict=True)
        clips += [(str(label), clip[:length]) for clip, label, length in rows]
    sets = {"all": list(x), "hml": list(held.get("x60_hml", []))}
    for name in ("walk", "run", "jump"):
        sets[name] = [c for label, c in clips if label.startswith(name) and len(c) >= SHORTEST]
    known = held.get("skeleton60", np.full(len(x), "unsaid")) != "nearest"
    if not known.all():
        sets[OWN] = [
            c for (label, c), own in zip(clips, known, strict=False) if label == "walk" and own
        ]
    return {name: of for name, of in sets.items() if of}


def source_of(path: str | Path) -> str:
    """Whom to thank for recorded motion: what its file says of itself, or its name."""
    with np.load(path, allow_pickle=False) as file:
        said = " ".join(str(file[name]) for name in ("licence", "source") if name in file.files)
    return CMU if "mocap.cs.cmu.edu" in said else Path(path).name


CMU = (
    "CMU motion capture, obtained from mocap.cs.cmu.edu; the database was created with funding "
    "from NSF EIA-0196217"
)


def measure(made: Sets, recorded: Sets | None, quick: bool) -> dict[str, Any]:
    """All numbers of the card."""
    real = recorded or {}
    sets = {
        f"{kind}, {name}": statistics(source[name])
        for name in ("walk", "run", "all")
        for kind, source in (("synthetic", made), ("recorded", real))
        if name in source
    }
    return {
        "quick": quick,
        "clips a second": clips_a_second(),
        "captions": caption_numbers(),
        "sets": sets,
        "skating": {
            f"{kind}, {name}": float(np.mean([foot_skating(clip) for clip in source[name]]))
            for name in ("walk", "all")
            for kind, source in (("synthetic", made), ("recorded", real))
            if name in source
        },
        "hml bones": statistics(real["hml"])["bones"] if "hml" in real else None,
        "angles": angle_numbers(made["all"], real.get("all")),
        "flight": {
            f"{kind}, {name}": flight(source[name])
            for name in ("jump", "run")
            for kind, source in (("synthetic", made), ("recorded", real))
            if name in source
        },
        "recorded walks": len([c for c in real.get("walk", []) if len(c) == FRAMES]),
        "two-sample": told_apart(made, real, 1 if quick else CONTROLS),
    }


def clips_a_second(clips: int = 10 * len(ACTIONS), rounds: int = 3) -> float:
    """Clips of 60 frames that one core makes in a second of its own time, best of some rounds."""
    best = math.inf
    for seed in range(rounds):
        start = time.process_time()
        make_clips(clips, FRAMES, seed)
        best = min(best, time.process_time() - start)
    return clips / best


def caption_numbers() -> dict[str, int]:
    """How many ways there are to say things."""
    words = {word for text in phrases() for word in words_of(text)}
    ways = [len(texts) for texts in SAID.values()]
    return {
        "actions": len(ACTIONS), "cases": len(SAID), "wordings": sum(ways),
        "fewest wordings of a case": min(ways), "words": len(words),
    }  # fmt: skip


def angle_numbers(made: list[NDArray], real: list[NDArray] | None) -> dict[str, Any]:
    """Least and most of every angle, degrees, beside what is asked for."""
    rows: dict[str, Any] = {name: {"asked": list(limits)} for name, limits in HUMAN.items()}
    for kind, clips in (("synthetic", made), ("recorded", real)):
        if clips is not None:
            for name, values in joint_angles(np.stack(clips)).items():
                rows[name][kind] = [float(values.min()), float(values.max())]
    return rows


def flight(clips: list[NDArray]) -> dict[str, Any]:
    """Median acceleration upwards while both feet are in the air, m/s².

    A frame counts if the feet are off the floor in it and in both its neighbours.
    """
    feet = [JOINTS.index("left_foot"), JOINTS.index("right_foot")]
    of_pelvis: list[NDArray] = []
    of_mass: list[NDArray] = []
    for clip in clips:
        x = np.asarray(clip, float)
        height = x[:, feet, 1]
        aloft = (height > np.percentile(height, 10, axis=0) + FLYING).all(-1)
        flying = aloft[:-2] & aloft[1:-1] & aloft[2:]
        for falls, y in ((of_pelvis, x[:, 0, 1]), (of_mass, x[:, :, 1] @ np.array(MASS))):
            falls.append(np.diff(y, 2)[flying] * FPS**2)
    pelvis, mass = np.concatenate(of_pelvis), np.concatenate(of_mass)
    medians = [float(np.median(part)) if len(part) else math.nan for part in (pelvis, mass)]
    return {"frames": len(pelvis), "pelvis": medians[0], "centre of mass": medians[1]}


def told_apart(made: Sets, real: Sets, controls: int) -> dict[str, Any]:
    """Two-sample tests: against recorded clips, and of synthetic ones against each other."""
    rows: dict[str, Any] = {}
    for name in ("walk", OWN, "all"):
        theirs = [clip for clip in real.get(name, []) if len(clip) == FRAMES]
        if len(theirs) >= 10:
            rows[name] = compared(np.stack(made[name.split(",")[0]]), np.stack(theirs))
    accuracies = []
    for k in range(controls):
        a, b = (held_out(100, FRAMES, seed, ["walk"]).positions for seed in (2 * k + 1, 2 * k + 2))
        accuracies.append(two_sample_test(a, b)["accuracy"])
    return {
        "recorded": rows, "control": {"pairs": controls, "accuracy": float(np.mean(accuracies))},
    }  # fmt: skip


def compared(made: NDArray, recorded: NDArray) -> dict[str, Any]:
    """One two-sample test with all features and one with each kind of them."""
    found = two_sample_test(made, recorded)
    kinds = {kind: two_sample_test(made, recorded, kinds=[kind]) for kind in KINDS}
    return {
        "synthetic clips": len(made),
        "recorded clips": len(recorded),
        "accuracy": found["accuracy"],
        "interval": list(found["interval"]),
        "features": found["features"][:MOST_TOLD],
        "kinds": {
            kind: {"accuracy": row["accuracy"], "interval": list(row["interval"])}
            for kind, row in kinds.items()
        },
    }


def plain(value: Any) -> Any:
    """The same with numbers rounded to four digits that count, and None for what is no number."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if isinstance(value, float):
        return float(f"{value:.4g}") if math.isfinite(value) else None
    return value
