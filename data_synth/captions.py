"""What a person would call a clip; captions say only what the parameters did."""

from __future__ import annotations

import numpy as np

WHO = ("a person", "someone", "a man", "a woman", "the person")
LEFT_RIGHT = {1.0: "left", -1.0: "right"}
REACH = (
    ("reaches forward with the {hand} hand", "stretches the {hand} arm out in front"),
    ("reaches up with the {hand} hand", "reaches for something high with the {hand} hand"),
    (
        "reaches down with the {hand} hand",
        "bends and reaches for something low with the {hand} hand",
    ),
    ("reaches out to the {hand} with the {hand} hand", "stretches the {hand} arm out to the side"),
)
WALK = ("walks forward", "walks ahead", "walks straight ahead", "is walking forward")
RUN = ("runs forward", "runs straight ahead", "is running forward", "runs ahead")
BACK = ("walks backward", "walks backwards", "steps back", "is walking backward")
SIDE = ("steps to the {way}", "sidesteps to the {way}", "walks sideways to the {way}")
CURVE = ("walks in a curve to the {way}", "walks and turns {way}", "walks forward and curves {way}")
S_CURVE = ("walks in an s shape", "walks along a winding path", "walks in an s curve")
JUMP = ("jumps up", "jumps in place", "jumps up and down once", "jumps on the spot")
JUMP_AHEAD = ("jumps forward", "makes a jump forward", "leaps forward")
SQUAT = (
    "squats down and stands up",
    "squats",
    "does a squat",
    "bends the knees and comes up again",
)
SQUATS = ("squats twice", "does two squats")
WAVE = ("waves with the {hand} hand", "waves the {hand} hand", "raises the {hand} hand and waves")
WAVE_BOTH = ("waves with both hands", "waves both hands", "raises both arms and waves")
IDLE = ("stands still", "stands", "is standing", "stands and looks around", "waits")
WALK_AND_WAVE = (
    "walks forward and waves with the {hand} hand",
    "waves the {hand} hand while walking",
    "walks ahead waving with the {hand} hand",
)


def pace(speed: float, slow: float, fast: float) -> str:
    """An adverb for a speed that stands out, or nothing."""
    return " slowly" if speed < slow else " quickly" if speed > fast else ""


def phrases(action: str, drawn: dict[str, float]) -> tuple[tuple[str, ...], str]:
    """What may be said of a clip, and an adverb for it."""
    side = LEFT_RIGHT.get(drawn.get("side", 0.0), "")
    speed = drawn.get("speed", 0.0)
    if action == "walk":
        return WALK, pace(speed, 0.95, 1.45)
    if action == "run":
        return RUN, pace(speed, 2.7, 3.4)
    if action == "walk_backward":
        return BACK, pace(-speed, 0.62, 0.88)
    if action == "walk_curve":
        named = S_CURVE if drawn["s_curve"] else tuple(p.format(way=side) for p in CURVE)
        return named, pace(speed, 0.9, 1.3)
    if action == "sidestep":
        return tuple(p.format(way=side) for p in SIDE), ""
    if action == "jump":
        return (JUMP_AHEAD if drawn["ahead"] > 0.15 else JUMP), ""
    if action == "squat":
        return (SQUATS if drawn["times"] == 2 else SQUAT), ""
    if action == "wave":
        return (tuple(p.format(hand=side) for p in WAVE) if side else WAVE_BOTH), ""
    if action == "reach":
        return tuple(p.format(hand=side) for p in REACH[int(drawn["kind"])]), ""
    if action == "walk_and_wave":
        return tuple(p.format(hand=side) for p in WALK_AND_WAVE), ""
    return IDLE, ""


def caption(action: str, drawn: dict[str, float], random: np.random.Generator) -> str:
    """One sentence for one clip."""
    said, adverb = phrases(action, drawn)
    who = WHO[0] if random.random() < 0.6 else WHO[random.integers(len(WHO))]
    return f"{who} {said[random.integers(len(said))]}{adverb}"
