"""The bank: every wrong answer is caught and named, every right one passes, no two are the same."""

import importlib
import inspect
import pkgutil

import numpy as np
import pytest

from projflow_lite.classroom import bank, check, mutation_score, report, run
from projflow_lite.classroom.attempt import agree
from projflow_lite.classroom.bank import right_answers, wrong_answers
from projflow_lite.classroom.checking import known_mistakes
from projflow_lite.classroom.mutation import Row
from projflow_lite.classroom.shelf import EXERCISES

WRONG = [(id, answer) for id in EXERCISES for answer in wrong_answers(id)]
RIGHT = [(id, answer) for id in EXERCISES for answer in right_answers(id)]


def name(value):
    return getattr(value, "__name__", str(value))


@pytest.mark.parametrize(("id", "answer"), WRONG, ids=name)
@pytest.mark.parametrize("seed", [0, 3])
def test_a_wrong_answer_is_caught_and_its_mistake_named(id, answer, seed):
    verdict = check(id, answer, seed)
    assert not verdict
    assert verdict.mistake == inspect.getdoc(answer)
    assert verdict.mistake in str(verdict)


@pytest.mark.parametrize(("id", "answer"), RIGHT, ids=name)
@pytest.mark.parametrize("seed", [0, 3])
def test_a_right_answer_in_another_style_passes(id, answer, seed):
    assert check(id, answer, seed), check(id, answer, seed)


@pytest.mark.parametrize("id", EXERCISES)
def test_no_two_wrong_answers_are_the_same(id):
    outcomes = known_mistakes(id, 0)
    for k, (sentence, one) in enumerate(outcomes):
        for other_sentence, other in outcomes[:k]:
            same = all(agree(a, b) for a, b in zip(one, other, strict=True))
            assert not same, f"{sentence} / {other_sentence}"


@pytest.mark.parametrize("id", EXERCISES)
def test_no_wrong_answer_fails_everywhere(id):
    """One that stops in every case would lend its name to any function that crashes."""
    for sentence, outcomes in known_mistakes(id, 0):
        assert not all(outcome.problem for outcome in outcomes), sentence


@pytest.mark.parametrize("id", EXERCISES)
def test_the_bank_is_large_enough_and_readable(id):
    assert len(wrong_answers(id)) >= 8
    assert len(right_answers(id)) >= 2
    for answer in (*wrong_answers(id), *right_answers(id)):
        assert inspect.getdoc(answer).endswith(".")
        assert "\n" not in inspect.getdoc(answer)
        assert list(inspect.signature(answer).parameters) == list(EXERCISES[id].parameters)


def test_every_function_of_the_bank_is_on_a_shelf():
    shelved = {answer for _, answer in WRONG + RIGHT}
    modules = [m.name for m in pkgutil.iter_modules(bank.__path__) if m.name != "shelves"]
    assert [topic.__name__.rpartition(".")[2] for topic in bank.TOPICS] == sorted(modules)
    for module in modules:
        topic = importlib.import_module(f"{bank.__name__}.{module}")
        for title, function in inspect.getmembers(topic, inspect.isfunction):
            if function.__module__ == topic.__name__ and not title.startswith("_"):
                assert function in shelved, f"{module}.{title} is overwritten or forgotten"


def test_the_score_is_counted():
    rows = mutation_score(seed=11)
    outcome = run(seed=11)
    assert [row.id for row in rows] == list(EXERCISES)
    assert outcome["wrong"] == outcome["caught"] == len(WRONG)
    assert outcome["right"] == outcome["accepted"] == len(RIGHT)
    assert outcome["exit_code"] == 0
    assert outcome["rows"] == [row._asdict() for row in rows]
    assert report(rows).splitlines()[-1] == (
        f"mutation score 100 % ({len(WRONG)} of {len(WRONG)} caught), "
        f"{len(RIGHT)} of {len(RIGHT)} right answers accepted"
    )


def test_a_check_that_accepts_anything_would_show(monkeypatch):
    """The score itself can fail: with no cases but one harmless one, mistakes go through."""
    harmless = {id: lambda *_: True for id in EXERCISES}
    monkeypatch.setattr(
        "projflow_lite.classroom.mutation.check", lambda id, answer, seed: harmless[id](answer)
    )
    outcome = run()
    assert outcome["caught"] == 0
    assert outcome["exit_code"] == 1
    assert "mutation score 0 % (0 of" in report([Row(**row) for row in outcome["rows"]])


def test_the_percentage_is_never_rounded_up():
    rows = [Row("projflow:2", "a title", 1000, 999, 2, 1)]
    assert report(rows).endswith(
        "mutation score 99 % (999 of 1000 caught), 1 of 2 right answers accepted"
    )
    assert "undefined" in report([])


@pytest.mark.parametrize(
    ("id", "case", "needs"),
    [
        ("projflow:7", "no observation (m = 0)", lambda a: a[1].shape == (0, 4)),
        ("projflow:7", "exact rows (Sigma = 0)", lambda a: not a[4].any()),
        ("projflow:7", "a row that is there twice, with noise", lambda a: (a[1][0] == a[1][2]).all()),
        ("projflow:7", "two rows, five coordinates, correlated noise", lambda a: a[4][0, 1] != 0),
        ("projflow:15", "an even number of frames", lambda a: len(a[0]) % 2 == 0),
        ("projflow:17", "a steady motion, which does not bend", lambda a: not np.diff(a[0], 2, 0).any()),
        ("projflow:52", "some frames without an active joint", lambda a: (~a[2].any(axis=1)).any()),
    ],
)  # fmt: skip
def test_the_cases_are_what_their_names_say(id, case, needs):
    cases = {c.name: c.arguments for c in EXERCISES[id].cases(np.random.default_rng(0))}
    assert needs(cases[case])
