"""Every method of control on one prior and one protocol: ProjFlow's Tables 1, 3, 6 and 7.

Captions of held-out clips, and where one joint of those clips is in 1, 2, 5, a quarter and all of
their frames. How near does a method come, what does the motion look like afterwards, and what does
it cost? And, as in the last rows of those tables, the lower body is given in every frame, and the
prompt moves the rest. The paper compares methods on different priors with different metric code;
here they share everything but themselves. Two rivals were trained for control, and bring networks
of their own that began with the same prior (`control_models`).

A full run takes many hours on a laptop, so every cell of the table is stored as it is made: an
interrupted run goes on from where it was, and more seeds narrow the intervals of a finished one.
``python -m projflow_lite.studies.control --help`` has all options, a graphics card among them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from data_synth import Clips, held_out
from projflow_lite.prior import Prior
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.scores import control_errors
from projflow_lite.skeleton import CONTROLLED
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
from projflow_lite.studies.control_figure import figure
from projflow_lite.studies.control_models import Models, field_of, said_of
from projflow_lite.studies.control_ways import (
    ABLATIONS,
    EDIT,
    OURS,
    QUICK_DNO,
    RIVALS,
    TRAINED,
    TUNED,
    Made,
    Task,
    make,
)
from projflow_lite.studies.control_words import COLUMNS, sentences, table
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.shell import add_methods, asked_for, carry_out, chosen, options_of

__all__ = ["figure", "run", "sentences", "table"]

FOLDER = Path("runs/control")
JOINTS = CONTROLLED
DENSITIES = (1, 2, 5, FRAMES // 4, FRAMES)
REFERENCE, WISHED, OTHERS = 4000, 5000, 6000
SEEDS = Seeds(REFERENCE, WISHED, OTHERS)

TIMED = Task("pelvis", 5, FRAMES), 16
"""What is timed: this task, on so many clips."""


class Protocol(NamedTuple):
    """How much is measured.

    Attributes:
        clips: motions of a cell, that is of a method, joint, density and seed.
        seeds: each with other captions, keyframes and noise, the same ones for every method.
        steps: of sampling.
        joints, densities: of the keyframes.
        rivals: the methods.
        edit: whether the upper body is edited too, with the lower body given in every frame.
        clock: whether methods are timed.
    """

    clips: int = 64
    seeds: int = 3
    steps: int = 25
    joints: tuple[str, ...] = JOINTS
    densities: tuple[int, ...] = DENSITIES
    rivals: tuple[Rival, ...] = RIVALS + OURS + TUNED + TRAINED + ABLATIONS
    edit: bool = True
    clock: bool = True


QUICK_RIVALS = (*RIVALS[:-1], QUICK_DNO, *OURS, *TUNED, *TRAINED, *ABLATIONS)
QUICK = Protocol(32, 2, 10, ("pelvis", "left_wrist"), (5,), QUICK_RIVALS)
"""A first look: its intervals are wide, and DNO gets a tenth of its looks."""


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = FOLDER,
    device: str = "cpu",
    progress: bool = True,
    models: Models | None = None,
) -> list[dict[str, Any]]:
    """Measure every method; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: how much is measured; None for the whole of it.
        folder: where results are stored; those of another prior, evaluator, data, number of clips
            or of steps lie apart in it, and so do those of other settings of a method. After a
            change of a sampler, take another folder.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.
        models: of trained rivals, by name; None for those in the package. A rival is left out if
            its model is not there or was made from another prior.

    Returns:
        One record a row, held-out data first: ``joint``, ``keys``, ``method``, ``options`` and
        ``scores``, each with its ``mean``, its ``half width`` (95 %) and the ``values`` of all
        seeds. Then for every joint the mean over densities (``keys`` is "all"), and that over
        joints (``joint`` is "average"); and last the upper-body edit. The first has also a sentence
        on who was ``left out``, or None.

    Raises:
        ValueError: for fewer than 32 clips, or fewer than 2 seeds.
    """
    p = protocol or Protocol()
    field = field_of(prior, p.rivals, device, models)
    bench = begin("control", prior, p, SEEDS, folder, device)._replace(flows=field.velocities)
    rows = rows_of(bench, p._replace(rivals=field.rivals), progress)
    data = bench.data_row(partial(score_of_data, bench), COLUMNS)
    return [data | {"left out": said_of(field.absent)}, *rows]


def rows_of(
    bench: Bench,
    p: Protocol,
    progress: bool = True,
    measure: Callable[[Bench, Cell, int], Scores] | None = None,
    columns: Sequence[str] = COLUMNS,
) -> list[dict[str, Any]]:
    """The records of all methods, as of `run` but for the data's.

    Args:
        bench: what all cells share.
        p: how much is measured.
        progress: whether to show a bar.
        measure: of the bench, a cell and a seed; by default `measured`.
        columns: that are kept.
    """
    times = bench.times(p.rivals if p.clock else (), partial(in_time, bench))
    found = filled(
        bench.place, cells_of(p), p.seeds, partial(measure or measured_cell, bench), progress
    )
    rows = summarised(found, groups_of(p), p.rivals, columns, bench.about)
    return [row | times.get(row["method"], {}) for row in rows]


def measured_cell(bench: Bench, cell: Cell, seed: int) -> Scores:
    """One cell of the study of control."""
    task = Task(cell.joint, int(cell.keys), FRAMES)
    return measured(
        bench.flows[cell.rival.model], bench.noise_std, cell.rival, task, bench.wished(seed),
        bench.about["steps"], seed, bench.reference,
    )  # fmt: skip


def in_time(bench: Bench, rival: Rival) -> Made:
    """The motions that are timed."""
    task, count = TIMED
    few = held_out(count, FRAMES, WISHED)
    flow = bench.flows[rival.model]
    return make(flow, bench.noise_std, rival, task, few, bench.about["steps"], 0)


def score_of_data(bench: Bench, clips: Clips, seed: int) -> Scores:
    """What clips of the data score."""
    return score(clips.positions, clips, None, bench.reference, seed)


def cells_of(p: Protocol) -> list[Cell]:
    """Everything that is measured."""
    edits = [(EDIT, FRAMES)] if p.edit else []
    tasks = [*itertools.product(p.joints, p.densities), *edits]
    return [Cell(joint, keys, rival) for joint, keys in tasks for rival in p.rivals]


def groups_of(p: Protocol) -> list[Group]:
    """A row for every cell, for every joint over densities, for all joints, and for the edit."""
    whole = tuple(itertools.product(p.joints, p.densities))
    return [
        *(Group(joint, keys, ((joint, keys),)) for joint, keys in whole),
        *(Group(j, ALL, tuple(itertools.product((j,), p.densities))) for j in p.joints),
        *(Group("average", k, tuple(itertools.product(p.joints, (k,)))) for k in p.densities),
        Group("average", ALL, whole),
        *([Group(EDIT, ALL, ((EDIT, FRAMES),))] if p.edit else []),
    ]


def measured(
    velocity: Velocity,
    noise_std: float | torch.Tensor,
    rival: Rival,
    task: Task,
    wished: Clips,
    steps: int,
    seed: int,
    reference: Features,
) -> dict[str, float]:
    """One cell: sample one way with one seed, and score it."""
    made = make(velocity, noise_std, rival, task, wished, steps, seed)
    return score(made.positions, wished, made, reference, seed)


def score(
    positions: NDArray, clips: Clips, made: Made | None, reference: Features, seed: int
) -> dict[str, float]:
    """The columns of the table, each over a whole set of clips; without a wish no errors."""
    row = quality(positions, clips.captions, reference, seed)
    row |= {} if made is None else errors_of(made)
    return {name: row[name] for name in COLUMNS if name in row}


def errors_of(made: Made) -> Scores:
    """How far motions are from what was asked of them, metres and shares."""
    errors = control_errors(made.positions, made.targets)
    row = {f"{name} error": float(e.mean()) for name, e in errors._asdict().items()}
    return row | {"residual": float(np.nanmax(np.abs(made.positions - made.targets)))}


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    usual = Protocol()
    parser = options_of("Every method of control on one protocol.", FOLDER, usual)
    add_methods(parser, usual.rivals)
    options = parser.parse_args()
    rivals = chosen(usual.rivals, options.methods)
    protocol = asked_for(options, usual._replace(rivals=rivals), QUICK)
    carry_out("control", options, protocol, run, table, figure)


if __name__ == "__main__":
    main()
