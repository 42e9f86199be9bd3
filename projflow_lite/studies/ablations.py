"""Do the parts of ProjFlow earn their place? Its Tables 3 and 6 and Figure 7, made again.

The whole method, and without each of its parts: the metric of the skeleton (Euclid), fresh noise,
and the guides between keyframes (plain masking). The order may hang on what the paper leaves open,
so everything is done with both readings of the noise in eq. 9, and without and with guidance; for
every joint and density on its own. Beside the paper's parts stands one of ours: a metric over time
(`projflow_lite.samplers.MovingMetric`) in place of metric and guides.

The protocol is that of the study of control, with more clips: every comparison is of the same
captions, keyframes and noise, and every cell is stored as it is made.
``python -m projflow_lite.studies.ablations --help`` has all options.
"""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any, NamedTuple

from projflow_lite.prior import Prior
from projflow_lite.studies import control
from projflow_lite.studies.ablations_figure import figure
from projflow_lite.studies.ablations_words import sentences, table
from projflow_lite.studies.cells import Rival
from projflow_lite.studies.control import Protocol
from projflow_lite.studies.keyframes import FRAMES
from projflow_lite.studies.shell import asked_for, carry_out, options_of

__all__ = ["figure", "run", "sentences", "table"]

JOINTS = ("pelvis", "left_wrist")
DENSITIES = (1, 5, FRAMES // 4)
"""With every frame given there are no guides, and so nothing to take away."""

READINGS, GUIDANCES = ("implied", "original"), (1.0, 2.0)

PARTS: dict[str, dict[str, Any]] = {
    "projflow": {},
    "euclid": {"metric": "euclidean"},
    "no fresh noise": {"eta": 0.0},
    "plain masking": {"guides": False},
    "metric over time": {"metric": "moving"},
}
"""What is taken away or put in its place, as options of a `Rival`."""


class Setting(NamedTuple):
    """What the paper leaves open.

    Attributes:
        noise: which noise eq. 9 mixes, see `projflow_lite.samplers.projflow`.
        guidance: how strongly the prompt is followed.
    """

    noise: str
    guidance: float

    @property
    def options(self) -> dict[str, Any]:
        """Options of a `Rival`; none for what is usual, so that cells are shared."""
        noise = {} if self.noise == READINGS[0] else {"noise": self.noise}
        return noise | ({} if self.guidance == 1 else {"guidance": self.guidance})


SETTINGS = tuple(itertools.starmap(Setting, itertools.product(READINGS, GUIDANCES)))


def rivals_of(settings: tuple[Setting, ...]) -> tuple[Rival, ...]:
    """Every part under every setting."""
    return tuple(rival_of(part, setting) for setting in settings for part in PARTS)


def rival_of(part: str, setting: Setting) -> Rival:
    """One variant of ProjFlow."""
    name = f"{part}, {setting.noise}, {setting.guidance:g}"
    return Rival(name, "projflow", tuple((PARTS[part] | setting.options).items()))


FULL = Protocol(
    104, 5, joints=JOINTS, densities=DENSITIES, rivals=rivals_of(SETTINGS), edit=False, clock=False
)
QUICK = FULL._replace(clips=32, seeds=2, steps=10, densities=(5,), rivals=rivals_of(SETTINGS[::2]))
"""A first look: wide intervals, one density, no guidance."""


def run(
    prior: Prior,
    protocol: Protocol | None = None,
    folder: str | Path = control.FOLDER,
    device: str = "cpu",
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Measure every variant; see the module's docstring.

    Args:
        prior: what makes motions.
        protocol: `FULL` by default, or one like it.
        folder: where results are stored, see `control.run`.
        device: where the network is computed, "cpu" or "cuda".
        progress: whether to show a bar.

    Returns:
        Records as of `control.run`, and in each but the first: ``part`` (a name of `PARTS`),
        ``noise`` and ``guidance``.

    Raises:
        ValueError: as `control.run`.
    """
    data, *rows = control.run(prior, protocol or FULL, folder, device, progress)
    return [data, *(row | parted(row["method"]) for row in rows)]


def parted(method: str) -> dict[str, Any]:
    """The name of a variant taken apart."""
    part, noise, guidance = method.split(", ")
    return {"part": part, "noise": noise, "guidance": float(guidance)}


def main() -> None:
    """Measure, print the table, and write the records and the picture."""
    options = options_of(
        "Do the parts of ProjFlow earn their place?", control.FOLDER, FULL
    ).parse_args()
    carry_out("ablations", options, asked_for(options, FULL, QUICK), run, table, figure)


if __name__ == "__main__":
    main()
