"""What a person would call a clip; captions say only what the parameters did.

`SAID` holds, for every action and case, several ways to say it. ``{side}`` is the hand, leg or
direction, ``{other}`` the opposite one, ``{times}`` how often (nothing if once).
"""

from __future__ import annotations

import numpy as np

WHO = ("a person", "someone", "a man", "a woman", "the person")
LEFT_RIGHT = {1.0: "left", -1.0: "right"}
TIMES = {2: " twice", 3: " three times"}
SLOWLY, QUICKLY = " slowly", " quickly"

SAID: dict[str, tuple[str, ...]] = {
    "walk": (
        "walks forward", "walks ahead", "walks straight ahead", "is walking forward",
        "walks in a straight line", "goes forward on foot",
    ),
    "run": (
        "runs forward", "runs straight ahead", "is running forward", "runs ahead",
        "runs in a straight line",
    ),
    "jog": (
        "jogs forward", "jogs ahead", "is jogging", "jogs straight ahead",
        "jogs in a straight line",
    ),
    "sneak": (
        "sneaks forward", "sneaks ahead", "is sneaking", "walks forward bent over and low",
        "walks low with bent knees", "sneaks with bent knees",
    ),
    "walk_backward": (
        "walks backward", "walks backwards", "steps back", "is walking backward", "goes backward",
    ),
    "sidestep": (
        "steps to the {side}", "sidesteps to the {side}", "walks sideways to the {side}",
        "goes sideways to the {side}", "is stepping to the {side}",
    ),
    "walk_curve": (
        "walks in a curve to the {side}", "walks and turns {side}",
        "walks forward and curves {side}", "walks in a wide curve to the {side}",
        "walks along a curve to the {side}",
    ),
    "walk_curve s": (
        "walks in an s curve", "walks in curves", "walks along an s curve",
        "walks to one side and then to the other",
    ),
    "walk_turn": (
        "walks forward and turns {side}", "walks and then turns to the {side}",
        "walks and turns to the {side}", "walks ahead, then turns {side} and walks on",
        "turns {side} while walking",
    ),
    "walk_turn round": (
        "walks forward, turns around and walks back", "walks and turns around to the {side}",
        "walks ahead, then turns around", "turns around to the {side} while walking",
        "walks, turns around and goes back",
    ),
    "walk_start": (
        "starts walking", "stands and then starts walking", "stands, then walks forward",
        "starts to walk forward", "starts to walk ahead from standing",
    ),
    "walk_stop": (
        "walks and stops", "walks forward, then stops", "stops walking",
        "walks ahead and then stands still", "walks, stops and stands",
    ),
    "march": (
        "marches in place", "walks in place with high knees", "marches on the spot",
        "lifts the knees high in place", "steps in place", "is marching on the spot",
    ),
    "turn": (
        "turns to the {side} on the spot", "turns {side} in place", "turns {side} with small steps",
        "is turning to the {side} in place", "stands and turns to the {side}",
    ),
    "turn round": (
        "turns around to the {side} on the spot", "turns around in place",
        "turns around with small steps", "stands and turns around to the {side}",
        "is turning around on the spot",
    ),
    "jump": (
        "jumps up", "jumps in place", "jumps up and comes down", "jumps on the spot",
        "makes a jump in place", "bends the knees and jumps up",
    ),
    "jump ahead": (
        "jumps forward", "makes a jump forward", "jumps ahead",
        "bends the knees and jumps forward",
    ),
    "hop": (
        "hops{times} on the {side} leg", "hops in place{times} on the {side} foot",
        "hops on one leg{times}, the {side} one", "jumps{times} on the {side} leg",
        "hops on the spot{times} on the {side} leg",
    ),
    "hop ahead": (
        "hops forward{times} on the {side} leg", "hops ahead{times} on the {side} foot",
        "hops forward on one leg{times}, the {side} one", "jumps forward{times} on the {side} leg",
    ),
    "squat": (
        "squats down and stands up{times}", "squats{times}", "goes down into a squat{times}",
        "bends the knees and comes up again{times}", "goes down and up in a squat{times}",
    ),
    "sit down": (
        "sits down", "sits down on a chair", "is sitting down", "sits down on something low",
        "goes from standing to sitting",
    ),
    "sit up": (
        "stands up from a chair", "stands up", "gets up from a chair", "gets up from sitting",
        "goes from sitting to standing",
    ),
    "sit down and up": (
        "sits down and stands up", "sits down and gets up again", "sits down, then stands up",
        "sits down on a chair and gets up", "sits down and stands up again",
    ),
    "bow": (
        "bows{times}", "bows down{times}", "bends forward and comes up{times}",
        "bends over and stands up again{times}", "makes a bow{times}",
    ),
    "lunge": (
        "lunges forward with the {side} leg{times}", "does a lunge with the {side} leg{times}",
        "makes a lunge with the {side} leg{times}",
        "steps far forward with the {side} foot and steps back{times}",
        "lunges ahead on the {side} leg{times}",
    ),
    "kick": (
        "kicks with the {side} leg{times}", "kicks with the {side} foot{times}",
        "kicks forward with the {side} leg{times}", "makes a kick with the {side} foot{times}",
        "kicks ahead with the {side} leg{times}",
    ),
    "kick high": (
        "kicks high with the {side} leg{times}", "makes a high kick with the {side} foot{times}",
        "kicks up with the {side} leg{times}", "kicks with the {side} leg{times}",
    ),
    "balance": (
        "stands on the {side} leg", "stands on one leg, the {side} one",
        "balances on the {side} foot", "balances on the {side} leg",
        "stands on the {side} leg and lifts the {other} foot",
        "lifts the {other} foot and balances",
    ),
    "wave": (
        "waves with the {side} hand", "waves the {side} hand", "raises the {side} hand and waves",
        "is waving with the {side} hand", "lifts the {side} arm and waves",
    ),
    "wave both": (
        "waves with both hands", "waves both hands", "raises both arms and waves",
        "is waving with both hands", "waves both arms",
    ),
    "reach ahead": (
        "reaches forward with the {side} hand{times}", "reaches ahead with the {side} hand{times}",
        "stretches the {side} arm out in front{times}", "reaches out with the {side} hand{times}",
    ),
    "reach up": (
        "reaches up with the {side} hand{times}", "stretches the {side} arm up{times}",
        "reaches for something high with the {side} hand{times}",
        "reaches high up with the {side} arm{times}",
    ),
    "reach down": (
        "reaches down with the {side} hand{times}",
        "bends and reaches for something low with the {side} hand{times}",
        "reaches low with the {side} hand{times}", "bends down with the {side} arm out{times}",
    ),
    "reach aside": (
        "reaches out to the {side} with the {side} hand{times}",
        "stretches the {side} arm out to the side{times}", "reaches to the {side}{times}",
        "leans and reaches to the {side} side{times}",
    ),
    "point ahead": (
        "points forward with the {side} hand", "points ahead with the {side} hand",
        "points straight ahead with the {side} arm", "is pointing forward with the {side} hand",
    ),
    "point up": (
        "points up with the {side} hand", "points up high with the {side} arm",
        "points at something high with the {side} hand", "is pointing up with the {side} hand",
    ),
    "point aside": (
        "points to the {side} with the {side} hand", "points to the {side}",
        "points to the side with the {side} arm", "is pointing to the {side}",
    ),
    "clap": (
        "claps", "claps both hands", "is clapping", "claps in front of the body",
        "stands and claps", "brings both hands together and claps",
    ),
    "throw": (
        "throws something with the {side} hand{times}", "throws a ball with the {side} hand{times}",
        "throws forward with the {side} arm{times}", "makes a throw with the {side} hand{times}",
        "throws a ball ahead with the {side} arm{times}",
    ),
    "punch": (
        "punches with the {side} hand{times}", "punches forward with the {side} arm{times}",
        "raises both hands and punches with the {side} one{times}",
        "makes a punch with the {side} hand{times}",
    ),
    "punch both": (
        "punches with both hands", "punches left and right",
        "punches with the left and the right hand",
        "punches with one hand and then the other",
    ),
    "carry": (
        "holds something with both hands", "holds a box", "stands and holds a box with both hands",
        "is holding a box in front of the body", "stands with a box in both hands",
    ),
    "draw circle": (
        "draws a circle in the air with the {side} hand", "moves the {side} hand in a circle",
        "makes a circle with the {side} arm", "draws circles with the {side} hand",
        "is drawing a circle with the {side} hand",
    ),
    "draw eight": (
        "draws a figure eight in the air with the {side} hand",
        "moves the {side} hand in a figure eight", "draws an eight with the {side} hand",
        "makes a figure eight with the {side} arm",
    ),
    "draw line": (
        "draws a line up and down in the air with the {side} hand",
        "moves the {side} hand up and down", "moves the {side} arm up and down in front",
        "draws a straight line with the {side} hand",
    ),
    "raise_arms aside": (
        "raises both arms to the sides{times}", "lifts both arms out to the sides{times}",
        "stretches both arms out to the sides{times}", "raises the arms sideways{times}",
    ),
    "raise_arms ahead": (
        "raises both arms in front{times}", "lifts both arms forward{times}",
        "stretches both arms out in front{times}", "raises the arms ahead{times}",
    ),
    "raise_arms up": (
        "raises both arms up{times}", "lifts both arms over the head{times}",
        "stretches both arms up high{times}", "raises the arms over the head{times}",
    ),
    "walk_and_wave": (
        "walks forward and waves with the {side} hand", "waves the {side} hand while walking",
        "walks ahead waving with the {side} hand", "walks and waves the {side} hand",
    ),
    "walk_and_point ahead": (
        "walks and points forward with the {side} hand",
        "points ahead with the {side} hand while walking",
        "walks ahead pointing forward with the {side} arm",
        "walks forward and points ahead with the {side} hand",
    ),
    "walk_and_point up": (
        "walks and points up with the {side} hand", "points up with the {side} hand while walking",
        "walks ahead pointing up with the {side} arm",
        "walks forward and points high up with the {side} hand",
    ),
    "walk_and_point aside": (
        "walks and points to the {side}", "points to the {side} while walking",
        "walks ahead pointing to the {side}", "walks forward and points to the {side}",
    ),
    "walk_and_carry": (
        "walks forward carrying a box", "carries a box with both hands",
        "walks and carries something with both hands", "carries a box while walking ahead",
        "walks ahead holding a box in front",
    ),
    "sway": (
        "sways from side to side", "sways left and right", "is swaying", "sways on the spot",
        "stands and sways the hips",
    ),
    "idle": (
        "stands still", "stands", "is standing", "stands and looks around", "waits",
        "stands and waits", "stands in place",
    ),
}  # fmt: skip
"""What may be said, by action and, after a space, by case."""

