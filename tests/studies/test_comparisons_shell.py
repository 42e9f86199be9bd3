"""What the commands of all comparisons have in common: options, protocols, and what is written."""

import json

import pytest
from untrained import small_prior

from projflow_lite.studies import (
    commands,
    control,
    equal_time,
    errata,
    lifting,
    real_wishes,
    sensitivity,
    shell,
)
from projflow_lite.studies.bench import check_extent
from projflow_lite.studies.cells import fingerprint
from projflow_lite.studies.control_ways import RIVALS
from projflow_lite.studies.sensitivity_sweeps import USUAL

WITH_METHODS = [control, lifting, equal_time, real_wishes]
COMPARISONS = [*WITH_METHODS, errata, sensitivity]


def asked(study, monkeypatch, *arguments):
    """The protocol that a study's own command would carry out."""
    seen = []
    monkeypatch.setattr("sys.argv", ["study", *arguments])
    monkeypatch.setattr(
        study, "carry_out", lambda name, options, protocol, *_: seen.append(protocol)
    )
    study.main()
    return seen[0]


@pytest.mark.parametrize("study", COMPARISONS, ids=lambda study: study.__name__.split(".")[-1])
def test_options_become_the_protocol(study, monkeypatch):
    usual = asked(study, monkeypatch)
    arguments = ("--clips", "40", "--seeds", "3", "--steps", "7", "--joints", "head")
    protocol = asked(study, monkeypatch, *arguments)
    assert protocol == usual._replace(clips=40, seeds=3, steps=7, joints=("head",))
    assert asked(study, monkeypatch, "--quick", "--clips", "40") == study.QUICK != usual


@pytest.mark.parametrize("study", WITH_METHODS, ids=lambda study: study.__name__.split(".")[-1])
def test_some_methods_may_be_chosen_and_unknown_ones_are_refused(study, monkeypatch):
    names = [rival.name for rival in asked(study, monkeypatch, "--methods", "dps", "ddnm").rivals]
    assert {"dps", "ddnm"} <= set(names)
    assert set(names) <= {"dps", "ddnm", "no wish", "projflow"}  # what others are held against
    with pytest.raises(ValueError, match="methods: 'dsp' is not one of no wish, projflow"):
        asked(study, monkeypatch, "--methods", "dsp")


def test_methods_keep_their_order():
    assert shell.chosen(RIVALS, None) == RIVALS
    assert shell.chosen(RIVALS, ["ddnm", "projflow"]) == (USUAL, RIVALS[2])


def test_records_are_kept_with_their_prior_and_how_long_it_took(tmp_path, capsys):
    class Study:
        QUICK = "quick"

        @staticmethod
        def table(rows):
            return f"table of {rows}"

    prior = small_prior()
    wanted = commands.Wanted(None, tmp_path, None, quick=True)
    found = commands.shown("a-study", Study, [1, 2], wanted, prior)
    assert capsys.readouterr().out == "table of [1, 2]\n"
    kept = json.loads((tmp_path / "results" / "a-study.json").read_text())
    assert kept == {"prior": fingerprint(prior), "quick": True, "rows": [1, 2]}
    assert found == {"results": str(tmp_path / "results" / "a-study.json"), "rows": [1, 2]}
    assert list(commands.shown("a-study", Study, [1, 2], wanted)) == ["rows"]


def test_too_little_is_refused_by_name():
    with pytest.raises(ValueError, match="errata: at least 32 clips and 2 seeds, not 31 and 2"):
        check_extent("errata", 31, 2)
    check_extent("errata", 32, 2)
