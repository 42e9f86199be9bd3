"""projflow_lite: exact motion control with generative flows, small enough to read.

Imports are lazy: ``pf.equations`` needs only numpy and scipy, and loads no torch.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from projflow_lite.constraints import (
        Orthographic,
        Perspective,
        Rows,
        Wish,
        acceleration,
        centre_of_mass,
        keep,
        lift,
        loop,
        offset,
        pin,
        rows,
        velocity,
    )
    from projflow_lite.motion import Motion
    from projflow_lite.prior import Prior, load_prior
    from projflow_lite.projection import Projector
    from projflow_lite.samplers import sample
    from projflow_lite.widgets import view

__version__ = "0.1.0"

_HOME = {
    "Motion": "motion",
    "Orthographic": "constraints",
    "Perspective": "constraints",
    "Prior": "prior",
    "Projector": "projection",
    "Rows": "constraints",
    "Wish": "constraints",
    "acceleration": "constraints",
    "centre_of_mass": "constraints",
    "keep": "constraints",
    "lift": "constraints",
    "load_prior": "prior",
    "loop": "constraints",
    "offset": "constraints",
    "pin": "constraints",
    "rows": "constraints",
    "sample": "samplers",
    "velocity": "constraints",
    "view": "widgets",
}
_ROOMS = (
    "classroom",
    "constraints",
    "derivations",
    "equations",
    "exchange",
    "prior",
    "projection",
    "samplers",
    "scores",
    "skeleton",
    "studies",
    "widgets",
)

__all__ = [
    "Motion",
    "Orthographic",
    "Perspective",
    "Prior",
    "Projector",
    "Rows",
    "Wish",
    "acceleration",
    "centre_of_mass",
    "keep",
    "lift",
    "load_prior",
    "loop",
    "offset",
    "pin",
    "rows",
    "sample",
    "velocity",
    "view",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"projflow_lite.{_HOME[name]}"), name)
    if name in _ROOMS:
        return import_module(f"projflow_lite.{name}")
    raise AttributeError(f"module 'projflow_lite' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*__all__, *_ROOMS, "__version__"])