CASES = {
    "sit": (" down", " up", " down and up"),
    "reach": (" ahead", " up", " down", " aside"),
    "point": (" ahead", " up", " aside"),
    "walk_and_point": (" ahead", " up", " aside"),
    "draw": (" circle", " eight", " line"),
    "raise_arms": (" aside", " ahead", " up"),
}
"""What the parameter ``kind`` of an action means."""

PACE = {
    "walk": (0.95, 1.45),
    "run": (2.7, 3.4),
    "walk_backward": (0.62, 0.88),
    "walk_curve": (0.9, 1.3),
    "clap": (1.5, 2.1),
    "sway": (0.43, 0.65),
}
"""Below the first number an action is slow, above the second it is quick."""

HIGH_KICK, FAR_JUMP, HALF_ROUND = 0.48, 0.15, 2.5
"""Metres, metres and radians beyond which it is called so."""


def case(action: str, drawn: dict[str, float]) -> str:
    """The key of `SAID` for a clip."""
    if action in CASES:
        return action + CASES[action][int(drawn["kind"])]
    if action in ("wave", "punch") and drawn["side"] == 0:
        return f"{action} both"
    if action in ("turn", "walk_turn") and drawn["angle"] > HALF_ROUND:
        return f"{action} round"
    if action in ("jump", "hop") and drawn["ahead"] > (FAR_JUMP if action == "jump" else 0):
        return f"{action} ahead"
    if action == "kick" and drawn["height"] > HIGH_KICK:
        return "kick high"
    if action == "walk_curve" and drawn["s_curve"]:
        return "walk_curve s"
    return action


