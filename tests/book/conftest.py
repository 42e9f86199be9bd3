"""The built book, and pages of it in a browser that has no network."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BOOK = ROOT / "book"
BUILD = BOOK / "_build" / "tests"
sys.path.insert(0, str(BOOK / "_ext"))

# The notebooks' own tests run all of them already. These have the studio, the viewer, boards, the
# metric explorer, the scope, the card and both kinds of plots; BOOK_CHAPTERS=all tests all pages.
os.environ.setdefault("BOOK_CHAPTERS", "00 02 03 05 06")


@pytest.fixture(scope="session")
def book() -> Path:
    """The folder of the book's pages, built as `make book` does; a warning is a failure."""
    html = BUILD / "html"
    shutil.rmtree(html, ignore_errors=True)  # a page of an earlier build proves nothing
    command = [
        sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-j", "auto",
        "-d", str(BUILD / "doctrees"), str(BOOK), str(html),
    ]  # fmt: skip
    built = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert built.returncode == 0, built.stderr[-4000:]
    return html


@pytest.fixture
def leaf(browser, book):
    """Function ``leaf(name)``: a page of the book from the disk, the network off.

    When the test ends, nothing may have been asked for but files of this disk, and nothing may
    have been written to the console as an error.
    """
    contexts, errors, left = [], [], []

    def open_(name: str):
        context = browser.new_context(viewport={"width": 1300, "height": 1000}, offline=True)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.on("pageerror", lambda error: errors.append(f"{name}: {error}"))
        page.on("console", lambda message: errors.append(f"{name}: {message.text}")
                if message.type == "error" else None)  # fmt: skip
        page.on("request", lambda request: left.append(request.url)
                if not request.url.startswith(("file:", "data:", "blob:")) else None)  # fmt: skip
        path, _, query = name.partition("?")
        page.goto((book / path).as_uri() + (f"?{query}" if query else ""))
        page.wait_for_function("!window.MathJax || MathJax.startup?.promise !== undefined")
        page.evaluate("async () => { await window.MathJax?.startup?.promise; }")
        return page

    yield open_
    for context in contexts:
        context.close()
    assert not left, f"requests tried to leave the disk: {left}"
    assert not errors, f"errors in the browser's console: {errors}"
