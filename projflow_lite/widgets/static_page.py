"""For the pages of the book: widgets and plots of a notebook, alive where there is no kernel.

The book runs `start` before a notebook's first cell and `finish` after its last one. A lecturer
who builds pages of another kind can do the same.
"""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np
from IPython.display import HTML, display
from numpy.typing import NDArray

from projflow_lite.widgets.front_end import pack
from projflow_lite.widgets.recording import Recording, Records, record
from projflow_lite.widgets.states import State, changed_numbers
from projflow_lite.widgets.studio import WishStudio

RENDERER = "static_page"


def start() -> None:
    """Make plotly's figures plain data in the page, for the page's own copy of plotly.js.

    Plotly's own renderers ask the network for MathJax, or put 5 MB into every figure.
    """
    import plotly.io as pio
    from plotly.io.base_renderers import MimetypeRenderer

    class StaticPage(MimetypeRenderer):
        def to_mimebundle(self, fig_dict: dict[str, Any]) -> dict[str, str]:
            figure = in_script(pio.to_json(fig_dict, validate=False))
            return {"text/html": f'<div class="live-plot">{script("live-figure", figure)}</div>'}

    pio.renderers[RENDERER] = StaticPage()
    pio.renderers.default = RENDERER


def finish(seconds: float = 4.0) -> None:
    """Record what every widget answers, and put it into the page.

    Args:
        seconds: processor time that each control may take.
    """
    # All widgets of the process; ipywidgets has no public list of them.
    from ipywidgets.widgets.widget import _instances

    present = list(_instances.values())
    for widget in present:
        if isinstance(widget, WishStudio) and widget.motion is None:
            draw_example(widget)
    records = record(present, seconds)
    display(HTML(script("live-records", in_script(json.dumps(as_json(records))))))


def draw_example(studio: WishStudio) -> None:
    """Draw a circle for the studio's joint: a page cannot make a motion, but can show one."""
    low, high = np.array(studio.pad.bounds).reshape(2, 2).T
    turn = np.linspace(0, 2 * np.pi, studio.pad.samples)
    circle = np.stack([0.15 * np.cos(turn), 0.15 * np.sin(turn)], axis=1)
    side = np.array([-0.35 if "right" in studio.joint.value else 0.35, 1.2])
    # Setting `path` would count as a finished stroke and start a second run.
    studio.pad.path_data = pack(np.clip(circle + side, low, high))
    studio.run()


def as_json(records: Records) -> dict[str, Any]:
    """What the page reads; arrays of bytes are written once, however often they are needed."""
    blobs: dict[bytes, int] = {}

    def plain(state: State, before: State | None = None) -> State:
        return {
            model: {
                name: value_of(value, (before or {}).get(model, {}).get(name))
                for name, value in traits.items()
            }
            for model, traits in state.items()
        }

    def value_of(value: Any, before: Any) -> Any:
        if not isinstance(value, bytes | memoryview):
            return value
        changed = changed_numbers(before, value)
        if 8 * len(changed) < len(value):  # an index and a number for each that changed
            new = np.frombuffer(value, "<f4")[changed]
            return {"at": in_base64(changed.astype("<u4")), "is": in_base64(new)}
        return {"blob": blobs.setdefault(bytes(value), len(blobs))}

    def entry(recording: Recording) -> dict[str, Any]:
        control = recording.control
        return {
            "control": control.widget.model_id, "trait": control.trait, "stops": recording.stops,
            "home": control.home, "axes": control.axes,
            "answers": [plain(answer, records.start) for answer in recording.answers],
        }  # fmt: skip

    recordings = [entry(recording) for recording in records.recordings]
    return {
        "start": plain(touched(records)),
        "recordings": recordings,
        "silent": records.silent,
        "groups": records.groups,
        "blobs": [in_base64(blob) for blob in blobs],
    }


def in_base64(data: bytes | NDArray) -> str:
    """Bytes, or the numbers of an array, as text."""
    return base64.b64encode(data if isinstance(data, bytes) else data.tobytes()).decode()


def touched(records: Records) -> State:
    """The state at the start of all that a recording changes: the way back. Figures always."""
    names: dict[str, set[str]] = {m: {"figure"} for m, s in records.start.items() if "figure" in s}
    for model, traits in records.strayed.items():
        names.setdefault(model, set()).update(traits)
    for recording in records.recordings:
        widget = recording.control.widget.model_id
        own = {"handles", "seen"} if recording.control.axes[0] else {"value", "index"}
        names.setdefault(widget, set()).update(own)
        for answer in recording.answers:
            for model, traits in answer.items():
                names.setdefault(model, set()).update(traits)
    return {
        model: {name: records.start[model][name] for name in wanted if name in records.start[model]}
        for model, wanted in names.items()
    }


def script(kind: str, body: str) -> str:
    """Data in a page, which no browser runs."""
    return f'<script type="application/json" class="{kind}">{body}</script>'


def in_script(text: str) -> str:
    """JSON that cannot end the script element it stands in."""
    return text.replace("</", "<\\/").replace("<!--", "<\\u0021--")
