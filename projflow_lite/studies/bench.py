"""Where methods are compared: what all cells of one run share, and how a run begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import torch

from data_synth import Clips, held_out
from projflow_lite.prior import Prior
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.studies.cells import (
    Features,
    Rival,
    Scores,
    data_row,
    features_of,
    fingerprint,
    stored,
)
from projflow_lite.studies.claims import TIME
from projflow_lite.studies.control_ways import elsewhere, timed
from projflow_lite.studies.keyframes import FRAMES


class Seeds(NamedTuple):
    """Seeds of held-out clips; the last two are those of seed 0, others follow.

    Attributes:
        reference: to compare with.
        wished: to ask for.
        others: to show what data itself scores.
    """

    reference: int
    wished: int
    others: int


class Bench(NamedTuple):
    """What all cells of a run share.

    Attributes:
        place: folder of one prior, data and size.
        flows: the prior's, under "", and that of each model that a rival brings, on the device
            that was asked for.
        noise_std: standard deviation of its noise, metres.
        reference: features of the clips to compare with.
        wished: of a seed, the clips whose prompts and positions are asked for.
        about: what all records hold: ``clips`` and ``steps``.
        repeats: number of seeds.
        others: seed of the clips that show what data itself scores.
        device: where the network is computed.
    """

    place: Path
    flows: Mapping[str, Velocity]
    noise_std: float | torch.Tensor
    reference: Features
    wished: Callable[[int], Clips]
    about: dict[str, Any]
    repeats: int
    others: int
    device: str

    @property
    def velocity(self) -> Velocity:
        """The prior's flow."""
        return self.flows[""]

    def times(
        self, rivals: Sequence[Rival], make: Callable[[Rival], Any]
    ) -> dict[str, dict[str, float]]:
        """What each method takes, by its name: as a multiple of a sample without a wish."""
        found = {}
        for rival in rivals:
            path = self.place / rival.spelled / f"time-{self.device}.json"
            timing = partial(timed, rival, make)
            found[rival.name] = {TIME: stored(path, timing, by_first=True)[TIME]}
        return found

    def data_row(
        self, score: Callable[[Clips, int], Scores], columns: Sequence[str]
    ) -> dict[str, Any]:
        """A record of what data itself scores, see `cells.data_row`."""
        about = self.about | {"seeds": self.repeats}
        return data_row(score, self.about["clips"], FRAMES, self.others, columns, about)


def begin(
    who: str,
    prior: Prior,
    protocol: Any,
    seeds: Seeds,
    folder: str | Path,
    device: str,
    extent: str = "",
) -> Bench:
    """Make ready what all cells share.

    Args:
        who: names the study in an error.
        prior: what makes motions.
        protocol: its ``clips``, ``seeds`` and ``steps``.
        seeds: of held-out clips.
        folder: where results are stored; those of another prior, evaluator, data, number of clips
            or of steps lie apart in it.
        device: where the network is computed, "cpu" or "cuda".
        extent: what else keeps results apart.

    Raises:
        ValueError: for fewer than 32 clips, or fewer than 2 seeds.
    """
    clips, steps = protocol.clips, protocol.steps
    check_extent(who, clips, protocol.seeds)
    reference = features_of(held_out(16 * clips, FRAMES, seeds.reference).positions)
    name = f"{fingerprint(prior)}-{fingerprint(reference)}-{clips}-{steps}{extent}"
    wished = cache(lambda seed: held_out(clips, FRAMES, seeds.wished + seed))
    return Bench(
        Path(folder) / name, {"": elsewhere(prior, device)}, prior.noise_std, reference, wished,
        {"clips": clips, "steps": steps}, protocol.seeds, seeds.others, device,
    )  # fmt: skip


def check_extent(who: str, clips: int, seeds: int) -> None:
    """Refuse too few clips for a batch of R-precision, or too few seeds for an interval."""
    if clips < 32 or seeds < 2:
        raise ValueError(f"{who}: at least 32 clips and 2 seeds, not {clips} and {seeds}")
