"""The data card as a page of Markdown: every number in it comes from the measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from data_synth.card import UNITS, table


def card(
    numbers: Mapping[str, Any], pictures: Mapping[str, Path], families: Mapping[str, Sequence[str]]
) -> str:
    """Write the page.

    Args:
        numbers: what `data_card.measure` returned.
        pictures: paths of the pictures, in a folder ``pictures`` beside the page.
        families: actions by family.
    """
    with_real = any(name.startswith("recorded") for name in numbers["sets"])
    parts = [
        introduction(numbers, with_real),
        beside(numbers, pictures, with_real),
        bodies(numbers),
        flights(numbers),
        apart(numbers) if with_real else "",
        families_shown(pictures, families),
        limits(),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def paragraph(text: str) -> str:
    """The same on one line, as Markdown that people edit has it."""
    return " ".join(text.split())


def introduction(numbers: Mapping[str, Any], with_real: bool) -> str:
    """What the data is."""
    said = numbers["captions"]
    what = f"""
        `data_synth` makes clips of 20 to 196 frames, 20 a second, with 22 joints, from rotations
        and inverse kinematics; nothing in it was recorded. There are {said["actions"]} actions.
        Style is drawn anew for every clip: speed, cadence, bob, sway, swing of the arms, bones.
        A seed always gives the same clips, and `held_out` gives clips that no training seed can
        reach."""
    rate = f"""
        One core makes {numbers["clips a second"]:.0f} clips of 60 frames in a second (of its own
        time, on the machine that wrote this page). Captions come from {said["wordings"]} wordings
        for {said["cases"]} cases, at least {said["fewest wordings of a case"]} for each, in
        {said["words"]} words; speed, direction, count, and the hand or leg that acts are said as
        they were drawn."""
    made = "`projflow-lite reproduce data-card` writes this page, its pictures and its numbers."
    if not with_real:
        made += " It was given no file of recorded motion, so the columns are synthetic only."
    quick = ["*A quick look: few clips, wide scatter.*"] if numbers["quick"] else []
    parts = ["# Data card: synthetic motion", *quick, what, rate, made]
    return "\n\n".join(paragraph(part) for part in parts)


def beside(numbers: Mapping[str, Any], pictures: Mapping[str, Path], with_real: bool) -> str:
    """The table and the two figures."""
    sizes = "; ".join(f"{name}: {found['clips']}" for name, found in numbers["sets"].items())
    about = f"""
        Median over clips, and from the 10th to the 90th percentile; a dash where no clip has three
        steps. Numbers of clips: {sizes}."""
    parts = ["## " + ("Beside recorded motion" if with_real else "In numbers"), about]
    if with_real:
        parts.append(f"""
            Recorded: {numbers["recorded from"]}. The two columns called *all* mix different
            actions: {numbers["recorded walks"]} of the {numbers["sets"]["recorded, all"]["clips"]}
            recorded clips are walks.""")
        parts.append(outside(numbers["sets"]))
    gait = "Histograms of speed, cadence, stride, bob, wrist swing and ankle lift of walks"
    return "\n\n".join(
        [
            *(paragraph(part) for part in parts if part),
            table(numbers["sets"]),
            paragraph(skating(numbers["skating"])),
            f"![{gait}]({place(pictures['gait'])})",
            f"![Lengths of bones; spectrum]({place(pictures['bones_and_spectrum'])})",
        ]
    )


def skating(scores: Mapping[str, float]) -> str:
    """How much feet skate."""
    cells = ", ".join(f"{name} {score:.3f}" for name, score in scores.items())
    return f"""
        Foot skating by GMD's definition, share of the frames: {cells}. Synthetic feet stand still
        as they were told to; recorded ones roll, and markers slip."""


def outside(sets: Mapping[str, Any]) -> str:
    """Which synthetic medians lie outside the middle of the recorded clips."""
    said = []
    for name in ("walk", "run"):
        made, real = (sets.get(f"{kind}, {name}") for kind in ("synthetic", "recorded"))
        if made is None or real is None:
            continue
        off = [
            measure.replace("_", " ")
            for measure in UNITS
            if not real[measure]["p10"] <= made[measure]["median"] <= real[measure]["p90"]
        ]
        said.append(f"{name}: {', '.join(off) or 'none'}")
    return (
        "Measures whose synthetic median lies outside the recorded 10th to 90th percentile: "
        + "; ".join(said) + "."
    )  # fmt: skip


def place(picture: Path) -> str:
    """Where the page finds a picture."""
    return f"pictures/{picture.name}"


def bodies(numbers: Mapping[str, Any]) -> str:
    """How far joints bend."""
    rows = numbers["angles"]
    kinds = [kind for kind in ("synthetic", "recorded") if kind in next(iter(rows.values()))]
    lines = [f"| degrees | asked for | {' | '.join(kinds)} |", "|---" * (2 + len(kinds)) + "|"]
    for name, row in rows.items():
        cells = (f"{row[kind][0]:.0f} to {row[kind][1]:.0f}" for kind in ("asked", *kinds))
        lines.append(f"| {name} | {' | '.join(cells)} |")
    broken = [name for name, row in rows.items() if not within(row["synthetic"], row["asked"])]
    found = f"Outside: {', '.join(broken)}." if broken else "No synthetic joint is outside."
    return "\n".join(
        [
            "## How far joints bend",
            "",
            "Least and most over all frames of *all*; the limits are textbooks' ranges of motion, "
            f"with room for the body's own weight. {found}",
            "",
            *lines,
        ]
    )


def within(span: Sequence[float], limits: Sequence[float]) -> bool:
    """Whether one interval lies in another."""
    return limits[0] <= span[0] and span[1] <= limits[1]


def flights(numbers: Mapping[str, Any]) -> str:
    """What falls in flight."""
    about = """
        Median upward acceleration in the middle of three frames in which both feet are in the air;
        gravity is −9.81 m/s², and a dash says that no flight lasted so long. A jump's *pelvis*
        falls freely by construction; arms and legs that move meanwhile shift the centre of mass. A
        run's pelvis goes up and down like a cosine, so its flights are short and fall only roughly
        as they should."""
    lines = ["| m/s² | pelvis | centre of mass | frames |", "|---|---|---|---|"]
    for name, row in numbers["flight"].items():
        cells = (f"{row[what]:.1f}" if row["frames"] else "–" for what in FALLING)
        lines.append(f"| {name} | {' | '.join(cells)} | {row['frames']} |")
    return "\n".join(["## Gravity in flight", "", paragraph(about), "", *lines])


FALLING = ("pelvis", "centre of mass")


def apart(numbers: Mapping[str, Any]) -> str:
    """The two-sample tests."""
    tests, control = (numbers["two-sample"][part] for part in ("recorded", "control"))
    about = """
        A logistic regression sees sixty features of each clip (gait, joint angles, and the size
        and the peaks of speed, acceleration and jerk) and must say whether it was synthetic. Below
        is the share that it tells rightly, of clips left out of its training, both sets counting
        alike; 0.5 is chance. Windows of one recording are alike and fall on both sides, so these
        numbers are rather too high than too low."""
    sizes = "; ".join(
        f"{name}: {row['synthetic clips']} against {row['recorded clips']}"
        for name, row in tests.items()
    )
    last = f"""
        Clips: {sizes}. The same test on {control["pairs"]} pairs of synthetic sets tells
        {control["accuracy"]:.2f} rightly; where there is nothing to find, clips left out are a
        little less like their own set than chance would have it."""
    lines = ["| shown | " + " | ".join(tests) + " |", "|---" * (1 + len(tests)) + "|"]
    lines.append("| everything | " + " | ".join(share(row) for row in tests.values()) + " |")
    for kind in next(iter(tests.values()))["kinds"]:
        cells = (share(row["kinds"][kind]) for row in tests.values())
        lines.append(f"| {kind} only | {' | '.join(cells)} |")
    parts = ["## Can they be told apart?", paragraph(about), "\n".join(lines), paragraph(last)]
    parts += [verdict(row, name) for name, row in tests.items()]
    return "\n\n".join(parts)


def verdict(row: Mapping[str, Any], name: str) -> str:
    """One comparison in a sentence, and the features that differ most."""
    low, _ = row["interval"]
    if low <= 0.5:
        return f"**{name.capitalize()}:** not told apart."
    order = sorted(row["kinds"], key=lambda kind: row["kinds"][kind]["accuracy"])
    least, most = order[0], order[-1]
    sentence = f"""
        **{name.capitalize()}: they are told apart**, best by {most}, least by {least}. What differs
        most, recorded less synthetic, in standard deviations:"""
    lines = ["| feature | |", "|---|---|"]
    lines += [f"| {feature} | {value:+.1f} |" for feature, value in row["features"]]
    return paragraph(sentence) + "\n\n" + "\n".join(lines)


def share(row: Mapping[str, Any]) -> str:
    """An accuracy with its interval."""
    low, high = row["interval"]
    return f"{row['accuracy']:.2f} [{low:.2f}..{high:.2f}]"


def families_shown(pictures: Mapping[str, Path], families: Mapping[str, Sequence[str]]) -> str:
    """A contact sheet for every family."""
    lines = [
        "## What it looks like",
        "",
        "Eight frames of the first held-out clip of each action, with its caption; none was "
        "picked. Orange is the body's left, blue its right; below each pose is its frame.",
    ]
    for family, actions in families.items():
        names = ", ".join(action.replace("_", " ") for action in actions)
        lines += ["", f"### {family.capitalize()}", "", f"{names}.", ""]
        lines.append(f"![{family.capitalize()}: {names}]({place(pictures[family])})")
    return "\n".join(lines)


def limits() -> str:
    """What the data is not."""
    points = (
        "One body plan: adults, symmetric, healthy. No age, weight or gender moves differently, "
        "whatever the caption calls the person.",
        "No objects, walls or other people: boxes, balls and chairs exist in captions only.",
        "Flat ground, no contact forces, no muscles. Balance is drawn, not computed.",
        "Actions are separate. Three walk and do something with the hands; nothing else is "
        "combined.",
    )
    return "## What it is not\n\n" + "\n".join(f"- {point}" for point in points)
