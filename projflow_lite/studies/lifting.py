"""From a drawing to a motion: ProjFlow's Table 2.

Captions of held-out clips, a drawing of their first pose, and drawings of the paths of their
joints, seen by a known camera. In the row "average" one path at a time is drawn and the six joints
have equal weight; in "cross" those of one to six joints at once. How near does a method come, in
the picture and in space, and what does the motion look like?

Three baselines are Sketch2Anim's, made anew and smaller, see the files ``lifting_retrieval.py``,
``lifting_depths.py`` and ``lifting_direct.py``; learning takes about two minutes. Sketch2Anim
itself is not here: it is a trained model of its own. All other methods are those of the study of
control, but for those that overwrite coordinates.

A full run takes many hours on a laptop, so every cell is stored as it is made.
``python -m projflow_lite.studies.lifting --help`` has all options, a graphics card among them.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import torch
from numpy.typing import NDArray

from data_synth import Clips, held_out
from projflow_lite.prior import Prior
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.studies.bench import Bench, Seeds, begin
from projflow_lite.studies.cells import (
    ALL,
    Cell,
    Features,
    Group,
    Rival,
    Scores,
    filled,
    quality,
    summarised,
)
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.lifting_figure import figure
from projflow_lite.studies.lifting_pictures import CROSS, JOINTS, Errors
from projflow_lite.studies.lifting_ways import (
    BASELINES,
    RIVALS_OF_LIFTING,
    Effort,
    Learnt,
    Made,
    make,
    school,
)
from projflow_lite.studies.lifting_words import COLUMNS, sentences, table
from projflow_lite.studies.shell import add_methods, asked_for, carry_out, chosen, options_of

__all__ = ["figure", "run", "sentences", "table"]

FOLDER = Path("runs/lifting")
SEEDS = Seeds(reference=9000, wished=10_000, others=11_000)

TIMED = "left_wrist", 16
"""What is timed: this task, on so many clips."""


class Protocol(NamedTuple):
    """How much is measured.

    Attributes:
        clips: motions of a cell, that is of a method, task and seed.
        seeds: each with other captions, cameras and noise, the same ones for every method.
        steps: of sampling.
        joints: whose paths are drawn, one at a time.
        rivals: the methods.
        effort: how much the baselines may learn.
    """

    clips: int = 64
    seeds: int = 3
    steps: int = 25
    joints: tuple[str, ...] = JOINTS
    rivals: tuple[Rival, ...] = RIVALS_OF_LIFTING
    effort: Effort = Effort()


CHEAP = ("no wish", "projflow", "ddnm", "flowdps", "dps", *(rival.name for rival in BASELINES))
QUICK = Protocol(
    32, 3, 10, ("pelvis", "left_wrist"),
    tuple(rival for rival in RIVALS_OF_LIFTING if rival.name in CHEAP), Effort(1024, 300, 300),
)  # fmt: skip
"""A first look: its intervals are wide, two joints stand for six, and the baselines learn less."""


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every method; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: how much is measured; None for the whole of it.
        folder: where results and what the baselines learnt are stored; results of another prior,
            evaluator, data, extent or effort lie apart in it. After a change of a method, take
            another folder.
        device: where the prior's network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        One record a row, held-out data first: ``joint`` (the task), ``method``, ``options`` and
        ``scores``, each with its ``mean``, its ``half width`` (95 %) and the ``values`` of all
        seeds. The task is a joint, "average" over joints, or "cross".

    Raises:
        ValueError: for fewer than 32 clips, or fewer than 2 seeds.
    """
    p = protocol or Protocol()
    bench = begin("lifting", prior, p, SEEDS, folder, device, f"-{p.effort.spelled}")
    learnt = school(FRAMES, p.effort, Path(folder))

    def measure(cell: Cell, seed: int) -> Scores:
        return measured(
            bench.velocity, bench.noise_std, cell, bench.wished(seed), p.steps, seed, learnt,
            bench.reference,
        )  # fmt: skip

    times = bench.times(p.rivals, partial(in_time, bench, learnt))
    cells = [Cell(task, ALL, rival) for task in (*p.joints, CROSS) for rival in p.rivals]
    found = filled(bench.place, cells, p.seeds, measure, progress)
    rows = summarised(found, groups_of(p), p.rivals, COLUMNS, bench.about)
    data = bench.data_row(
        lambda clips, seed: score(clips.positions, clips, None, bench.reference, seed), COLUMNS
    )
    return [data, *(row | times[row["method"]] for row in rows)]


def in_time(bench: Bench, learnt: Learnt, rival: Rival) -> Made:
    """The motions that are timed."""
    task, count = TIMED
    few = held_out(count, FRAMES, SEEDS.wished)
    steps = bench.about["steps"]
    return make(bench.velocity, bench.noise_std, rival, task, few, steps, 0, learnt)


def groups_of(p: Protocol) -> list[Group]:
    """A row for every joint, for all of them, and for several at once."""
    return [
        *(Group(joint, ALL, ((joint, ALL),)) for joint in p.joints),
        Group("average", ALL, tuple((joint, ALL) for joint in p.joints)),
        Group(CROSS, ALL, ((CROSS, ALL),)),
    ]


def measured(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    cell: Cell,
    wished: Clips,
    steps: int,
    seed: int,
    learnt: Learnt,
    reference: Features,
) -> dict[str, float]:
    """One cell: make the motions of one seed, and score them."""
    made = make(velocity, noise_std, cell.rival, cell.joint, wished, steps, seed, learnt)
    return score(made.positions, wished, made.errors, reference, seed)


def score(
    positions: NDArray, clips: Clips, errors: Errors | None, reference: Features, seed: int
) -> dict[str, float]:
    """The columns of the table, each over a whole set of clips; data itself has no errors."""
    row = quality(positions, clips.captions, reference, seed)
    if errors is not None:
        row |= {
            "MPJPE-2D": float(errors.pose_2d.mean()),
            "MPJPE-3D": float(errors.pose_3d.mean()),
            "average error 2D": float(errors.path_2d.mean()),
            "average error 3D": float(errors.path_3d.mean()),
            "residual": float(errors.residual.max()),
        }
    return {name: row[name] for name in COLUMNS if name in row}


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    usual = Protocol()
    parser = options_of("From a drawing to a motion.", FOLDER, usual)
    add_methods(parser, usual.rivals)
    options = parser.parse_args()
    rivals = chosen(usual.rivals, options.methods)
    protocol = asked_for(options, usual._replace(rivals=rivals), QUICK)
    carry_out("lifting", options, protocol, run, table, figure)


if __name__ == "__main__":
    main()
