"""How long is it from the hand to the new picture?

Every front end in a real JupyterLab in headless Chromium, moved by mouse or keys; latency.js says
what is timed. "In Python" means that a kernel has to answer before there is anything new to see.
Where the network must run, the sampling that each move asks for is timed as well, in the kernel.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import measuring
import nbformat
import numpy as np

HERE = Path(__file__).parent
sys.path += [str(HERE.parent / "tests"), str(HERE.parent / "tests" / "browser")]

from browser.install import ADVICE, find_browser  # noqa: E402
from lab_driver import Lab, Server  # noqa: E402

OWN, PLOTLY = 50.0, 150.0
"""Milliseconds that the median may be: in front ends of our own, and through plotly."""

REST = "beside sampling, ms"

SETUP = """
import time
import numpy as np, torch
import ipywidgets as widgets
import projflow_lite as pf
from projflow_lite.widgets import Board, MetricExplorer, PathPad, PoseEditor, SamplerScope, Viewer, WishStudio
torch.set_num_threads({threads})
PROMPT = "a person waves with the left hand"
spent = []

def timed(function):
    def call(*given):
        start = time.perf_counter()
        result = function(*given)
        spent.append(1e3 * (time.perf_counter() - start))
        return result
    return call

def counted(widget, name):
    "The widget, and below it how often its function of this name has run: told last of all."
    told, run = widgets.Label("0"), getattr(widget, name)
    def run_and_tell(*given):
        run(*given)
        told.value = str(int(told.value) + 1)
    setattr(widget, name, run_and_tell)
    told.add_class("told")
    return widgets.VBox([widget, told])

def show(name, widget):
    widget.add_class(name)
    display(widget)
"""
VIEWER = """
body = np.repeat(pf.widgets.standing.standing_pose(), 196, axis=0)
body[..., 2] += np.linspace(0, 6, 196)[:, None]
bodies = [pf.Motion(body + [0.5 * k, 0, 0]) for k in range(4)]
show("viewer", Viewer(*bodies, playing=False, trail="left_wrist", height=400))
"""
BOARD = """
board = Board(title="A cloud follows", height=400)
board.handle("h", (0, 0), along="x")
cloud = np.random.default_rng(0).normal(size=(500, 2))
def follow(name, at):
    board.points("cloud", 0.3 * cloud + at)
    board.text("words", (0, 2.5), f"answer {at[0]:.4f}")
follow("h", (0, 0))
board.on_move(follow)
show("board", board)
"""
SCOPE = """
prior = pf.load_prior()
wish = pf.pin("left_wrist", [10, 30, 50], [[0.4, 1.2, 0.2], [0.3, 1.5, 0.3], [0.5, 1.2, 0.2]])
show("scope", SamplerScope(prior, wish, PROMPT, frames=60))
"""
FIGURE = """
import plotly.graph_objects as go
t = np.linspace(0, 1, 200)
figure = go.FigureWidget([go.Scatter(x=t, y=t), go.Scatter(x=t, y=t)])
figure.update_layout(height=350, yaxis={"range": [-1, 1]})
slider = widgets.FloatSlider(value=1, min=0, max=20, step=0.1)
def redraw(change):
    with figure.batch_update():
        figure.data[0].y, figure.data[1].y = np.sin(slider.value * t), np.cos(slider.value * t)
slider.observe(redraw, "value")
redraw(None)
show("figure", widgets.VBox([slider, figure]))
"""
EDITOR = """
editor = PoseEditor(pf.load_prior(), PROMPT, frames=60, height=420)
editor._sample = timed(editor._sample)
editor.viewer.camera = dict(yaw=0.3, pitch=0.15, distance=4.5, target=[0, 0.95, 0], orthographic=False)
show("editor", counted(editor, "run"))
"""
STUDIO = """
@timed
def make(joint, plane, path, prompt):
    wish = pf.pin(joint, frames=None, positions=path, axes=plane)
    return pf.sample(prior, wish, prompt=prompt, frames=len(path), seed=0)

