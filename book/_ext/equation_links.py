"""Every "eq. 7" in a chapter or a docstring becomes a link to the equation's entry."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from names_used import MENTION, SECTION, anchor, records
from sphinx import addnodes
from sphinx.transforms import SphinxTransform

SKIPPED = (
    nodes.reference,
    nodes.title,
    nodes.literal,
    nodes.raw,
    nodes.math,
    addnodes.pending_xref,
)


class LinkEquations(SphinxTransform):
    """Replace what `MENTION` and `SECTION` find by references."""

    default_priority = 210  # after the document was read, before references are resolved

    def apply(self, **kwargs: Any) -> None:
        """Go through all texts of a document."""
        if self.env.docname.startswith("equations/"):
            return
        known = records()
        for text in list(self.document.findall(nodes.Text)):
            if may_not_link(text) or not ("eq" in text or "section" in text):
                continue
            pieces = list(linked(text.astext(), known))
            if any(not isinstance(piece, nodes.Text) for piece in pieces):
                text.parent.replace(text, pieces)


def may_not_link(text: nodes.Text) -> bool:
    """Whether a text stands where no link may be."""
    node = text.parent
    while node is not None:
        if isinstance(node, (*SKIPPED, nodes.literal_block)):
            return True
        node = node.parent
    return False


def linked(text: str, known: Any) -> Iterator[nodes.Node]:
    """A text in pieces: references for equations, texts for the rest."""
    at = 0
    for found in sorted(
        [*MENTION.finditer(text), *SECTION.finditer(text)], key=lambda m: m.start()
    ):
        if found.re is SECTION:
            parts = [("GMD", found[1], found.start(), found.end())]
        else:
            paper, begin = found[1] or "ProjFlow", found.start(2)
            numbers = list(re.finditer(r"\d+", found[2]))
            parts = [(paper, n[0], begin + n.start(), begin + n.end()) for n in numbers]
            parts[0] = (*parts[0][:2], found.start(), parts[0][3])
        for paper, number, start, end in parts:
            if (paper, number) in known and start >= at:
                yield nodes.Text(text[at:start])
                yield reference(text[start:end], anchor(paper, number))
                at = end
    yield nodes.Text(text[at:])


def reference(words: str, target: str) -> nodes.Node:
    """A link that Sphinx resolves to the page on which the target stands."""
    node = addnodes.pending_xref(
        "", refdomain="std", reftype="ref", reftarget=target, refexplicit=True, refwarn=True
    )
    node += nodes.inline("", words, classes=["eq-link"])
    return node


def setup(app: Any) -> dict[str, Any]:
    """Connect to Sphinx."""
    app.add_transform(LinkEquations)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
