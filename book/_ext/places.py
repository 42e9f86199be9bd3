"""Where things are, and the one way in which generated pages are written."""

from __future__ import annotations

from pathlib import Path

BOOK = Path(__file__).parents[1]
ROOT = BOOK.parent
BUILD = BOOK / "_build"
NOTEBOOKS = ROOT / "notebooks"


def write_if_new(path: Path, text: str) -> bool:
    """Write a file unless it already says this: Sphinx reads again whatever has a new date.

    Returns:
        whether it was written.
    """
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return True


def remove_others(folder: Path, names: set[str]) -> None:
    """Remove pages of an earlier build whose source is gone."""
    for path in folder.glob("*"):
        if path.is_file() and path.name not in names:
            path.unlink()
