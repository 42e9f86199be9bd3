"""How much does each constant of ProjFlow's Table 5 matter?

The paper prints one value of each and says that they are the same in all experiments; it prints no
sweep. Here one constant at a time is moved away from that value, and everything else stays: the
protocol, captions, keyframes and noise are those of the study of control, and so are the cells.

Of the metric's two weights only the quotient matters: multiplying both by a number divides the
motion's covariance, the guides' variances and nothing else. So the ridge has no sweep of its own;
that of the coupling is both. Two values differ from Table 5 by default: the upper bound of the
trust, where 1 would make a guide as hard as a keyframe, and the number of steps.

Every cell is stored as it is made; those of the usual constants are shared with the study of
control. ``python -m projflow_lite.studies.sensitivity --help`` has all options.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.prior import Prior
from projflow_lite.studies import control
from projflow_lite.studies.control import Protocol
from projflow_lite.studies.control_ways import FREE
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.sensitivity_figure import figure
from projflow_lite.studies.sensitivity_sweeps import SWEEPS, USUAL, Sweep
from projflow_lite.studies.sensitivity_words import sentences, table
from projflow_lite.studies.shell import asked_for, carry_out, options_of

__all__ = ["figure", "run", "sentences", "table"]

JOINTS, DENSITIES = ("pelvis", "left_wrist"), (1, 5, FRAMES // 4)
"""Where guides have gaps to bridge: with every frame given there is nothing to be sensitive to."""

QUICK_SWEEPS = tuple(sweep.shortened() for sweep in SWEEPS)


def protocol_of(
    sweeps: tuple[Sweep, ...],
    clips: int = 64,
    seeds: int = 3,
    steps: int = 25,
    joints: tuple[str, ...] = JOINTS,
    densities: tuple[int, ...] = DENSITIES,
) -> Protocol:
    """The study of control with other constants instead of other methods.

    Args:
        sweeps: what is moved.
        clips, seeds, steps, joints, densities: see `control.Protocol`.
    """
    rivals = (FREE, USUAL, *(rival for sweep in sweeps for rival in sweep.rivals))
    return Protocol(clips, seeds, steps, joints, densities, rivals, edit=False, clock=False)


QUICK = protocol_of(QUICK_SWEEPS, 32, 3, 10, ("left_wrist",), (5,))
"""A first look: wide intervals, two values of each constant, one joint, one density."""


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = control.FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every value of every constant; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: from `protocol_of`; None for the whole of it.
        folder: where results are stored, see `control.run`.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        Records as of `control.run`; ``method`` is, for example, "c0 = 10".

    Raises:
        ValueError: as `control.run`.
    """
    return control.run(prior, protocol or protocol_of(SWEEPS), folder, device, progress)


def chosen(names: list[str] | None) -> tuple[Sweep, ...]:
    """The sweeps of some constants.

    Raises:
        ValueError: for a constant that has no sweep.
    """
    known = {sweep.name: sweep for sweep in SWEEPS}
    for name in names or ():
        if name not in known:
            raise ValueError(f"sensitivity: '{name}' has no sweep; these have: {', '.join(known)}")
    return tuple(known[name] for name in names or known)


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    usual = protocol_of(SWEEPS)
    parser = options_of("How much does each constant matter?", control.FOLDER, usual)
    parser.add_argument("--constants", nargs="+", help="names in the table (default: all)")
    options = parser.parse_args()
    protocol = asked_for(options, protocol_of(chosen(options.constants)), QUICK)
    carry_out("sensitivity", options, protocol, run, table, figure)


if __name__ == "__main__":
    main()
