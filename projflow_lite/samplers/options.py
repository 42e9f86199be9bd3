"""What the options of samplers may be, and what is said when they are something else."""

from __future__ import annotations

from projflow_lite.skeleton import shown


def check_number(who: str, name: str, value: float, most: float = float("inf")) -> None:
    """Refuse an option that is no number from 0 to `most`."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not 0 <= value <= most or value == float("inf"):
        wanted = "of 0 or more" if most == float("inf") else f"from 0 to {most:g}"
        raise ValueError(f"{who}: {name} is a number {wanted}, not {shown(value)}")


def check_count(who: str, name: str, value: int) -> None:
    """Refuse an option that is no whole number of at least 1."""
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError(f"{who}: {name} is a whole number of at least 1, not {shown(value)}")


def check_choice(who: str, name: str, value: str, choices: tuple[str, str]) -> None:
    """Refuse an option that is neither of two words."""
    if value not in choices:
        first, second = choices
        raise ValueError(f"{who}: {name} is '{first}' or '{second}', not {shown(value)}")


def check_callback(who: str, callback: object) -> None:
    """Refuse a callback that is no function."""
    if callback is not None and not callable(callback):
        raise ValueError(f"{who}: callback is a function of a Step, not {shown(callback)}")
