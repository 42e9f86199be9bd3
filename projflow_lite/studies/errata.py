"""How much do the errata matter? ProjFlow's eq. 9, 11, 48 and 51, as printed and as derived.

A formula that is wrong on paper may still be harmless in a sampler that takes many steps and then
lands exactly on its keyframes. So each is run both ways, on the protocol of the study of control,
with the same captions, keyframes and noise. Eq. 51 shares trust out among joints, and so can matter
only where two of them are asked for at once; with one, both ways must give the same motions but for
rounding, and show that the study finds nothing where there is nothing.

Every cell is stored as it is made; those of the usual sampler are shared with the study of control.
``python -m projflow_lite.studies.errata --help`` has all options.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from projflow_lite.prior import Prior
from projflow_lite.studies import control
from projflow_lite.studies.control import Protocol
from projflow_lite.studies.control_ways import AND
from projflow_lite.studies.errata_figure import figure
from projflow_lite.studies.errata_forms import ERRATA
from projflow_lite.studies.errata_words import sentences, table
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.shell import asked_for, carry_out, options_of

__all__ = ["figure", "run", "sentences", "table"]

JOINTS = ("pelvis", "left_wrist", f"pelvis{AND}left_wrist")
DENSITIES = (1, 5, FRAMES // 4, FRAMES)
RIVALS = tuple(dict.fromkeys(rival for erratum in ERRATA for rival in erratum.rivals))

FULL = Protocol(
    joints=JOINTS, densities=DENSITIES, rivals=RIVALS, edit=False, clock=False
)  # fmt: skip
QUICK = FULL._replace(clips=32, seeds=3, steps=10, densities=(5,))
"""A first look: wide intervals, one density."""


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = control.FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every erratum both ways; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: `FULL` by default, or one like it.
        folder: where results are stored, see `control.run`.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        Records as of `control.run`; ``method`` is, for example, "eq. 9 printed".

    Raises:
        ValueError: as `control.run`.
    """
    return control.run(prior, protocol or FULL, folder, device, progress)


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    options = options_of("How much do the errata matter?", control.FOLDER, FULL).parse_args()
    carry_out("errata", options, asked_for(options, FULL, QUICK), run, table, figure)


if __name__ == "__main__":
    main()
