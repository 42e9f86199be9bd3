"""The fixtures of the tests in a real JupyterLab; see lab_driver.py for how a test uses them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from lab_driver import Lab, Server


@pytest.fixture(scope="session")
def jupyter_server(tmp_path_factory):
    """One JupyterLab server for the whole run."""
    server = Server(tmp_path_factory.mktemp("jupyter"))
    yield server
    server.stop()


@pytest.fixture
def jupyter_lab(jupyter_server, open_page, artefacts):
    """Function ``jupyter_lab(notebook) -> Lab``: a copy of a notebook, open and connected.

    The network is blocked except for this machine; a request that tries to leave, or an error in
    the browser's console, fails the test when it ends.
    """
    kernels = []

    def open_lab(notebook: str | Path, width: int = 1280, height: int = 960, ratio: float = 1):
        page = open_page(width, height, ratio)
        lab = Lab(jupyter_server, page, Path(notebook), artefacts)
        kernels.append(lab)
        return lab

    yield open_lab
    for lab in kernels:  # a kernel that idles on would hold memory for the rest of the run
        lab.page.evaluate("() => window.jupyterapp.shell.currentWidget.sessionContext.shutdown()")


@pytest.fixture
def write_notebook(jupyter_server):
    """Function ``write_notebook(name, *cells) -> Path``: a small notebook made by the test."""

    def write(name: str, *cells: str) -> Path:
        path = jupyter_server.root / name
        content = {
            "cells": [
                {
                    "cell_type": "code",
                    "id": f"cell{i}",
                    "execution_count": None,
                    "metadata": {},
                    "outputs": [],
                    "source": source,
                }
                for i, source in enumerate(cells)
            ],
            "metadata": {
                "kernelspec": {
                    "name": "python3",
                    "display_name": "Python 3",
                    "language": "python",
                }
            },
            "nbformat": 4,
            "nbformat_minor": 5,
        }
        path.write_text(json.dumps(content))
        return path

    return write
