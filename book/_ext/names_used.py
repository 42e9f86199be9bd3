"""Which equations and functions a notebook speaks of: the links between text and code."""

from __future__ import annotations

import ast
import re
from typing import Any

import projflow_lite as pf
from projflow_lite.equations import catalog
from projflow_lite.equations.records.record import Record

# "eq. 7", "eq. 7–10", "eq. 5, 7, 9 and 10", "eq. 9 or 10"
ONE = r"\d+(?:\s?[–-]\s?\d+)?"
MENTION = re.compile(
    rf"(?:\b(ProjFlow|GMD|BMM) )?\beqs?\.\s({ONE}(?:(?:, {ONE})* (?:and|or|to) {ONE})?)"
)
SECTION = re.compile(r"\bGMD section ([45](?:\.\d)? \([a-e]\))")
CHECKED = re.compile(r"check\(\s*[\"'](\w+):([^\"']+)[\"']")
PAPERS = {"projflow": "ProjFlow", "gmd": "GMD", "bmm": "BMM"}


def anchor(paper: str, number: str) -> str:
    """The target of an equation's entry, for example ``eq-gmd-4-1-a``."""
    return "eq-" + re.sub(r"[^a-z0-9]+", "-", f"{paper} {number}".lower()).strip("-")


def records() -> dict[tuple[str, str], Record]:
    """The catalog, by paper and number."""
    return {(record.paper, record.number): record for record in catalog()}


def expand(listed: str) -> list[str]:
    """The numbers in "5, 7–9 and 12"."""
    numbers: list[str] = []
    for first, last in re.findall(r"(\d+)(?:\s?[–-]\s?(\d+))?", listed):
        numbers += [str(n) for n in range(int(first), int(last or first) + 1)]
    return numbers


def numbers_named(notebook: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Paper, number and anchor of every equation that a notebook names, in the catalog's order."""
    text = "\n".join("".join(cell["source"]) for cell in notebook["cells"])
    named = {(PAPERS.get(paper, paper), number) for paper, number in CHECKED.findall(text)}
    for paper, listed in MENTION.findall(text):
        named |= {(paper or "ProjFlow", number) for number in expand(listed)}
    named |= {("GMD", number) for number in SECTION.findall(text)}
    return [(*key, anchor(*key)) for key in records() if key in named]


def function_lines(notebook: dict[str, Any]) -> list[str]:
    """A link to the reference for every public thing of the package that the code calls."""
    names = set()
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            names |= calls(ast.parse("".join(cell["source"])))
    found = {place: name for name in sorted(names) if (place := place_of(name))}
    return [
        f"{{py:obj}}`{name} <{place}>`" for place, name in sorted(found.items(), key=lambda x: x[1])
    ]


def calls(tree: ast.AST) -> set[str]:
    """Dotted names under the package that code uses, with its aliases undone."""
    aliases: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("projflow_lite"):
            for name in node.names:
                aliases[name.asname or name.name] = f"{node.module}.{name.name}"
        if isinstance(node, ast.Import):
            for name in node.names:
                if name.name.startswith("projflow_lite") and name.asname:
                    aliases[name.asname] = name.name
    defaults = {"pf": "projflow_lite", "eq": "projflow_lite.equations"} | aliases
    used = set()
    for node in ast.walk(tree):
        dotted = ast.unparse(node) if isinstance(node, ast.Attribute | ast.Name) else ""
        head, _, rest = dotted.partition(".")
        if head in defaults and re.fullmatch(r"[\w.]+", dotted):
            used.add(".".join(filter(None, [defaults[head], rest])))
    return used


def place_of(dotted: str) -> str | None:
    """Where a public function or class is defined and documented; None for anything else."""
    parts = dotted.split(".")
    thing: Any = pf
    for part in parts[1:]:
        try:
            thing = getattr(thing, part)
        except (AttributeError, ModuleNotFoundError):
            return None
    home = getattr(thing, "__module__", None) or ""
    if not callable(thing) or not home.startswith("projflow_lite"):
        return None
    return f"{home}.{thing.__qualname__}" if hasattr(thing, "__qualname__") else None
