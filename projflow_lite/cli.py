"""The shell's way in: train, sample, reproduce, derive and classroom; thin on purpose."""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import replace
from pathlib import Path

from projflow_lite.studies.shares import is_first


def build_parser() -> argparse.ArgumentParser:
    """Describe every command and option."""
    parser = argparse.ArgumentParser(prog="projflow-lite", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    for describe in (say_train, say_sample, say_reproduce, say_score, say_derive, say_classroom):
        describe(commands)
    return parser


def say_train(commands: argparse._SubParsersAction) -> None:
    """The options of ``train``."""
    train = commands.add_parser("train", help="teach the tiny flow; stop and resume at will")
    train.add_argument(
        "--recipe",
        default="classroom",
        help="classroom, shipped or smoke; for GMD emphasis_10, emphasis_1, emphasis_classroom or "
        "trajectory; priors that see keyframes: control_branch or masked",
    )
    train.add_argument("--out", type=Path, help="folder of the run (default: runs/RECIPE)")
    train.add_argument("--steps", type=int, help="optimiser steps, instead of the recipe's")
    train.add_argument("--seed", type=int, default=0)
    train.add_argument("--threads", type=int, default=1, help="processor threads (default 1)")
    train.add_argument("--json", type=Path, help="write the closing numbers to this file")
    train.set_defaults(run=run_train)


def say_sample(commands: argparse._SubParsersAction) -> None:
    """Those of ``sample``."""
    sample = commands.add_parser("sample", help="make one motion from a prompt")
    sample.add_argument("prompt", help='for example "a person walks forward"')
    sample.add_argument("--out", type=Path, default=Path("motion.npz"), help=".npz or .gif")
    sample.add_argument("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    sample.add_argument("--frames", type=int, default=60)
    sample.add_argument("--steps", type=int, help="of sampling (default 10)")
    sample.add_argument("--guidance", type=float, default=1.0)
    sample.add_argument("--seed", type=int, default=0)
    sample.add_argument("--json", type=Path, help="write length, time and residual to this file")
    sample.set_defaults(run=run_sample)


def say_reproduce(commands: argparse._SubParsersAction) -> None:
    """Those of ``reproduce``."""
    reproduce = commands.add_parser(
        "reproduce",
        help="measure or draw again what the docs show",
        formatter_class=argparse.RawTextHelpFormatter,  # any other breaks names at their hyphens
    )
    reproduce.add_argument(
        "name",
        help="ablations, contact-sheet, control, data-card, equal-time,\n"
        "errata, fewer-steps, gmd-table, lifting, posterior,\nreal-wishes or sensitivity",
    )
    reproduce.add_argument("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    reproduce.add_argument("--out", type=Path, default=Path("book"), help="folder (default: book)")
    reproduce.add_argument(
        "--real", type=Path, help="real clips (.npz), for data-card and real-wishes"
    )
    reproduce.add_argument("--quick", action="store_true", help="a few minutes, wide intervals")
    reproduce.add_argument("--json", type=Path, help="write the numbers to this file")
    reproduce.set_defaults(run=run_reproduce)


def say_score(commands: argparse._SubParsersAction) -> None:
    """Those of ``score``."""
    score = commands.add_parser("score", help="judge a prior against held-out motion")
    score.add_argument("--prior", type=Path, help="a checkpoint (default: the shipped one)")
    score.add_argument("--classroom", type=Path, help="a second checkpoint, to judge beside it")
    score.add_argument("--quick", action="store_true", help="two minutes, wide intervals")
    score.add_argument(
        "--folder",
        type=Path,
        default=Path("runs/score"),
        help="for results as they are made; an interrupted run goes on there (default: runs/score)",
    )
    score.add_argument("--blind", type=Path, metavar="FOLDER", help="write a blind page instead")
    score.add_argument("--real", type=Path, help="real clips (.npz) for the blind page")
    score.add_argument("--out", type=Path, help="write the prior's card to this folder")
    score.add_argument("--json", type=Path, help="write the numbers to this file")
    score.set_defaults(run=run_score)


def say_derive(commands: argparse._SubParsersAction) -> None:
    """Those of ``derive``."""
    derive = commands.add_parser("derive", help="derive every equation again, by other means")
    derive.add_argument("--only", type=int, nargs="+", metavar="N", help="these of ProjFlow only")
    derive.add_argument("--seed", type=int, default=0)
    derive.add_argument("--json", type=Path, help="write the table to this file")
    derive.set_defaults(run=run_derive)


def say_classroom(commands: argparse._SubParsersAction) -> None:
    """Those of ``classroom``."""
    classroom = commands.add_parser(
        "classroom", help="how many wrong answers the exercises catch; or lay out a course"
    )
    classroom.add_argument("--course", type=Path, help="write an nbgrader course to this folder")
    classroom.add_argument(
        "--chapters", type=Path, nargs="+", default=[], help="tutorial notebooks for that course"
    )
    classroom.add_argument("--json", type=Path, help="write the numbers to this file")
    classroom.set_defaults(run=run_classroom)


def run_train(options: argparse.Namespace) -> dict:
    """Train by a recipe; an interrupted run goes on from where it was."""
    import torch

    from projflow_lite.prior.small_training import RECIPES
    from projflow_lite.prior.training import train

    if options.recipe not in RECIPES:
        raise ValueError(f"'{options.recipe}' is not a recipe; try {', '.join(RECIPES)}")
    torch.set_num_threads(options.threads)
    recipe = replace(RECIPES[options.recipe], seed=options.seed)
    if options.steps is not None:
        recipe = replace(recipe, steps=options.steps)
    folder = options.out or Path("runs") / options.recipe
    start = time.monotonic()
    train(recipe, folder)
    seconds = time.monotonic() - start
    return {"checkpoint": str(folder / "prior.safetensors"), "seconds": round(seconds, 1)}


def run_sample(options: argparse.Namespace) -> dict:
    """Sample one motion and write it."""
    from projflow_lite.prior import load_prior
    from projflow_lite.samplers import sample

    if options.out.suffix not in (".npz", ".gif"):
        raise ValueError(f"--out ends in .npz or .gif, not '{options.out.suffix}'")
    prior = load_prior(options.prior)
    start = time.monotonic()
    motion = sample(
        prior,
        prompt=options.prompt,
        frames=options.frames,
        steps=options.steps,
        seed=options.seed,
        guidance=options.guidance,
    )
    seconds = time.monotonic() - start
    if options.out.suffix == ".gif":
        from projflow_lite.exchange.pictures import film

        film(motion, options.out)
    else:
        motion.save(options.out)
    return {"motion": str(options.out), "frames": motion.frames, "seconds": round(seconds, 3)}


def run_reproduce(options: argparse.Namespace) -> dict:
    """Run one study."""
    from projflow_lite.studies.commands import STUDIES, UNSHARED, Wanted

    if options.name not in STUDIES:
        raise ValueError(f"'{options.name}' is not a study; try {', '.join(STUDIES)}")
    if options.name in UNSHARED and not is_first():
        return {}
    wanted = Wanted(options.prior, options.out, options.real, options.quick)
    return STUDIES[options.name](wanted)


def run_score(options: argparse.Namespace) -> dict:
    """Print the table of scores, or write a page to guess which clips are real."""
    from projflow_lite.prior import load_prior
    from projflow_lite.studies import blind_page, score_prior, score_prior_words

    prior = load_prior(options.prior)
    if options.blind:
        page, key = blind_page.run(prior, options.blind, options.real)
        return {"page": str(page), "key": str(key)}
    rows = score_prior.run(prior, quick=options.quick, folder=options.folder)
    print(score_prior_words.table(rows))
    classroom = []
    if options.classroom:
        other = load_prior(options.classroom)
        classroom = score_prior.beside(prior, other, quick=options.quick, folder=options.folder)
        print("", score_prior_words.table(classroom), sep="\n")
    if options.out:
        score_prior_words.write_card(options.out, rows, classroom, prior.recipe)
    return {"rows": rows, "classroom": classroom}


def run_derive(options: argparse.Namespace) -> dict:
    """Derive every equation again, by other means, and print what came out."""
    from projflow_lite import derivations

    rows = derivations.run(options.only, options.seed)
    printed = derivations.run_as_printed(options.only, options.seed)
    if options.only is None:
        rows += derivations.run(seed=options.seed, paper="GMD")
        printed += derivations.run_as_printed(seed=options.seed, paper="GMD")
    print(derivations.table(rows, printed))
    holds = all(row.holds for row in rows) and all(row.deviates for row in printed)
    found = {"rows": derivations.plain(rows), "as_printed": derivations.plain(printed)}
    return found | {"exit_code": 0 if holds else 1}


def run_classroom(options: argparse.Namespace) -> dict:
    """Lay out a course, or count the wrong answers that the exercises catch."""
    from projflow_lite.classroom import course, mutation

    if options.chapters and not options.course:
        raise ValueError("--chapters are part of a course; say where to, with --course FOLDER")
    if options.course:
        return {"course": str(course.create(options.course, chapters=options.chapters))}
    found = mutation.run()
    print(mutation.report([mutation.Row(**row) for row in found["rows"]]))
    return found


def main(arguments: list[str] | None = None) -> int:
    """Run one command; return the exit status."""
    options = build_parser().parse_args(arguments)
    try:
        numbers = options.run(options)
    except (ValueError, FileNotFoundError, FileExistsError, ModuleNotFoundError) as error:
        print(f"projflow-lite {options.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\nStopped. The same command goes on from here.", file=sys.stderr)
        return 130
    if not is_first():  # one of several processes: the first speaks
        return numbers.get("exit_code", 0)
    for name, value in numbers.items():
        if name not in ("rows", "classroom", "as_printed", "exit_code"):
            print(f"{name}: {value}")
    if options.json:
        options.json.write_text(json.dumps(numbers, indent=2) + "\n")
    return numbers.get("exit_code", 0)


if __name__ == "__main__":
    sys.exit(main())