def adverb(action: str, drawn: dict[str, float]) -> str:
    """An adverb for a speed or a rate that stands out, or nothing."""
    if action not in PACE:
        return ""
    slow, quick = PACE[action]
    pace = abs(drawn["speed"] if "speed" in drawn else drawn["rate"])
    return SLOWLY if pace < slow else QUICKLY if pace > quick else ""


def caption(action: str, drawn: dict[str, float], random: np.random.Generator) -> str:
    """One sentence for one clip."""
    said = SAID[case(action, drawn)]
    who = WHO[0] if random.random() < 0.6 else WHO[random.integers(len(WHO))]
    side = LEFT_RIGHT.get(drawn.get("side", 0.0), "")
    other = LEFT_RIGHT.get(-drawn.get("side", 0.0), "")
    often = drawn.get("times", 1.0)
    times = TIMES.get(int(often), "") if np.isfinite(often) else ""
    sentence = said[random.integers(len(said))].format(side=side, other=other, times=times)
    return f"{who} {sentence}{adverb(action, drawn)}"


def phrases() -> list[str]:
    """All that captions are put together from, so that their words are known before any clip.

    Clips of some length would not do: nobody hops three times in a second, and a rare word may
    be missing by chance.
    """
    said = [
        text.format(side=side, other=side, times=times)
        for texts in SAID.values()
        for text in texts
        for side in LEFT_RIGHT.values()
        for times in TIMES.values()
    ]
    return [*WHO, *said, SLOWLY, QUICKLY]
