"""What the book writes by itself: chapters, the index of equations, links, small pages."""

from __future__ import annotations

import copy
import json
import pkgutil
import re
import sqlite3
from pathlib import Path

import chapters
import docstrings
import equation_links
import equation_pages
import live_pages
import names_used
import offline
import outputs
import places
import pytest
import reference_pages
from docutils import nodes
from sphinx.ext.napoleon import Config, GoogleDocstring

import projflow_lite
from projflow_lite.equations import catalog

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("[0-9][0-9]_*.ipynb"))


def notebook_of(*cells: tuple[str, str]) -> dict:
    return {
        "cells": [
            {"cell_type": kind, "id": str(k), "metadata": {}, "source": source}
            | ({"outputs": [1], "execution_count": 3} if kind == "code" else {})
            for k, (kind, source) in enumerate(cells)
        ],
        "metadata": {},
    }


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("see eq. 7.", ["7"]),
        ("(ProjFlow eq. 7–10)", ["7", "8", "9", "10"]),
        ("eq. 5, 7, 9 and 10", ["5", "7", "9", "10"]),
        ("eq. 39 or 40", ["39", "40"]),
        ("by eq. 7, 3 joints move", ["7"]),  # a comma alone starts no list
        ("the sequence 7", []),
        ("freq. 7", []),
    ],
)
def test_equations_are_found_in_text(text, found):
    numbers = [
        n for _, listed in names_used.MENTION.findall(text) for n in names_used.expand(listed)
    ]
    assert numbers == found


def test_a_mention_becomes_links_and_the_words_stay():
    known = names_used.records()
    text = "Source: ProjFlow eq. 5, 7 and 10, and GMD section 4.1 (a); eq. 999 is no equation."
    pieces = list(equation_links.linked(text, known))
    assert "".join(piece.astext() for piece in pieces) == text
    targets = [p["reftarget"] for p in pieces if not isinstance(p, nodes.Text)]
    assert targets == ["eq-projflow-5", "eq-projflow-7", "eq-projflow-10", "eq-gmd-4-1-a"]


def test_every_equation_has_an_anchor_of_its_own():
    anchors = [names_used.anchor(r.paper, r.number) for r in catalog()]
    assert len(set(anchors)) == len(anchors) > 80


def test_every_function_of_the_catalog_is_found_where_it_is_documented():
    documented = {
        f"{module.__name__}.{name}"
        for module in reference_pages.modules("equations")
        for name in reference_pages.own_names(module)
    }
    for record in catalog():
        if record.function:
            assert names_used.place_of(record.function) in documented, record.function


def test_an_entry_says_all_that_the_catalog_knows():
    record = names_used.records()["ProjFlow", "7"]
    text = equation_pages.entry(record, ["[a chapter](x.ipynb)"])
    assert record.latex in text
    assert "projflow_lite.equations.projection.projection_correction" in text
    assert 'check("projflow:7", my_function)' in text
    assert "a chapter" in text
    assert "1e-8" in text  # its erratum
    assert f":pyobject: {record.check.rpartition('.')[2]}" in text


def test_the_errata_are_those_of_the_catalog():
    papers = {p: [r for r in catalog() if r.paper == p] for p in ("ProjFlow", "GMD", "BMM")}
    rows = re.findall(r"^\| \[", equation_pages.errata(papers), flags=re.MULTILINE)
    assert len(rows) == sum(bool(r.erratum) for r in catalog()) > 20


def test_the_names_that_code_uses_lead_to_their_definitions():
    source = (
        "import projflow_lite as pf\nfrom projflow_lite import equations as eq\n"
        "from projflow_lite.widgets import Board as B\n"
        "m = pf.sample(p)\nm.residual\neq.ddnm(x, A, y)\nB()\npf.skeleton.JOINTS\nprint(m)"
    )
    lines = " ".join(names_used.function_lines(notebook_of(("code", source))))
    assert "<projflow_lite.samplers.sample>" in lines
    assert "<projflow_lite.equations.projection.ddnm>" in lines
    assert "<projflow_lite.widgets.board.Board>" in lines
    assert "JOINTS" not in lines
    assert "residual" not in lines


def test_a_chapter_is_its_notebook_with_a_cell_before_and_after():
    notebook = notebook_of(
        ("markdown", "# 3 · A title\n\nSee eq. 7 and [data](../book/data-card.md)."), ("code", "x")
    )
    before = copy.deepcopy(notebook)
    made = chapters.chapter(notebook, "04_a_title.ipynb")
    assert notebook == before
    kinds = [cell["cell_type"] for cell in made["cells"]]
    assert kinds == ["markdown", "code", "code", "code", "markdown"]
    sources = [cell["source"] for cell in made["cells"]]
    assert sources[0].startswith("# 4 · A title\n")
    assert "](../data-card.md)" in sources[0]
    assert sources[1] == chapters.START
    assert sources[2] == "x"
    assert made["cells"][2]["outputs"] == []
    assert "#eq-projflow-7" in sources[4]
    assert "../../notebooks/04_a_title.ipynb" in sources[4]


