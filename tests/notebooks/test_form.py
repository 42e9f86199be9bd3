"""The form that all notebooks share: what is long belongs into the package."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import nbformat
import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
LONGEST_FUNCTION = 15
LONGEST_CELL = 25
WIDEST_LINE = 110  # characters: more are cut off, or scroll, beside the book's table of contents


def code_of(path: Path) -> list[str]:
    cells = nbformat.read(path, as_version=4).cells
    return [cell.source for cell in cells if cell.cell_type == "code"]


def test_there_are_notebooks():
    assert len(NOTEBOOKS) >= 17


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_functions_and_cells_are_short(path):
    for source in code_of(path):
        lines = [line for line in source.splitlines() if line.strip()]
        assert len(lines) <= LONGEST_CELL, lines[0]
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                length = node.end_lineno - node.lineno + 1
                assert length <= LONGEST_FUNCTION, node.name


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_code_fits_the_page(path):
    wide = [
        line for source in code_of(path) for line in source.splitlines() if len(line) > WIDEST_LINE
    ]
    assert not wide


@pytest.mark.parametrize("place", range(len(NOTEBOOKS)), ids=lambda place: NOTEBOOKS[place].stem)
def test_each_leads_to_the_next_one_by_its_name(place):
    cells = nbformat.read(NOTEBOOKS[place], as_version=4).cells
    links = re.findall(r"\*\*Next:\*\* \[(.+?)\]\((.+?)\)", cells[-1].source)
    if place + 1 == len(NOTEBOOKS):
        assert not links
        return
    following = NOTEBOOKS[place + 1]
    title = (
        nbformat.read(following, as_version=4).cells[0].source.splitlines()[0].removeprefix("# ")
    )
    assert links == [(f"{following.name[:2]} {title}", following.name)]
