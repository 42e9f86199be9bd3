"""The chapters: the notebooks themselves, with a cell before, a cell after and links at the end.

A notebook becomes a chapter by being there: the name decides its place in the book.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from names_used import function_lines, numbers_named
from places import BOOK, NOTEBOOKS, remove_others, write_if_new

CHAPTERS = BOOK / "chapters"
START = "from projflow_lite.widgets import static_page\n\nstatic_page.start()"
FINISH = "static_page.finish()"
FOR_TESTS = "# NBVAL_CHECK_OUTPUT\n"
TITLE = re.compile(r"^# (?:\d+ · )?(.+)$", flags=re.MULTILINE)


def notebooks() -> list[Path]:
    """The notebooks in the order of their numbers."""
    return sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))


def title_of(notebook: dict[str, Any], name: str) -> str:
    """The number of a notebook and its first heading."""
    found = TITLE.search("".join(notebook["cells"][0]["source"]))
    return f"{int(name[:2])} · {found[1] if found else name}"


def chapter(notebook: dict[str, Any], name: str) -> dict[str, Any]:
    """A notebook as a chapter.

    One cell more prepares plots and widgets for a page without a kernel, another one records
    what the widgets answer; neither shows its code.
    """
    cells = [dict(cell) for cell in notebook["cells"]]
    for cell in cells:
        if cell["cell_type"] == "markdown":  # ../book/page.md is ../page.md from a chapter
            cell["source"] = "".join(cell["source"]).replace("](../book/", "](../")
        if cell["cell_type"] == "code":
            cell |= {"outputs": [], "execution_count": None, "source": shown(cell["source"])}
    first = "".join(cells[0]["source"])
    cells[0]["source"] = TITLE.sub(lambda _: f"# {title_of(notebook, name)}", first, count=1)
    links = markdown(
        "\n\n".join(["## Where this is in the code", *links_of(notebook), about(name)])
    )
    hidden = code(START, "remove-cell", "book-start")
    # Sphinx takes the title from the first cell, so the hidden one comes after it.
    cells = [cells[0], hidden, *cells[1:], code(FINISH, "remove-input", "book-finish"), links]
    return notebook | {"cells": cells}


def shown(source: str | list[str]) -> str:
    """The code of a cell without the line that only the tests of the notebooks need."""
    return "".join(source).removeprefix(FOR_TESTS)


def links_of(notebook: dict[str, Any]) -> list[str]:
    """Paragraphs that lead from a notebook to its equations and functions."""
    paragraphs = []
    numbers = numbers_named(notebook)
    if numbers:
        targets = [f"[{paper} {number}](#{anchor})" for paper, number, anchor in numbers]
        paragraphs.append("**Equations:** " + " · ".join(targets))
    functions = function_lines(notebook)
    if functions:
        paragraphs.append("**Functions:** " + " · ".join(functions))
    return paragraphs


def about(name: str) -> str:
    """How to get the chapter as a notebook."""
    return (
        f"**This page is a notebook:** {{download}}`{name} <../../notebooks/{name}>`. "
        "[How to run it](../running.md), and what works here without it."
    )


def markdown(text: str) -> dict[str, Any]:
    """A Markdown cell."""
    return {"cell_type": "markdown", "id": "book-links", "metadata": {}, "source": text}


def code(text: str, tag: str, name: str) -> dict[str, Any]:
    """A code cell with a tag."""
    return {
        "cell_type": "code", "id": name, "metadata": {"tags": [tag]}, "source": text,
        "outputs": [], "execution_count": None,
    }  # fmt: skip


def lectures() -> str:
    """The notebooks' own README as a page: its links lead to chapters."""
    text = (NOTEBOOKS / "README.md").read_text(encoding="utf-8")
    return re.sub(r"\]\((\d\d_\w+\.ipynb)\)", r"](chapters/\1)", text)


def write_chapters() -> None:
    """Write every chapter that changed, and the page on the lectures."""
    write_if_new(BOOK / "lectures.md", lectures())
    for path in notebooks():
        notebook = json.loads(path.read_text(encoding="utf-8"))
        text = json.dumps(chapter(notebook, path.name), indent=1, ensure_ascii=False)
        write_if_new(CHAPTERS / path.name, text)
    remove_others(CHAPTERS, {path.name for path in notebooks()})
