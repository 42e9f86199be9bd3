"""A real JupyterLab in a headless browser: start it, open a notebook, run it, ask its kernel.

A test asks for the fixture ``jupyter_lab`` (see conftest.py), which gives a function::

    def test_my_notebook(jupyter_lab):
        lab = jupyter_lab("notebooks/00_start_here.ipynb")   # copied; the original stays as it is
        lab.run_all()                                        # fails if a cell raises
        box = lab.canvas(".pf-pad").bounding_box()
        ...                                                  # lab.page is playwright's page
        assert lab.ask("studio.runs") == 1                   # Python in the notebook's kernel
        lab.screenshot("start_here")                         # artefacts/start_here.png
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path
from typing import Any

QUIET = {  # nothing that would ask the network, or put a dialogue in the way
    "@jupyterlab/apputils-extension:notification": {
        "fetchNews": "false",
        "checkForUpdates": False,
        "doNotDisturbMode": True,
    },
    "@jupyterlab/notebook-extension:tracker": {"autoStartDefaultKernel": True},
    "@jupyterlab/extensionmanager-extension:plugin": {"enabled": False},
    "@jupyterlab/apputils-extension:themes": {"theme": "JupyterLab Light"},
}
FLAGS = [
    "--no-browser",
    "--allow-root",
    "--LabApp.expose_app_in_browser=True",
    "--ServerApp.port_retries=0",
    "--IdentityProvider.token=",
    "--ServerApp.disable_check_xsrf=True",
]
READY = """async () => {
  const panel = window.jupyterapp?.shell?.currentWidget;
  const context = panel?.sessionContext;
  if (!context) return false;
  await context.ready;
  const kernel = context.session?.kernel;
  if (!kernel || kernel.connectionStatus !== "connected" || kernel.status !== "idle") return false;
  await kernel.info;
  return true;
}"""
ASK = """async (code) => {
  const kernel = window.jupyterapp.shell.currentWidget.sessionContext.session.kernel;
  let text = "", failure = null;
  const future = kernel.requestExecute({ code, store_history: false });
  future.onIOPub = ({ header, content }) => {
    if (header.msg_type === "stream" && content.name === "stdout") text += content.text;
    if (header.msg_type === "error") failure = `${content.ename}: ${content.evalue}`;
  };
  await future.done;
  return { text, failure };
}"""
OUTCOME = """() => {
  const cells = window.jupyterapp.shell.currentWidget.content.widgets;
  const code = cells.filter((cell) => cell.model.type === "code");
  const errors = code.flatMap((cell) => cell.model.outputs.toJSON())
    .filter((output) => output.output_type === "error")
    .map((output) => `${output.ename}: ${output.evalue}`);
  const counts = code.filter((cell) => cell.model.sharedModel.source.trim())
    .map((cell) => cell.model.executionCount);
  const busy = code.some((cell) => cell.model.executionState === "running");
  return { errors, busy, done: !busy && counts.every((count) => count !== null) };
}"""


class Server:
    """A JupyterLab server on a free port of this machine, with settings of its own."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "work"
        self.settings = folder / "settings"
        config = folder / "config"
        (config / "labconfig").mkdir(parents=True)
        self.root.mkdir()
        overrides = config / "labconfig" / "default_setting_overrides.json"
        overrides.write_text(json.dumps(QUIET))
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        environment = os.environ | {
            "JUPYTER_CONFIG_DIR": str(config),
            "JUPYTER_RUNTIME_DIR": str(folder / "runtime"),
            "JUPYTERLAB_SETTINGS_DIR": str(self.settings),
            "JUPYTERLAB_WORKSPACES_DIR": str(folder / "workspaces"),
            "IPYTHONDIR": str(folder / "ipython"),
        }
        self.log = folder / "jupyter.log"
        command = [sys.executable, "-m", "jupyterlab", *FLAGS]
        command += [f"--ServerApp.port={self.port}", f"--ServerApp.root_dir={self.root}"]
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                command, stdout=log, stderr=subprocess.STDOUT, env=environment
            )
        self._wait()

    def _wait(self, seconds: float = 90.0) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.process.poll() is None:
            try:
                urllib.request.urlopen(f"{self.address}/api/status", timeout=2)
                return
            except OSError:
                time.sleep(0.2)
        raise RuntimeError(f"JupyterLab did not start:\n{self.log.read_text()[-3000:]}")

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def stop(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()


class Lab:
    """One notebook, open in JupyterLab, with its kernel connected."""

    def __init__(self, server: Server, page: Any, notebook: Path, artefacts: Path) -> None:
        self.page = page
        self.artefacts = artefacts
        shutil.rmtree(server.settings, ignore_errors=True)  # e.g. the theme of an earlier test
        target = server.root / notebook.name
        if notebook != target:
            shutil.copy(notebook, target)
        page.goto(f"{server.address}/lab/tree/{notebook.name}?reset")
        page.wait_for_selector(".jp-Notebook", timeout=30_000)
        self._until(READY, 40)

    def _until(self, script: str, seconds: float) -> None:
        end = time.monotonic() + seconds
        while not self.page.evaluate(script):
            assert time.monotonic() < end, "the notebook's kernel did not become ready"
            self.page.wait_for_timeout(100)

    def run_all(self, seconds: float = 60.0) -> None:
        """Run all cells and wait until they are done; fails with the error if one raises."""
        self.page.evaluate("() => { window.jupyterapp.commands.execute('notebook:run-all-cells') }")
        end = time.monotonic() + seconds
        while True:
            outcome = self.page.evaluate(OUTCOME)
            assert not outcome["errors"], outcome["errors"]
            if outcome["done"]:
                break
            assert time.monotonic() < end, f"cells still running after {seconds} s"
            self.page.wait_for_timeout(100)
        self.page.wait_for_timeout(300)  # for the widgets to draw themselves

    def ask(self, expression: str) -> Any:
        """Value of a Python expression in the notebook's kernel; arrays come as nested lists."""
        code = (
            "import json as _json\n"
            "def _plain(value): return value.tolist() if hasattr(value, 'tolist') else str(value)\n"
            f"print(_json.dumps({expression}, default=_plain))"
        )
        answer = self.page.evaluate(ASK, code)
        assert answer["failure"] is None, answer["failure"]
        return json.loads(answer["text"])

    def wait_for(self, expression: str, seconds: float = 20.0) -> None:
        """Wait until a Python expression in the kernel is true."""
        end = time.monotonic() + seconds
        while not self.ask(expression):
            assert time.monotonic() < end, f"still not true after {seconds} s: {expression}"
            self.page.wait_for_timeout(100)

    def canvas(self, widget: str, index: int = 0) -> Any:
        """Locator of the canvas of the `index`-th ``.pf-viewer`` or ``.pf-pad``, in sight."""
        canvas = self.page.locator(f"{widget} canvas").nth(index)
        canvas.scroll_into_view_if_needed()
        return canvas

    def drag(self, widget: str, points: list[tuple[float, float]], index: int = 0) -> None:
        """Draw with the mouse: `points` in shares of the canvas, (0, 0) top left, (1, 1) below."""
        box = self.canvas(widget, index).bounding_box()
        places = [(box["x"] + u * box["width"], box["y"] + v * box["height"]) for u, v in points]
        self.page.mouse.move(*places[0])
        self.page.mouse.down()
        for place in places[1:]:
            self.page.mouse.move(*place, steps=3)
        self.page.mouse.up()

    def drag_handle(
        self, board: int, name: str, right: float, down: float = 0.0, steps: int = 12
    ) -> None:
        """Drag a handle of the `board`-th board of the page by so many pixels."""
        handle = self.page.locator(".pf-board").nth(board).locator(f"[data-name='{name}']")
        x, y = self._grab(handle)
        for i in range(1, steps + 1):
            self.page.mouse.move(x + right * i / steps, y + down * i / steps)
            self.page.wait_for_timeout(25)
        self.page.mouse.up()

    def _grab(self, handle: Any, seconds: float = 20.0) -> tuple[float, float]:
        """Press the mouse on a handle of a board; pictures above may still find their size."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            handle.scroll_into_view_if_needed()
            box = handle.bounding_box()
            self.page.wait_for_timeout(200)
            if box is None or box != handle.bounding_box():
                continue
            x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            self.page.mouse.move(x, y)
            self.page.mouse.down()
            if handle.evaluate("(node) => node.classList.contains('pf-held')"):
                return x, y
            self.page.mouse.up()
        raise AssertionError(f"the mouse could not take hold of {handle} in {seconds} s")

    def pixels(self, widget: str, index: int = 0) -> bytes:
        """The picture on a canvas as PNG bytes."""
        return self.canvas(widget, index).screenshot()

    def theme(self, name: str) -> None:
        """Switch to "JupyterLab Light" or "JupyterLab Dark"."""
        script = "(theme) => window.jupyterapp.commands.execute('apputils:change-theme', { theme })"
        self.page.evaluate(script, name)
        light = "true" if name.endswith("Light") else "false"
        self.page.wait_for_selector(f"body[data-jp-theme-light='{light}']", state="attached")
        self.page.wait_for_timeout(500)

    def screenshot(self, name: str, top: str | None = None) -> Path:
        """Save what the browser shows as ``artefacts/NAME.png``, scrolled so `top` is on top."""
        if top is not None:
            scroll = "(node) => node.scrollIntoView({ block: 'start' })"
            self.page.locator(top).first.evaluate(scroll)
            self.page.wait_for_timeout(300)
        path = self.artefacts / f"{name}.png"
        self.page.screenshot(path=path)
        return path