prior = pf.load_prior()
studio = WishStudio(make)
show("studio", counted(studio, "run"))
"""

Hand = Callable[[int], object]
"""Makes the k-th move; all moves lead to other pictures than the one before."""


class FrontEnd(NamedTuple):
    """What is moved, and where something new is to be seen.

    Attributes:
        cells: the notebook cell that shows it.
        hand: takes hold of it; returns what makes a move.
        look: where to look, a CSS selector.
        sees: "canvas" for any drawing, "answer" for what Python draws, "page" for a change there.
        starts: the events that start the clock.
        limit: milliseconds that the median may be, less one sampling.
        samples: whether the network runs once for each move.
    """

    cells: str
    hand: Callable[[Lab], Hand]
    look: str
    sees: str = "canvas"
    starts: tuple[str, ...] = ("pointermove",)
    limit: float = OWN
    samples: bool = False


def spread(k: int) -> float:
    """The k-th of places between 0 and 1, each far from the one before."""
    return (0.15 + 0.618034 * k) % 1.0


def take_slider(selector: str) -> Callable[[Lab], Hand]:
    """Press the mouse on a slider of the page, and keep it down."""

    def take(lab: Lab) -> Hand:
        box = in_sight(lab, selector)
        y = box["y"] + box["height"] / 2
        lab.page.mouse.move(box["x"] + box["width"] / 2, y)
        lab.page.mouse.down()
        return lambda k: lab.page.mouse.move(box["x"] + (0.1 + 0.8 * spread(k)) * box["width"], y)

    return take


def take_joint(selector: str, share: float) -> Callable[[Lab], Hand]:
    """Find a joint, in this share of a canvas from the left, where the cursor grabs; press it."""

    def take(lab: Lab) -> Hand:
        box, page = in_sight(lab, selector), lab.page
        for k in range(4000):
            x, y = (
                box["x"] + share * box["width"] * (k % 40) / 40,
                box["y"] + box["height"] * (0.3 + k / 8000),
            )
            page.mouse.move(x, y)
            if page.locator(selector).evaluate("(canvas) => canvas.style.cursor") == "grab":
                break
        else:
            raise AssertionError(f"no joint found on {selector}")
        page.mouse.down()
        return lambda k: page.mouse.move(x + 60 * spread(k), y - 60 * spread(k + 3))

    return take


def take_path(lab: Lab) -> Hand:
    """Choose a shape, and pull the nearest point of it."""
    pad = lab.page.locator(".pad")
    pad.get_by_label("Preset shape").select_option("Heart")
    pad.get_by_role("button", name="Bend").click()
    box = in_sight(lab, ".pad canvas")
    x, y = box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"]
    lab.page.mouse.move(x, y)
    lab.page.mouse.down()
    return lambda k: lab.page.mouse.move(x + 50 * spread(k), y - 50 * spread(k + 3))


def take_handle(lab: Lab) -> Hand:
    """Press the handle of the board."""
    box = in_sight(lab, ".board [data-name='h']")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    lab.page.mouse.move(x, y)
    lab.page.mouse.down()
    return lambda k: lab.page.mouse.move(x + 150 * (spread(k) - 0.5), y)


def take_keys(selector: str) -> Callable[[Lab], Hand]:
    """Focus a slider of ipywidgets; it goes up a few steps, then down."""

    def take(lab: Lab) -> Hand:
        in_sight(lab, selector)
        lab.page.locator(selector).first.focus()
        keys = ["ArrowRight"] * 5 + ["ArrowLeft"] * 5
        return lambda k: lab.page.keyboard.press(keys[k % 10])

    return take


def take_pen(lab: Lab) -> Hand:
    """Draw a stroke; the clock starts when the hand lets go."""
    box, mouse = in_sight(lab, ".studio .pf-pad canvas"), lab.page.mouse

    def stroke(k: int) -> None:
        x, y = box["x"] + (0.6 + 0.1 * spread(k)) * box["width"], box["y"] + 0.4 * box["height"]
        mouse.move(x, y)
        mouse.down()
        mouse.move(x + 40, y - 30 * (1 + spread(k)), steps=4)
        mouse.up()

    return stroke


def in_sight(lab: Lab, selector: str) -> dict[str, float]:
    """Scroll to something; returns where it then is, once nothing moves any more."""
    found = lab.page.locator(selector).first
    before = None
    while True:
        found.scroll_into_view_if_needed()
        box = found.bounding_box()
        if box is not None and box == before:
            return box
        before = box
        lab.page.wait_for_timeout(300)


STEP = ".scope .widget-slider .noUi-handle"
FRONT_ENDS = {
    "viewer, scrub": FrontEnd(VIEWER, take_slider(".viewer input[type=range]"), ".viewer canvas"),
    "path pad, bend": FrontEnd("show('pad', PathPad())", take_path, ".pad canvas"),
    "metric explorer, pull": FrontEnd(
        "show('metric', MetricExplorer())", take_joint(".metric canvas", 0.33), ".metric canvas"
    ),
    "board, drag": FrontEnd(BOARD, take_handle, ".board [data-name='h']", "page"),
    "board, drag, in Python": FrontEnd(BOARD, take_handle, ".board canvas", "answer"),
    "sampler scope, step": FrontEnd(
        SCOPE, take_keys(STEP), ".scope .pf-viewer canvas", starts=("keydown",)
    ),
    "plotly figure, slider, in Python": FrontEnd(
        FIGURE, take_keys(".figure .noUi-handle"), ".figure .scatterlayer", "page", ("keydown",), PLOTLY
    ),
    "pose editor, drag, sampling": FrontEnd(
        EDITOR, take_joint(".editor canvas", 1.0), ".editor .told", "page", samples=True
    ),
    "studio, stroke, sampling": FrontEnd(
        STUDIO, take_pen, ".studio .told", "page", ("pointerup",), samples=True
    ),
}  # fmt: skip


def measure(lab: Lab, name: str, repetitions: int) -> dict[str, Any]:
    """Move one front end many times."""
    front_end, page = FRONT_ENDS[name], lab.page
    print(name, file=sys.stderr, flush=True)
    in_sight(lab, front_end.look.split()[0])  # JupyterLab leaves what is far off unfinished
    page.locator(front_end.look).first.wait_for(state="attached", timeout=60_000)
    hand = front_end.hand(lab)
    times: list[float] = []
    for k in range(repetitions + 2):  # the first two warm up
        page.wait_for_timeout(150)
        given = [front_end.look, front_end.sees, list(front_end.starts)]
        page.evaluate("([look, sees, starts]) => { latency.arm(look, sees, starts) }", given)
        hand(k)
        times.append(page.evaluate("latency.time"))
        assert times[-1] is not None, f"{name}: no new picture within 20 s of move {k}"
    row = summary(name, times[2:])
    if front_end.samples:
        row |= beside_sampling(times[2:], lab.ask(f"spent[-{repetitions}:]"))
    page.mouse.up()
    return row | {"moves": repetitions}


def summary(name: str, times: list[float]) -> dict[str, Any]:
    """The middle and the late ones of many times, milliseconds."""
    median, late = np.quantile(times, [0.5, 0.9])
    return {"front end": name, "median, ms": float(median), "90 %, ms": float(late)}


def beside_sampling(times: list[float], spent: list[float]) -> dict[str, Any]:
    """What of these times the samplings in them took, and what was left, milliseconds."""
    once = float(np.median(spent))
    return {
        "one sampling, ms": once,
        "median / sampling": float(np.median(times)) / once,
        REST: float(np.median(np.subtract(times, spent))),
    }


def notebook(names: list[str], threads: int, folder: Path) -> Path:
    """A notebook with a cell for each front end."""
    cells = dict.fromkeys(
        [SETUP.format(threads=threads), *(FRONT_ENDS[name].cells for name in names)]
    )
    content = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_code_cell(cell.strip()) for cell in cells]
    )
    content.metadata["kernelspec"] = {
        "name": "python3",
        "display_name": "Python 3",
        "language": "python",
    }
    path = folder / "latency.ipynb"
    nbformat.write(content, path)
    return path


def measure_all(names: list[str], repetitions: int, threads: int) -> list[dict[str, Any]]:
    """Open JupyterLab and move one front end after the other."""
    from playwright.sync_api import sync_playwright

    browser = find_browser()
    if browser is None:
        raise SystemExit(f"no browser found. {ADVICE}")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        server = Server(Path(folder))
        try:
            chromium = playwright.chromium.launch(
                executable_path=browser, args=["--no-sandbox", "--disable-gpu"]
            )
            page = chromium.new_page(viewport={"width": 1280, "height": 960})
            path = notebook(names, threads, server.root)
            lab = Lab(server, page, path, Path(folder))
            lab.run_all(seconds=180)
            page.evaluate(f"() => {{ {(HERE / 'latency.js').read_text()} }}")
            return [measure(lab, name, repetitions) for name in names]
        finally:
            server.stop()


def bars(rows: list[dict[str, Any]]) -> list[measuring.Bar]:
    """Each median, less the sampling where the network must run, against its limit."""
    judged = []
    for row in rows:
        what = f"{row['front end']}: median{' beside sampling' if REST in row else ''}, ms"
        measured = row.get(REST, row["median, ms"])
        judged.append(measuring.Bar(what, measured, FRONT_ENDS[row["front end"]].limit))
    return judged


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """A bar to the median, a line on to the 90 %, and how long one sampling takes."""
    axes = figure.subplots()
    names = [row["front end"] for row in rows]
    median, late, once = (
        np.array([row.get(key, 0.0) for row in rows])
        for key in ("median, ms", "90 %, ms", "one sampling, ms")
    )
    axes.barh(names, median, color="#0072B2", label="median")
    axes.barh(names, once, color="#E69F00", height=0.3, label="of it one sampling")
    axes.errorbar(
        median, names, xerr=[0 * median, late - median], fmt="none", color="#444", label="90 %"
    )
    axes.set_xscale("log")
    axes.axvline(OWN, color="#444", linestyle="--", linewidth=1)
    axes.set_xlabel("from the hand to the picture, ms (dashed: 50 ms)")
    axes.invert_yaxis()
    axes.legend(frameon=False)


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    names = list(FRONT_ENDS)[:2] if options.quick else list(FRONT_ENDS)
    rows = measure_all(names, 3 if options.quick else 30, options.threads)
    measuring.report(options, __doc__, rows, bars(rows), draw)


if __name__ == "__main__":
    main()
