"""What the widgets share on the Python side: their ES modules, and bytes that survive the trip."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import traitlets
from numpy.typing import ArrayLike, NDArray

HERE = Path(__file__).parent


def module(*names: str) -> str:
    """Join source files into one text: the files of a widget share one module scope.

    anywidget takes exactly one ES module a widget. Joining the files when Python imports them
    keeps each file small and the shared ones single, with no build step in between.
    """
    return "\n".join((HERE / name).read_text(encoding="utf-8") for name in names)


def float_bytes() -> traitlets.Bytes:
    """A synced trait for an array of little-endian float32.

    What JavaScript sends arrives as a memoryview, and a `Bytes` trait silently refuses one:
    the change would be lost without the conversion. Nor is it echoed to the page that sent it.
    """
    return traitlets.Bytes(b"").tag(
        sync=True, echo_update=False, from_json=lambda value, widget: bytes(value)
    )


def pack(array: ArrayLike) -> bytes:
    """The values of an array in C order as little-endian float32."""
    return np.ascontiguousarray(array, dtype="<f4").tobytes()


def unpack(data: bytes, *shape: int) -> NDArray[np.float64]:
    """The inverse of `pack`, as float64."""
    return np.frombuffer(data, dtype="<f4").reshape(shape).astype(float)
