"""Everything a page needs, on the reader's disk: MathJax and plotly.js out of installed wheels."""

from __future__ import annotations

import shutil
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from places import BUILD

STATIC = BUILD / "static"
VENDOR = STATIC / "vendor"
FROM_WHEELS = {
    "mathjax.js": ("sphinx-mathjax-offline", "static/mathjax/tex-svg.js"),
    "plotly.min.js": ("plotly", "package_data/plotly.min.js"),
}
"""Name in the book: the package and the end of the file's path in it."""


def find(package: str, ending: str) -> Path:
    """The path of a file of an installed package.

    Raises:
        RuntimeError: if the package is not installed or has no such file.
    """
    try:
        found = [entry for entry in files(package) or () if str(entry).endswith(ending)]
    except PackageNotFoundError:
        found = []
    if not found:
        raise RuntimeError(f"book: {package} with {ending} is not installed; run `make book`")
    return Path(str(found[0].locate()))


def copy_scripts() -> None:
    """Put the scripts where Sphinx takes static files from, once for each version."""
    VENDOR.mkdir(parents=True, exist_ok=True)
    for name, (package, ending) in FROM_WHEELS.items():
        source, target = find(package, ending), VENDOR / name
        if not target.exists() or target.stat().st_size != source.stat().st_size:
            shutil.copyfile(source, target)
