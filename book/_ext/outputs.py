"""Which chapters the build runs, and how long it may use what an earlier run put out."""

from __future__ import annotations

import hashlib
import os
import shutil

from chapters import notebooks
from jupyter_cache import get_cache
from places import BUILD, ROOT

CACHE = BUILD / "cache"
PACKAGE = ("projflow_lite", "data_synth")
SOURCES = {".py", ".js", ".css", ".safetensors"}


def not_run() -> list[str]:
    """Chapters that appear without outputs: those that BOOK_CHAPTERS="00 03" does not name.

    Nothing is left out if the variable is not set, or is "all".
    """
    named = os.environ.get("BOOK_CHAPTERS", "all").split()
    return [] if "all" in named else [p.name for p in notebooks() if p.name[:2] not in named]


def forget_old() -> None:
    """Drop what was put out by other code than today's; Sphinx then reads all pages again.

    With BOOK_KEEP=1 in the environment it stays, for somebody who works on the text alone and
    knows that the numbers are old.
    """
    remembered, mark = BUILD / "fingerprint.txt", fingerprint()
    if os.environ.get("BOOK_KEEP") or (remembered.exists() and remembered.read_text() == mark):
        return
    shutil.rmtree(CACHE, ignore_errors=True)
    # Moved functions that Sphinx remembers would become links that lead nowhere.
    for pickled in BUILD.glob("**/environment.pickle"):
        pickled.unlink()
    BUILD.mkdir(exist_ok=True)
    remembered.write_text(mark)


def open_cache() -> None:
    """Make the tables of an empty cache: two processes that both find none would both make them."""
    get_cache(CACHE).list_cache_records()


def fingerprint() -> str:
    """A hash of the package and of the versions of what it needs."""
    files = [path for folder in PACKAGE for path in (ROOT / folder).rglob("*")]
    digest = hashlib.sha256((ROOT / "constraints.txt").read_bytes())
    for path in sorted(path for path in files if path.suffix in SOURCES):
        digest.update(str(path.relative_to(ROOT)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
