"""The index of equations and the page of errata, written from the catalog."""

from __future__ import annotations

import json
from collections import defaultdict
from typing import Any

from chapters import notebooks, title_of
from names_used import anchor, numbers_named, place_of, records
from places import BOOK, ROOT, write_if_new

from projflow_lite.classroom import exercises
from projflow_lite.equations.records.record import Record

PAGES = BOOK / "equations"
INTRODUCTIONS = {
    "ProjFlow": "Projection sampling with flow matching: equations 1 to 20 stand in the paper, "
    "21 to 52 in its supplement ([reference](#ref-projflow)).",
    "GMD": "Guided motion diffusion. Most of its formulas have no number: they are listed by "
    "section, with a letter ([reference](#ref-gmd)).",
    "BMM": "The Bézier motion model. Its equations are listed; functions and checks are still to "
    "be written ([reference](#ref-bmm)).",
}


def write_equation_pages() -> None:
    """Write one page for each paper, the index of them, and the errata."""
    where = chapters_by_equation()
    papers: dict[str, list[Record]] = defaultdict(list)
    for record in records().values():
        papers[record.paper].append(record)
    for paper, listed in papers.items():
        entries = "\n\n".join(
            entry(record, where[record.paper, record.number]) for record in listed
        )
        text = f"# Equations of {paper}\n\n{INTRODUCTIONS[paper]}\n\n{entries}\n"
        write_if_new(PAGES / f"{paper.lower()}.md", text)
    write_if_new(PAGES / "index.md", index(papers))
    write_if_new(PAGES / "errata.md", errata(papers))


def chapters_by_equation() -> dict[tuple[str, str], list[str]]:
    """Links to the chapters that name an equation."""
    where: dict[tuple[str, str], list[str]] = defaultdict(list)
    for path in notebooks():
        notebook = json.loads(path.read_text(encoding="utf-8"))
        link = f"[{title_of(notebook, path.name)}](../chapters/{path.name})"
        for paper, number, _ in numbers_named(notebook):
            where[paper, number].append(link)
    return where


def entry(record: Record, chapters: list[str]) -> str:
    """Everything about one equation."""
    name = anchor(record.paper, record.number)
    parts = [f"({name})=\n## {record.number} · {record.title}", f"$$\n{record.latex}\n$$"]
    if record.function:
        place = place_of(record.function) or record.function
        short = record.function.removeprefix("projflow_lite.")
        parts.append(f"Function: {{py:func}}`{short} <{place}>`")
    else:
        parts.append("No function yet.")
    parts += exercise(record)
    if chapters:
        parts.append("In chapters: " + " · ".join(chapters))
    if record.erratum:
        parts.append(f":::{{admonition}} Erratum\n:class: warning\n\n{plain(record.erratum)}\n:::")
    if record.check:
        parts.append(check(record.check))
    return "\n\n".join(parts)


def exercise(record: Record) -> list[str]:
    """How a reader's own version is checked, if there is a check."""
    name = f"{record.paper.lower()}:{record.number}"
    there = {each.id for each in exercises()}
    return [f'Check your own: `check("{name}", my_function)`'] if name in there else []


def check(dotted: str) -> str:
    """The test that checks an equation from outside, to be unfolded."""
    *module, function = dotted.split(".")
    path = "/".join(module) + ".py"
    if not (ROOT / path).exists():
        return f"Checked by `{dotted}`."
    return (
        f"<details><summary>Checked by <code>{function}</code></summary>\n\n"
        f"```{{literalinclude}} ../../{path}\n:pyobject: {function}\n:caption: {path}\n```\n\n"
        "</details>"
    )


def plain(text: str) -> str:
    """Text for Markdown: an underscore or a star is itself."""
    return text.replace("_", r"\_").replace("*", r"\*")


def index(papers: dict[str, list[Record]]) -> str:
    """The table of all equations."""
    rows = []
    for listed in papers.values():
        for r in listed:
            place = place_of(r.function) if r.function else None
            function = f"{{py:func}}`{r.function.rpartition('.')[2]} <{place}>`" if place else ""
            link = f"[{r.paper} {r.number}](#{anchor(r.paper, r.number)})"
            rows.append(
                f"| {link} | {r.title} | {function} | {r.status} | {'yes' if r.erratum else ''} |"
            )
    checked = sum(r.status == "checked" for listed in papers.values() for r in listed)
    head = (
        f"{len(rows)} printed equations, {checked} of them with a function and with a check that "
        "does not use it."
    )
    toctree = ["```{toctree}", ":maxdepth: 1", "", *map(str.lower, papers), "errata", "```"]
    table = ["| equation | what it says | function | status | erratum |", "|---|---|---|---|---|"]
    return "\n".join(["# Index of equations", "", head, "", *toctree, "", *table, *rows, ""])


def errata(papers: dict[str, list[Record]]) -> str:
    """Where a paper or its public code does not hold as printed."""
    parts = [
        "# Errata",
        "What is wrong, or open to mistake, in print or in the public code. Each has a "
        "counterexample that runs: `projflow-lite derive` prints them, and the chapter "
        "[on print and derivation](../chapters/06_where_print_and_derivation_part.ipynb) shows the "
        "larger ones. What four of them do to motions is measured among "
        "[the tables](../tables.md).",
    ]
    for paper, listed in papers.items():
        rows = [
            f"| [{r.number}](#{anchor(r.paper, r.number)}) | {r.title} | {plain(r.erratum)} |"
            for r in listed if r.erratum
        ]  # fmt: skip
        if rows:
            parts += [
                f"## {paper}",
                "\n".join(["| equation | title | erratum |", "|---|---|---|", *rows]),
            ]
    return "\n\n".join(parts) + "\n"


def setup(app: Any) -> dict[str, Any]:
    """Nothing to connect: the pages are written before Sphinx looks for them."""
    return {"parallel_read_safe": True}
