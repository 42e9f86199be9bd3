"""Ten ways to obey, in JupyterLab: choose a method, and its line joins the table."""

from __future__ import annotations

import pytest
from test_tasks import choose

pytestmark = pytest.mark.browser

CELL = """
import torch
import projflow_lite as pf
from projflow_lite.studies.method_explorer import MethodExplorer
torch.set_num_threads(1)
explorer = MethodExplorer(pf.load_prior(), batch=2)
explorer
"""


def test_choose_methods(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("ways.ipynb", CELL), width=1180, height=760)
    lab.run_all(seconds=120)
    for method in ("dps", "ddnm"):
        choose(lab, "method", method)
        lab.wait_for(f"'{method}' in explorer.outcomes", seconds=60)
    lab.page.locator("td", has_text="ddnm").first.wait_for(timeout=20_000)
    assert lab.ask("explorer.viewer.names[0]") == "ddnm"
    assert lab.ask("explorer.outcomes['ddnm'].numbers[0]") < 1e-3
    lab.screenshot("methods", top=".jp-OutputArea")
