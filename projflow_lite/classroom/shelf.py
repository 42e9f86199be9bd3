"""All exercises, and how to find one."""

from __future__ import annotations

from difflib import get_close_matches

from .. import equations
from .exercise import Exercise, ExerciseRecord
from .tasks import applications, flow, guides, metric, posterior, projection

EXERCISES: dict[str, Exercise] = {
    exercise.id: exercise
    for exercise in sorted(
        [
            *flow.EXERCISES,
            *projection.EXERCISES,
            *posterior.EXERCISES,
            *metric.EXERCISES,
            *guides.EXERCISES,
            *applications.EXERCISES,
        ],
        key=lambda exercise: int(exercise.id.split(":")[1]),
    )
}


def exercises() -> list[ExerciseRecord]:
    """Return every exercise: id, title, signature, task and equation, in the paper's order."""
    return [exercise.record for exercise in EXERCISES.values()]


def find(id: str, who: str) -> Exercise:
    """Return the exercise with this id, however it is capitalised.

    Args:
        id: such as ``"projflow:7"``.
        who: the function to name in an error message.

    Raises:
        ValueError: if there is none; the message proposes one.
    """
    wanted = str(id).strip().lower().replace(" ", "")
    if wanted in EXERCISES:
        return EXERCISES[wanted]
    near = _neighbour(wanted)
    advice = f"did you mean '{near}'?" if near else f"there are {', '.join(EXERCISES)}"
    raise ValueError(f"{who}: {id!r} is not an exercise; {advice}")


def _neighbour(wanted: str) -> str:
    """Return the exercise most likely meant, or nothing."""
    names = {exercise.function: exercise.id for exercise in EXERCISES.values()}
    number = wanted.removeprefix("projflow").lstrip(":")
    if f"projflow:{number}" in EXERCISES:
        return f"projflow:{number}"
    for record in equations.catalog():  # several printed equations are one function
        function = record.function.rpartition(".")[2]
        if record.paper == "ProjFlow" and record.number == number and function in names:
            return names[function]
    near = get_close_matches(wanted, [*names, *EXERCISES], n=1)
    return names.get(near[0], near[0]) if near else ""


def hint(id: str, level: int = 1) -> str:
    """Return one of the three hints of an exercise; each says more than the one before.

    Args:
        id: such as ``"projflow:7"``.
        level: 1, 2 or 3.

    Raises:
        ValueError: if there is no such exercise or no such hint.
    """
    exercise = find(id, "hint")
    if level not in (1, 2, 3):
        raise ValueError(f"hint: level is {level!r}, expected 1, 2 or 3")
    return exercise.hints[level - 1]
