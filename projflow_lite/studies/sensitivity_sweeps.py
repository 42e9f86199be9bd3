"""Which values of each constant of ProjFlow's Table 5 are tried."""

from __future__ import annotations

from typing import Any, NamedTuple

from projflow_lite.studies.cells import Rival

USUAL = Rival("projflow", "projflow")
"""All constants at their usual values."""


class Sweep(NamedTuple):
    """One constant and the values tried.

    Attributes:
        name: of the constant, an option of a `Rival`.
        says: what it is, in words.
        paper: its value in Table 5.
        usual: its value here; None where the protocol decides.
        values: what is tried beside the usual one.
    """

    name: str
    says: str
    paper: Any
    usual: Any
    values: tuple[Any, ...]

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """ProjFlow with each of the values."""
        return tuple(Rival(self.label(v), "projflow", ((self.name, v),)) for v in self.values)

    def label(self, value: Any) -> str:
        """Name of a row."""
        return f"{self.name} = {spelled(value)}"

    def shortened(self) -> Sweep:
        """The same with two values only: the nearest below and above, or the ends."""
        if not isinstance(self.usual, int | float):
            return self._replace(values=(self.values[0], self.values[-1]))
        below = [value for value in self.values if value < self.usual]
        above = [value for value in self.values if value > self.usual]
        return self._replace(values=tuple(below[-1:] + above[:1]))


def spelled(value: Any) -> str:
    """A number as short as it can be, or a word."""
    return f"{value:g}" if isinstance(value, int | float) else str(value)


SWEEPS = (
    Sweep("w_kin", "coupling of joints, over a ridge of 1", 10, 10.0, (0.0, 1.0, 3.0, 30.0, 100.0)),
    Sweep("l_min", "radius of guides at the end, frames", 3, 3.0, (0.0, 1.0, 6.0, 10.0)),
    Sweep("l_max", "radius of guides at the start, frames", 10, 10.0, (3.0, 5.0, 20.0, 40.0)),
    Sweep("tau_min", "share of the trust that is left", 0.1, 0.1, (0.0, 0.03, 0.3, 1.0)),
    Sweep("c0", "strength of guides", 3, 3.0, (0.3, 1.0, 10.0, 30.0)),
    Sweep("lambda_s", "how much a bend lowers the trust", 1, 1.0, (0.0, 0.3, 3.0, 10.0)),
    Sweep("p", "how sharply it does", 2, 2.0, (0.5, 1.0, 4.0)),
    Sweep("pi_min", "least trust", 0.02, 0.02, (0.001, 0.005, 0.1, 0.3)),
    Sweep("pi_max", "most trust", 1, 0.99, (0.5, 0.9, 1.0)),
    Sweep("steps", "network calls", 100, None, (5, 10, 50, 100)),
    Sweep("eta", "share of fresh noise", "paper", "paper", (0.0, 0.5, "ddpm")),
)
"""One constant at a time. The metric's ridge is not among them, see `sensitivity`."""
