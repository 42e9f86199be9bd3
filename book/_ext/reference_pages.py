"""The reference: a page for each part of the package, filled from docstrings by autodoc."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from types import ModuleType
from typing import Any

from places import BOOK, remove_others, write_if_new

import projflow_lite as pf

PAGES = BOOK / "reference"
PARTS = {
    "equations": "The papers, executable",
    "constraints": "Wishes",
    "skeleton": "The skeleton",
    "motion": "Motions",
    "projection": "The fast projection",
    "prior": "The prior",
    "samplers": "Samplers",
    "scores": "Scores",
    "studies": "Studies",
    "derivations": "Derivations",
    "classroom": "The classroom",
    "widgets": "Widgets",
    "exchange": "Pictures and films",
}
"""What a reader may want to look up, from the bottom of the house upwards."""


def write_reference() -> None:
    """Write a page for each part, and the first page with the names of ``pf``."""
    for part, title in PARTS.items():
        write_if_new(PAGES / f"{part}.md", page(part, title))
    write_if_new(PAGES / "index.md", front())
    remove_others(PAGES, {f"{part}.md" for part in PARTS} | {"index.md"})


def modules(part: str) -> list[ModuleType]:
    """A part's modules that have something public of their own."""
    package = importlib.import_module(f"projflow_lite.{part}")
    names = [package.__name__]
    if hasattr(package, "__path__"):
        names += [m.name for m in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")]
    found = [importlib.import_module(name) for name in names if "._" not in name]
    return [module for module in found if own_names(module)]


def own_names(module: ModuleType) -> list[str]:
    """Public functions and classes that a module defines itself."""
    things = {name: thing for name, thing in vars(module).items() if not name.startswith("_")}
    return [
        name for name, thing in things.items()
        if (inspect.isfunction(thing) or inspect.isclass(thing))
        and thing.__module__ == module.__name__ and thing.__doc__
    ]  # fmt: skip


def page(part: str, title: str) -> str:
    """A part's page: the words of its own docstring, then its modules."""
    package = importlib.import_module(f"projflow_lite.{part}")
    listed = modules(part)
    sections = [section(module) for module in listed]
    opening = (
        "" if package in listed else rst(f".. automodule:: projflow_lite.{part}\n   :no-members:")
    )
    return "\n\n".join([f"# {title}", opening, *sections]) + "\n"


def section(module: ModuleType) -> str:
    """One module, members in the order of its source."""
    name = module.__name__.removeprefix("projflow_lite.")
    return f"## `{name}`\n\n" + rst(
        f".. automodule:: {module.__name__}\n   :members:\n   :ignore-module-all:"
    )


def rst(text: str) -> str:
    """A block of reStructuredText in a Markdown page: docstrings are written in it."""
    return f"```{{eval-rst}}\n{text}\n```"


def front() -> str:
    """The first page: what ``import projflow_lite as pf`` gives, and the parts."""
    rows = []
    for name in pf.__all__:
        thing = getattr(pf, name)
        role = "class" if inspect.isclass(thing) else "func"
        target = f"{thing.__module__}.{thing.__qualname__}"
        first = (inspect.getdoc(thing) or "").partition("\n")[0]
        rows.append(f"| {{py:{role}}}`pf.{name} <{target}>` | {first} |")
    return "\n".join([
        "# Reference", "", "After `import projflow_lite as pf`:", "",
        "| name | what it is |", "|---|---|", *rows, "",
        "```{toctree}", ":maxdepth: 1", "", *PARTS, "```", "",
    ])  # fmt: skip


def source_of(app: Any, module: str, attribute: str) -> str | None:
    """Which module a [source] link leads to: the one that documents the thing, or none.

    Left alone, viewcode follows a name to wherever it was first defined, and is then mistaken
    about where everything else of that module is documented. A property has no module: no link.
    """
    thing: Any = importlib.import_module(module)
    for part in attribute.split("."):
        thing = getattr(thing, part, None)
    return module if getattr(thing, "__module__", None) else None


def setup(app: Any) -> dict[str, Any]:
    """Connect to Sphinx."""
    app.connect("viewcode-follow-imported", source_of)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
