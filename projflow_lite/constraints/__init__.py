"""What a person asks for, turned into linear rows ``A x = y``.

Every constraint is one function that returns a `Wish`; ``&`` stacks wishes. A wish knows nothing of
how long the motion will be until ``wish.rows(frames)`` writes its rows down.
"""

from projflow_lite.constraints.cameras import Orthographic, Perspective, lift
from projflow_lite.constraints.linear import rows
from projflow_lite.constraints.moving import acceleration, centre_of_mass, velocity
from projflow_lite.constraints.points import keep, loop, offset, pin
from projflow_lite.constraints.wish import (
    AXES,
    Markers,
    Rows,
    Term,
    Wish,
    coordinate_rows,
    describe_row,
    difference_rows,
    is_coordinate,
)

__all__ = [
    "AXES",
    "Markers",
    "Orthographic",
    "Perspective",
    "Rows",
    "Term",
    "Wish",
    "acceleration",
    "centre_of_mass",
    "coordinate_rows",
    "describe_row",
    "difference_rows",
    "is_coordinate",
    "keep",
    "lift",
    "loop",
    "offset",
    "pin",
    "rows",
    "velocity",
]
