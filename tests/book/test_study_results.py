"""The page of tables: what it says of a study with records, without, and with old ones."""

from __future__ import annotations

import json
import re
import shutil

import pytest
import study_results
from docutils import nodes
from places import BOOK
from sphinx.application import Sphinx

from projflow_lite.studies import errata_words
from projflow_lite.studies.cells import ALL, DATA
from projflow_lite.studies.commands import STUDIES
from projflow_lite.studies.errata_forms import ERRATA

PAGE = (BOOK / "tables.md").read_text(encoding="utf-8")
NAMES = re.findall(r"^```\{study-results\} (\S+)$", PAGE, re.MULTILINE)


def made_up(joint, keys, method):
    cell = {"mean": 2.0, "half width": 0.1, "values": [1.9, 2.1]}
    about = {"joint": joint, "keys": keys, "method": method, "seeds": 2, "clips": 32, "steps": 9}
    return about | {"scores": dict.fromkeys(errata_words.SHOWN, cell)}


@pytest.fixture
def book(tmp_path, monkeypatch):
    """A book with made-up records of the study of errata, which were made with the shipped prior."""
    monkeypatch.setattr(study_results, "shipped", lambda: "abcd")
    methods = dict.fromkeys(rival.name for erratum in ERRATA for rival in erratum.rivals)
    rows = [made_up(ALL, ALL, DATA)]
    rows += [made_up("pelvis", keys, name) for keys in (5, ALL) for name in methods]
    known = {"prior": "abcd", "quick": False, "rows": rows}
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "errata.json").write_text(json.dumps(known))
    return tmp_path


def texts(found, kind):
    return [node.astext() for top in found for node in top.findall(kind)]


def test_every_section_names_its_command_before_its_results():
    assert len(NAMES) == len(set(NAMES)) == 9
    commands = re.findall(r"^projflow-lite reproduce (\S+)", PAGE, re.MULTILINE)
    assert commands == NAMES
    assert set(NAMES) <= set(STUDIES)
    assert len(re.findall(r"^\*\*To conclude\.\*\*", PAGE, re.MULTILINE)) == len(NAMES)
    assert len(re.findall(r"^\*\*Not to conclude\.\*\*", PAGE, re.MULTILINE)) == len(NAMES)


def test_the_page_itself_has_no_measured_number():
    """Numbers come from records; a ± or a decimal in the text would be one that nobody remakes."""
    text = re.sub(r"```.*?```", "", PAGE, flags=re.DOTALL)
    assert not re.findall(r"\d\.\d|± ?\d", text)


def test_a_study_that_was_not_run_is_said_to_be_so(tmp_path):
    (only,) = study_results.content("errata", tmp_path)
    assert only.astext() == study_results.NOT_RUN


def test_records_become_sentences_and_the_table_of_the_command(book):
    found = study_results.content("errata", book)
    rows = json.loads((book / "results/errata.json").read_text())["rows"]
    said = errata_words.sentences(rows)
    assert texts(found, nodes.list_item) == said
    (block,) = texts(found, nodes.literal_block)
    shown = errata_words.table(rows)
    assert block in shown
    assert shown.splitlines()[0] in texts(found, nodes.paragraph)
    assert "eq. 9, keyframes: 5" in block
    assert not any(sentence in block for sentence in said)
    assert not texts(found, nodes.image)
    assert study_results.NOT_RUN not in texts(found, nodes.paragraph)


def test_many_sentences_are_unfolded(book, monkeypatch):
    monkeypatch.setattr(study_results, "FIRST", 2)
    found = study_results.content("errata", book)
    folded = [node.astext() for node in found if isinstance(node, nodes.raw)]
    count = len(texts(found, nodes.list_item))
    assert folded == [f"<details><summary>{count - 2} more sentences</summary>", "</details>"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, []),
        ({"prior": "dead"}, [study_results.EARLIER]),
        ({"prior": None}, [study_results.UNSAID]),
        ({"quick": True}, [study_results.QUICK]),
    ],
)
def test_old_and_quick_records_are_said_to_be_so(book, change, said):
    path = book / "results" / "errata.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    doubts = {study_results.EARLIER, study_results.UNSAID, study_results.QUICK}
    shown = texts(study_results.content("errata", book), nodes.paragraph)
    assert [text for text in shown if text in doubts] == said


def test_a_picture_is_shown_if_there_is_one(book):
    (book / "pictures").mkdir()
    (book / "pictures" / "errata.png").write_bytes(b"")
    (shown,) = [n for n in study_results.content("errata", book) if isinstance(n, nodes.image)]
    assert shown["uri"] == "/pictures/errata.png"
    assert shown["width"]  # so that it leads to its full size


@pytest.mark.parametrize("name", NAMES)
def test_records_of_this_book_can_be_shown(name):
    found = study_results.content(name, BOOK)
    ran = (BOOK / "results" / f"{name}.json").exists()
    assert (study_results.NOT_RUN in texts(found, nodes.paragraph)) is not ran


def test_a_page_is_built_without_records_and_again_when_there_are_some(book, tmp_path, monkeypatch):
    monkeypatch.setattr(study_results, "BOOK", book)
    source = tmp_path / "source"
    source.mkdir()
    (source / "index.md").write_text("# A page\n\n```{study-results} errata\n```\n")
    records = book / "results" / "errata.json"
    aside = records.rename(tmp_path / "aside.json")
    pages = []
    for ran in (False, True):
        if ran:
            shutil.copy(aside, records)
        app = Sphinx(
            source, None, tmp_path / "out", tmp_path / "trees", "html", status=None,
            confoverrides={"extensions": ["myst_parser", "study_results"], "project": "p"},
            warningiserror=True,
        )  # fmt: skip
        app.build()
        pages.append((tmp_path / "out" / "index.html").read_text())
    assert study_results.NOT_RUN in pages[0]
    assert "eq. 9, keyframes: 5" not in pages[0]
    assert study_results.NOT_RUN not in pages[1]
    assert "eq. 9, keyframes: 5" in pages[1]
