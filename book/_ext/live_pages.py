"""The stored widgets of a page: front ends that many widgets share become files of their own.

MyST-NB writes the whole state of a notebook's widgets into its page, the source of the front end
with each widget. This moves every source into one script that all pages share, and leaves out of
the page what only a kernel would use.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from places import write_if_new

STATE = "application/vnd.jupyter.widget-state+json"
SHARED = ("_esm", "_css")
SCRIPTS = (
    "live/models.js",
    "live/controls.js",
    "live/records.js",
    "live/figures.js",
    "live/start.js",
)
LONG = 2000  # characters: a source shorter than this stays in the page


def slim(stored: dict[str, Any], folder: Path) -> list[str]:
    """Move the front ends out of a stored state, in place.

    Args:
        stored: what stands in a widget-state script.
        folder: where static files are collected.

    Returns:
        the names, relative to the folder, of the scripts that the page needs.
    """
    scripts = []
    for record in stored["state"].values():
        state = record["state"]
        if record["model_name"] == "FigureModel" or "_widget_layout" in state:
            record["state"] = {"_model_name": "FigureModel", "layout": state.get("layout")}
            record["buffers"], record["model_name"] = [], "FigureModel"
            continue
        for name in SHARED:
            source = state.get(name)
            if isinstance(source, str) and len(source) > LONG:
                key = hashlib.sha256(source.encode()).hexdigest()[:12]
                text = f"(window.liveModules ??= {{}})[{json.dumps(key)}] = {json.dumps(source)};\n"
                write_if_new(folder / "live" / "modules" / f"{key}.js", text)
                state[name] = {"module": key}
                scripts.append(f"live/modules/{key}.js")
    return list(dict.fromkeys(scripts))


def add_live_scripts(
    app: Any, page: str, template: str, context: dict[str, Any], tree: Any
) -> None:
    """Before a page is written: shrink its widgets' state, and add the scripts that revive it."""
    needed: list[str] = []
    for script in context.get("script_files", ()):
        attributes = getattr(script, "attributes", {})
        if attributes.get("type") == STATE:
            stored = json.loads(attributes["body"])
            needed += slim(stored, Path(app.outdir) / "_static")
            attributes["body"] = json.dumps(stored).replace("</", "<\\/")
    body = context.get("body", "")
    if "widget-view+json" in body or "live-figure" in body:
        plotly = ["vendor/plotly.min.js"] if uses_plotly(context) else []
        for name in (*plotly, *needed, *SCRIPTS):
            app.add_js_file(name, priority=900)


def uses_plotly(context: dict[str, Any]) -> bool:
    """Whether a page draws a plotly figure, as an output or as a widget."""
    bodies = [str(getattr(s, "attributes", {}).get("body", "")) for s in context["script_files"]]
    return "live-figure" in context["body"] or any('"FigureModel"' in body for body in bodies)


def setup(app: Any) -> dict[str, Any]:
    """Connect to Sphinx."""
    app.connect("html-page-context", add_live_scripts, priority=800)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
