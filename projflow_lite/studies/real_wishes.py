"""Wishes from outside: keyframes of recorded people, whom neither prior nor methods ever met.

The prior learned from synthetic motion, and all other studies take their keyframes from the same
source. Here they come from recorded clips, whose bodies are of other sizes and who move otherwise;
beside them, as many held-out synthetic clips. Recorded clips have no captions, so nobody gets a
prompt. What does each method give up: its keyframes, the likeness to what the prior has learned, or
bodies that stay whole?

The recorded clips come from a file of yours, see `recorded.HOLDS`. Of it nothing is kept but
scores. Clips are drawn anew for every seed, but out of one file: seeds share clips, and intervals
are of keyframes, noise and draws, not of other people.

``python -m projflow_lite.studies.real_wishes --help`` has all options.
"""

from __future__ import annotations

import hashlib
import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_synth import Clips, held_out
from projflow_lite.prior import Prior
from projflow_lite.scores import frechet_distance
from projflow_lite.studies import control
from projflow_lite.studies.bench import Bench, Seeds, begin, check_extent
from projflow_lite.studies.cells import (
    ALL,
    DATA,
    Cell,
    Features,
    Scores,
    features_of,
    over_seeds,
    quality,
)
from projflow_lite.studies.control import Protocol, errors_of, rows_of
from projflow_lite.studies.control_ways import OURS, RIVALS, Task, make
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.real_wishes_figure import figure
from projflow_lite.studies.real_wishes_words import COLUMNS, SOURCE, TO_RECORDED, sentences, table
from projflow_lite.studies.recorded import RECORDED, read_recorded
from projflow_lite.studies.shell import add_methods, asked_for, carry_out, chosen, options_of

__all__ = ["figure", "run", "sentences", "table"]

HELD_OUT = "held-out"
SEEDS = Seeds(reference=12_000, wished=13_000, others=14_000)

FULL = Protocol(
    joints=("pelvis", "left_wrist"), densities=(1, 5, FRAMES // 4), rivals=RIVALS + OURS,
    edit=False, clock=False,
)  # fmt: skip
QUICK = control.QUICK._replace(
    seeds=2, joints=("left_wrist",), rivals=control.QUICK.rivals[: len(RIVALS)], edit=False,
    clock=False,
)  # fmt: skip
"""A first look: wide intervals, one joint, one density, and DNO gets a tenth of its looks."""


def run(
    prior: Prior,
    real: str | Path | None,
    protocol: Protocol | None = None,
    folder: str | Path = control.FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every method on both kinds of wishes; see the module's docstring.

    Args:
        prior: what makes motions.
        real: the file of recorded clips, see `read_recorded`.
        protocol: `FULL` by default, or one like it; fewer clips if the file has fewer.
        folder: where results are stored, see `control.run`; those of other recorded clips lie
            apart in it.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        Records as of `control.run`, and beside them ``source``: "held-out", "recorded", and
        "recorded (known bones)" for clips whose bones were not guessed. The first ones are what
        held-out and recorded clips themselves score.

    Raises:
        FileNotFoundError, ValueError: as `read_recorded`.
        ValueError: as `control.run`.
    """
    p = protocol or FULL
    check_extent("real_wishes", p.clips, p.seeds)
    sets = read_recorded(real)
    p = p._replace(clips=min(p.clips, *(len(x) for x in sets.values())))
    extent = "-" + hashlib.sha256(sets[RECORDED].tobytes()).hexdigest()[:8]
    bench = begin("real_wishes", prior, p, SEEDS, folder, device, extent)
    recorded = features_of(sets[RECORDED])
    rows = [bench.data_row(partial(score_of_data, bench, recorded), COLUMNS) | {SOURCE: HELD_OUT}]
    rows += [recorded_row(bench, name, x) for name, x in sets.items()]
    wishes = {HELD_OUT: lambda seed: unprompted(held_out(p.clips, FRAMES, SEEDS.wished + seed)[0])}
    wishes |= {name: partial(drawn, x, p.clips) for name, x in sets.items()}
    for name, wished in wishes.items():
        folded = "-".join(re.findall(r"\w+", name))
        own = bench._replace(place=bench.place / folded, wished=wished)
        measure = partial(measured, recorded)
        rows += [row | {SOURCE: name} for row in rows_of(own, p, progress, measure, COLUMNS)]
    return rows


def unprompted(positions: NDArray) -> Clips:
    """Clips without captions."""
    nothing: Any = [None] * len(positions)
    return Clips(positions, nothing, [""] * len(positions), {})


def drawn(positions: NDArray, count: int, seed: int) -> Clips:
    """Some of the clips, other ones for every seed."""
    order = np.random.default_rng([seed, len(positions)]).permutation(len(positions))
    return unprompted(positions[order[:count]])


def measured(recorded: Features, bench: Bench, cell: Cell, seed: int) -> Scores:
    """One cell: sample one way with one seed, and score it."""
    clips, task = bench.wished(seed), Task(cell.joint, int(cell.keys), FRAMES)
    steps = bench.about["steps"]
    made = make(bench.velocity, bench.noise_std, cell.rival, task, clips, steps, seed)
    row = quality(made.positions, None, bench.reference, seed) | errors_of(made)
    row[TO_RECORDED] = frechet_distance(features_of(made.positions).points, recorded.points)
    return {name: row[name] for name in COLUMNS}


def score_of_data(bench: Bench, recorded: Features, clips: Clips, seed: int) -> Scores:
    """What held-out clips themselves score."""
    row = quality(clips.positions, None, bench.reference, seed)
    row[TO_RECORDED] = frechet_distance(features_of(clips.positions).points, recorded.points)
    return {name: row[name] for name in COLUMNS if name in row}


def recorded_row(bench: Bench, name: str, positions: NDArray) -> dict[str, Any]:
    """What recorded clips score; their distance to themselves says nothing, and is left out."""
    count, parts = bench.about["clips"], []
    for seed in range(bench.repeats):
        clips = drawn(positions, count, seed)
        parts.append(quality(clips.positions, None, bench.reference, seed))
    row = {"joint": ALL, "keys": ALL, "method": DATA, "options": {}, SOURCE: name}
    extent = bench.about | {"seeds": bench.repeats}
    return row | extent | {"scores": over_seeds(parts, COLUMNS)}


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    parser = options_of("Wishes of recorded people.", control.FOLDER, FULL)
    parser.add_argument("--real", type=Path, help="recorded clips (.npz)")
    add_methods(parser, FULL.rivals)
    options = parser.parse_args()
    full = FULL._replace(rivals=chosen(FULL.rivals, options.methods))
    work = partial(carried, options.real)
    carry_out("real-wishes", options, asked_for(options, full, QUICK), work, table, figure)


def carried(real: Path | None, prior: Prior, *what: Any) -> list[dict[str, Any]]:
    """`run` with its arguments in the order of all comparisons."""
    return run(prior, real, *what)


if __name__ == "__main__":
    main()
