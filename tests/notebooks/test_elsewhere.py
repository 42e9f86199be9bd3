"""Notebooks from another folder, from an installed wheel, and twice: always the same numbers.

Each is run twice, in kernels of their own: by the package of this checkout in one empty folder, and
by an installed wheel in another. Afterwards both are asked for a checksum of all that they made.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parents[2]
NAMES = ["00_start_here", "02_the_projection"]  # with the prior, and with nothing but equations

PROBE = """
import hashlib, json
import numpy as np
import projflow_lite

def checksum(value):
    value = getattr(value, "positions", value)
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, np.ndarray) and value.dtype.kind in "fib":
        return hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()[:16]

made = {name: checksum(value) for name, value in globals().items() if not name.startswith("_")}
print(json.dumps({"from": projflow_lite.__file__, "made": {k: v for k, v in made.items() if v}}))
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """A folder with the wheel of this checkout, installed as pip does, and nothing else."""
    wheels, site = tmp_path_factory.mktemp("wheels"), tmp_path_factory.mktemp("site")
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    build = [*pip, "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", wheels, ROOT]
    subprocess.run(build, check=True, cwd=wheels)
    (wheel,) = wheels.glob("*.whl")
    target = [*pip, "install", "--no-deps", "--no-index", "--target", site, wheel]
    subprocess.run(target, check=True, cwd=wheels)
    return site


def run(name: str, package: Path, folder: Path) -> tuple[list[str], dict]:
    """What a notebook prints, and the probe's answer; run in a folder, with this package."""
    notebook = nbformat.read(ROOT / "notebooks" / f"{name}.ipynb", as_version=4)
    notebook.cells.append(nbformat.v4.new_code_cell(PROBE))
    path = folder / f"{name}.ipynb"
    nbformat.write(notebook, path)
    command = [sys.executable, "-m", "jupyter", "nbconvert", "--to", "notebook", "--execute",
               "--inplace", "--log-level", "ERROR", path.name]  # fmt: skip
    environment = os.environ | {"PYTHONPATH": str(package), "OMP_NUM_THREADS": "1"}
    subprocess.run(command, check=True, cwd=folder, env=environment)
    cells = [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    *printed, answer = [
        "".join(output.text for output in cell.outputs if output.output_type == "stream")
        for cell in cells
    ]
    return printed, json.loads(answer)


@pytest.fixture(scope="module", params=NAMES)
def both(request, installed, tmp_path_factory):
    """One notebook, by the checkout and by the wheel, each in a folder of its own."""
    folders = [tmp_path_factory.mktemp(f"{request.param}_{k}") for k in range(2)]
    return [run(request.param, package, folder) for package, folder in zip((ROOT, installed), folders, strict=True)]  # fmt: skip


def test_each_kernel_had_the_package_that_was_meant(both, installed):
    here, there = (Path(answer["from"]) for _, answer in both)
    assert ROOT in here.parents
    assert installed in there.parents


def test_run_twice_it_makes_the_same_to_the_last_bit(both):
    (printed, first), (printed_again, again) = both
    assert len(first["made"]) >= 4
    assert first["made"] == again["made"]
    assert printed == printed_again
    assert any(printed)


def test_what_is_printed_is_what_the_repository_holds(both, request):
    printed, _ = both[1]
    name = Path(request.node.callspec.params["both"]).stem
    stored = nbformat.read(ROOT / "notebooks" / f"{name}.ipynb", as_version=4)
    kept = {
        k: cell.outputs[0].text
        for k, cell in enumerate(c for c in stored.cells if c.cell_type == "code")
        if cell.outputs
    }
    assert kept
    assert {k: printed[k] for k in kept} == kept


def test_the_wheel_has_all_that_is_no_python(installed):
    package = installed / "projflow_lite"
    here = ROOT / "projflow_lite"
    kinds = (".js", ".css", ".safetensors", ".json", ".csv", ".npz", ".txt")
    wanted = {p.relative_to(here) for p in here.rglob("*") if p.suffix in kinds}
    assert len(wanted) > 10
    assert wanted <= {p.relative_to(package) for p in package.rglob("*")}