def test_outputs_of_another_package_are_forgotten(tmp_path, monkeypatch):
    build, code = tmp_path / "build", tmp_path / "projflow_lite" / "a.py"
    monkeypatch.setattr(outputs, "ROOT", tmp_path)
    monkeypatch.setattr(outputs, "BUILD", build)
    monkeypatch.setattr(outputs, "CACHE", build / "cache")
    monkeypatch.delenv("BOOK_KEEP", raising=False)
    code.parent.mkdir()
    code.write_text("one")
    (tmp_path / "constraints.txt").write_text("")
    outputs.forget_old()
    (build / "cache").mkdir()
    outputs.forget_old()
    assert (build / "cache").exists()
    code.write_text("two")
    monkeypatch.setenv("BOOK_KEEP", "1")
    outputs.forget_old()
    assert (build / "cache").exists()
    monkeypatch.delenv("BOOK_KEEP")
    outputs.forget_old()
    assert not (build / "cache").exists()


def test_the_cache_has_its_tables_before_two_processes_ask_for_them(tmp_path, monkeypatch):
    monkeypatch.setattr(outputs, "CACHE", tmp_path / "cache")
    outputs.open_cache()
    with sqlite3.connect(tmp_path / "cache" / "global.db") as database:
        names = {name for (name,) in database.execute("select name from sqlite_master")}
    assert "nbcache" in names


def test_only_the_named_chapters_are_run(monkeypatch):
    names = [path.name for path in NOTEBOOKS]
    monkeypatch.setenv("BOOK_CHAPTERS", "00 02")
    assert outputs.not_run() == [name for name in names if name[:2] not in ("00", "02")]
    monkeypatch.setenv("BOOK_CHAPTERS", "all")
    assert outputs.not_run() == []
    monkeypatch.delenv("BOOK_CHAPTERS")
    assert outputs.not_run() == []


def stored(source="x" * 5000, name="AnyModel", **more):
    state = {"_esm": source, "_css": "short", "layout": "IPY_MODEL_l"} | more
    return {"model_name": name, "state": state, "buffers": []}


def test_widgets_of_one_kind_share_one_script(tmp_path):
    page = {"state": {"a": stored(), "b": stored(), "c": stored("y" * 5000)}}
    scripts = live_pages.slim(page, tmp_path)
    assert len(scripts) == 2
    assert page["state"]["a"]["state"]["_esm"] == page["state"]["b"]["state"]["_esm"]
    assert page["state"]["a"]["state"]["_css"] == "short"
    text = (tmp_path / scripts[0]).read_text()
    assert json.loads(text[text.index("] = ") + 4 : -2]) == "x" * 5000


def test_a_figure_leaves_its_five_megabytes_behind(tmp_path):
    page = {"state": {"f": stored("z" * 5_000_000, _widget_layout={}, _widget_data=[])}}
    assert live_pages.slim(page, tmp_path) == []
    assert page["state"]["f"]["model_name"] == "FigureModel"
    assert len(json.dumps(page)) < 200


def test_a_missing_script_is_named_with_what_to_do():
    with pytest.raises(
        RuntimeError, match=r"no-such-package with a\.js is not installed; run `make"
    ):
        offline.find("no-such-package", "a.js")


def test_mathjax_is_the_one_file_that_needs_no_other():
    path = offline.find(*offline.FROM_WHEELS["mathjax.js"])
    text = path.read_text(encoding="utf-8")
    assert 'VERSION="3.2.2"' in text
    assert path.stat().st_size > 1_000_000


def test_a_letter_as_a_description_is_no_list():
    lines = [":param frames: N.", ":param x: the motion.", "plain N."]
    assert docstrings.readable(lines) == [
        ":param frames: *N*.",
        ":param x: the motion.",
        "plain N.",
    ]


def test_a_constant_described_with_a_colon_has_no_type():
    told = ["Orthographic projection: drop the depth.", "", "A second paragraph."]
    made = GoogleDocstring(told, Config(), what="data", name="P").lines()
    assert ":type: Orthographic projection" in made
    docstrings.process(None, "data", "P", None, None, made)
    assert made == told


def test_an_alias_inside_a_tuple_is_written_as_its_name():
    given = "tuple[TypeAliasForwardRef('NDArray'), int]"
    made = docstrings.signature(None, "function", "f", None, None, "(x)", given)
    assert made == ("(x)", "tuple[NDArray, int]")


def test_pages_of_an_earlier_build_go_away(tmp_path):
    (tmp_path / "old.md").write_text("")
    (tmp_path / "kept.md").write_text("")
    places.remove_others(tmp_path, {"kept.md"})
    assert [path.name for path in tmp_path.iterdir()] == ["kept.md"]
    assert places.write_if_new(tmp_path / "kept.md", "new")
    assert not places.write_if_new(tmp_path / "kept.md", "new")


def test_every_part_of_the_package_is_in_the_reference():
    modules = list(pkgutil.iter_modules(projflow_lite.__path__))
    assert {module.name for module in modules if module.ispkg} <= set(reference_pages.PARTS)
    assert set(reference_pages.PARTS) <= {module.name for module in modules}
