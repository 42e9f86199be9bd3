"""Directive ``{study-results} NAME``: what a study found, from its records, or that it was not run.

Numbers in the book come from the records that a command wrote, never from a page: the directive
prints what the study itself makes of them, its picture, its sentences and its table.
"""

from __future__ import annotations

import importlib
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from docutils import nodes
from places import BOOK
from sphinx.util.docutils import SphinxDirective

FIRST = 8
"""Sentences that are shown at once; studies begin with what matters most."""

NOT_RUN = "Not run yet: the command above makes it."
EARLIER = (
    "Measured with another prior than the one shipped today: the command above measures it anew."
)
UNSAID = "These records do not say which prior they are of: the command above measures it anew."
QUICK = "This was a quick look, with few clips and seeds: its intervals are wide."


class StudyResults(SphinxDirective):
    """What is known of one study, a name of ``projflow-lite reproduce``."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The nodes; the page is read again when the records or the picture change."""
        name = self.arguments[0]
        for path in (records_of(BOOK, name), picture_of(BOOK, name)):
            self.env.note_dependency(str(path))
        return content(name, BOOK)


def records_of(book: Path, name: str) -> Path:
    """Where the records of a study are."""
    return book / "results" / f"{name}.json"


def picture_of(book: Path, name: str) -> Path:
    """And its picture."""
    return book / "pictures" / f"{name}.png"


def content(name: str, book: Path) -> list[nodes.Node]:
    """What a page says of a study.

    Args:
        name: of the study.
        book: the folder that has ``results`` and ``pictures``.
    """
    path = records_of(book, name)
    if not path.exists():
        return [paragraph(NOT_RUN)]
    known = json.loads(path.read_text(encoding="utf-8"))
    study = importlib.import_module(f"projflow_lite.studies.{name.replace('-', '_')}")
    said = study.sentences(known["rows"]) if hasattr(study, "sentences") else []
    found = [paragraph(text) for text in doubts(known)]
    if picture_of(book, name).exists():
        found.append(picture(name))
    found += listed(said)
    return found + tabled(study.table(known["rows"]), said)


def picture(name: str) -> nodes.Node:
    """The picture as wide as the page; because it has a width, Sphinx links it to its full size."""
    about = f"The study {name} as a picture"
    return nodes.image(uri=f"/pictures/{name}.png", alt=about, width="100%")


def doubts(known: dict[str, Any]) -> list[str]:
    """Why the records may not be what the command makes today."""
    own = known.get("prior")
    said = [UNSAID] if own is None else [EARLIER] if own != shipped() else []
    return said + ([QUICK] if known.get("quick") else [])


@cache
def shipped() -> str:
    """Tells the shipped prior from others."""
    from projflow_lite.prior import load_prior
    from projflow_lite.studies.cells import fingerprint

    return fingerprint(load_prior())


def listed(sentences: Sequence[str]) -> list[nodes.Node]:
    """A list of sentences, most of a long one to be unfolded."""
    found: list[nodes.Node] = [bullets(sentences[:FIRST])] if sentences else []
    if len(sentences) > FIRST:
        more = f"{len(sentences) - FIRST} more sentences"
        found += [raw(f"<details><summary>{more}</summary>"), bullets(sentences[FIRST:])]
        found.append(raw("</details>"))
    return found


def tabled(text: str, sentences: Sequence[str]) -> list[nodes.Node]:
    """The table that the command prints, without the sentences at its end."""
    lines = text.splitlines()
    if sentences and lines[-len(sentences) :] == list(sentences):
        lines = lines[: -len(sentences)]
    found: list[nodes.Node] = []
    if lines[0].endswith("."):
        found.append(paragraph(lines.pop(0)))
    body = "\n".join(lines).strip("\n")
    return [*found, nodes.literal_block(body, body, language="none", classes=["study-table"])]


def paragraph(text: str) -> nodes.Node:
    """A paragraph of plain text."""
    return nodes.paragraph("", text)


def bullets(sentences: Sequence[str]) -> nodes.Node:
    """A list."""
    return nodes.bullet_list("", *(nodes.list_item("", paragraph(text)) for text in sentences))


def raw(html: str) -> nodes.Node:
    """A piece of HTML."""
    return nodes.raw("", html, format="html")


def setup(app: Any) -> dict[str, Any]:
    """Connect to Sphinx."""
    app.add_directive("study-results", StudyResults)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
