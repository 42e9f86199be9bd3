"""Training in a notebook: the page stays alive meanwhile, the button stops, the notebook runs."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.browser

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "12_train_the_tiny_flow.ipynb"
LONG = """
import tempfile, torch
from projflow_lite.prior.training import Recipe
from projflow_lite.widgets.training_watch import TrainingWatch
torch.set_num_threads(1)
recipe = Recipe(steps=20_000, batch=16, widths=(64, 96), lengths=(60,))
watch = TrainingWatch(recipe, tempfile.mkdtemp(), every=10).start()
watch
"""


def press(lab, label: str) -> None:
    """Press the button of the watch."""
    button = lab.page.locator("button.jupyter-button", has_text=label)
    button.scroll_into_view_if_needed()
    button.click()


def test_the_notebook_is_alive_while_it_trains_and_the_button_stops_it(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("long_training.ipynb", LONG), width=1100, height=700)
    lab.run_all(seconds=150)
    lab.wait_for("watch.trainer.step >= 12", seconds=120)
    begun = time.monotonic()
    step = lab.ask("watch.trainer.step")
    assert time.monotonic() - begun < 5  # the kernel answers: it does not wait for the training
    lab.wait_for(f"watch.trainer.step > {step}", seconds=60)
    handle = lab.page.locator(".noUi-handle").first
    handle.focus()
    lab.page.keyboard.press("ArrowRight")
    lab.wait_for("watch.viewer.names[0] == 'x̂₁ at t = 0.55'", seconds=30)
    lab.screenshot("training_running", top=".jp-OutputArea")
    press(lab, "Stop")
    lab.wait_for("not watch._thread.is_alive()", seconds=60)
    at = lab.ask("watch.trainer.step")
    lab.page.wait_for_timeout(1000)
    assert lab.ask("watch.trainer.step") == at
    press(lab, "Go on")
    lab.wait_for(f"watch.trainer.step > {at}", seconds=60)
    press(lab, "Stop")
    lab.wait_for("not watch._thread.is_alive()", seconds=60)


def test_the_notebook_teaches_a_flow(jupyter_lab, tmp_path):
    """A fifth of its steps: that all of them teach enough, the notebook itself asserts."""
    short = NOTEBOOK.read_text().replace("steps=600", "steps=120").replace("== 600", "== 120")
    path = tmp_path / NOTEBOOK.name
    path.write_text(short)
    lab = jupyter_lab(path, width=1100, height=1000)
    lab.run_all(seconds=580)
    assert lab.ask("watch.trainer.step") == 120
    assert lab.ask("small[-1]") < 0.5 * lab.ask("small[0]")
    assert lab.ask("watch.held_out[-1, 1]") < 0.5 * lab.ask("watch.held_out[0, 1]")
    lab.screenshot("training_learnt", top=".jp-OutputArea")
    lab.screenshot("training_weights", top=".js-plotly-plot >> nth=0")
    lab.screenshot("training_prompts", top=".pf-viewer >> nth=1")
    curves = lab.page.locator(".js-plotly-plot").nth(1)
    curves.scroll_into_view_if_needed()
    curves.locator(".scatterlayer .trace").nth(1).wait_for()
    lab.screenshot("training_curves", top=".js-plotly-plot >> nth=1")
    lab.theme("JupyterLab Dark")
    lab.screenshot("training_dark", top=".jp-OutputArea")
