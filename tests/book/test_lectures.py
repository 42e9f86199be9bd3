"""The notebooks' README, which is also the book's page on lectures, against the notebooks."""

from __future__ import annotations

import json
import re
from pathlib import Path

import chapters
import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = chapters.notebooks()
README = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_both_readmes_say_how_long_a_notebook_takes(path):
    first = "".join(json.loads(path.read_text(encoding="utf-8"))["cells"][0]["source"])
    said = re.search(r"About (\d+) minutes", first)
    assert said, f"{path.name} does not say how long it takes"
    link = rf"\[{path.stem[:2]} [^|]*\]\({path.name}\)"
    for name, cell in (("notebooks/README.md", link), ("README.md", f"`{path.stem}`")):
        text = (ROOT / name).read_text(encoding="utf-8")
        row = re.search(rf"^\| {cell} \| (\d+) \|", text, re.MULTILINE)
        assert row, f"{name} has no row for {path.name}"
        assert row[1] == said[1], f"{name}: minutes of {path.name}"


def test_links_of_the_lectures_lead_to_chapters():
    text = chapters.lectures()
    for path in NOTEBOOKS:
        assert f"](chapters/{path.name})" in text


def test_every_notebook_has_its_place_in_the_lectures():
    """In the title line of one lecture, or among those for projects."""
    groups = re.findall(r"^\*\*\d · .+\*\* \*(.+)\*$|^For projects.+?: (.+),", README, re.MULTILINE)
    listed = re.findall(r"\b\d\d\b", " ".join(" ".join(group) for group in groups))
    assert sorted(listed) == [path.stem[:2] for path in NOTEBOOKS]
