"""The errata of ProjFlow that change how the sampler moves, each as two ways to run it."""

from __future__ import annotations

from typing import NamedTuple

from projflow_lite.studies.cells import Rival
from projflow_lite.studies.sensitivity_sweeps import USUAL


class Erratum(NamedTuple):
    """One equation, read in two ways.

    Attributes:
        name: in tables.
        printed: what it does as printed, in words.
        derived: and what the other reading does.
        as_printed: the sampler with the one reading.
        as_derived: and with the other.
    """

    name: str
    printed: str
    derived: str
    as_printed: Rival
    as_derived: Rival = USUAL

    @property
    def rivals(self) -> tuple[Rival, Rival]:
        """Both readings."""
        return self.as_printed, self.as_derived


ERRATA = (
    Erratum(
        "eq. 9",
        "mixes the noise that the run began with",
        "mixes the noise that the state implies, as the public code does",
        Rival("eq. 9 printed", "projflow", (("noise", "original"),)),
    ),
    Erratum(
        "eq. 11",
        "couples neighbours in the vector, an order by axis, on motions sorted by frame",
        "couples neighbours on the skeleton",
        Rival("eq. 11 printed", "projflow", (("reading", "order as printed"),)),
    ),
    Erratum(
        "eq. 48",
        "lets trust rise to the 1 of Table 5: early guides are as hard as keyframes",
        "stops at 0.99: guides stay soft",
        Rival("eq. 48 printed", "projflow", (("pi_max", 1.0),)),
    ),
    Erratum(
        "eq. 51",
        "gives the pelvis a larger share of the trust than the wrist",
        "gives it a smaller one, as the words beside it say",
        USUAL,
        Rival("eq. 51 as said", "projflow", (("reading", "shares as said"),)),
    ),
)
"""The other errata are of formulas that have no value as printed, or change no motion.

Eq. 48 without any bound would give negative variances, which no projection takes: Table 5's bound
is part of what is printed. Of eq. 51 this package takes the printed form; the other one is nobody's
formula, only the words'."""
