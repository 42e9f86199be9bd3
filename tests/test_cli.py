"""The shell commands, run as a person would, in this process."""

import json

import numpy as np
import pytest

import projflow_lite as pf
from projflow_lite.cli import main
from projflow_lite.exchange.pictures import camera, contact_sheet, film
from projflow_lite.studies.commands import STUDIES


def test_train_then_sample_with_what_was_trained(tmp_path, capsys):
    run = tmp_path / "run"
    assert main(["train", "--recipe", "smoke", "--steps", "2", "--out", str(run)]) == 0
    assert f"checkpoint: {run / 'prior.safetensors'}" in capsys.readouterr().out
    out, numbers = tmp_path / "m.npz", tmp_path / "numbers.json"
    command = ["sample", "a person walks", "--prior", str(run / "prior.safetensors")]
    options = ["--steps", "2", "--frames", "48", "--out", str(out), "--json", str(numbers)]
    assert main(command + options) == 0
    assert pf.Motion.load(out).positions.shape == (48, 22, 3)
    assert json.loads(numbers.read_text())["frames"] == 48


def test_the_same_seed_trains_the_same_prior(tmp_path):
    for name in ("a", "b"):
        main(
            [
                "train",
                "--recipe",
                "smoke",
                "--steps",
                "2",
                "--seed",
                "3",
                "--out",
                str(tmp_path / name),
            ]
        )
    a, b = ((tmp_path / name / "prior.safetensors").read_bytes() for name in ("a", "b"))
    assert a == b


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (
            ["train", "--recipe", "clasroom"],
            "projflow-lite train: 'clasroom' is not a recipe",
        ),
        (
            ["sample", "x", "--out", "m.mp4"],
            "projflow-lite sample: --out ends in .npz or .gif",
        ),
        (
            ["sample", "x", "--prior", "nowhere"],
            "projflow-lite sample: there is no checkpoint at nowhere",
        ),
    ],
)
def test_errors_are_one_line_and_the_status_is_not_zero(command, message, capsys):
    assert main(command) == 2
    said = capsys.readouterr().err
    assert said.startswith(message)
    assert said.count("\n") == 1


def test_derive_prints_what_was_derived_and_fails_when_an_equation_is_wrong(
    tmp_path, capsys, monkeypatch
):
    numbers = tmp_path / "derived.json"
    assert main(["derive", "--only", "2", "36", "--json", str(numbers)]) == 0
    assert "Straight path from noise to data" in capsys.readouterr().out
    rows = json.loads(numbers.read_text())["rows"]
    assert {row["equation"] for row in rows} == {2, 36}
    right = pf.equations.interpolate
    monkeypatch.setattr(pf.equations, "interpolate", lambda x0, x1, t: right(x1, x0, t))
    assert main(["derive", "--only", "2"]) == 1


def test_classroom_counts_the_wrong_answers_or_lays_out_a_course(tmp_path, capsys):
    assert main(["classroom"]) == 0
    assert "mutation score 100 %" in capsys.readouterr().out
    folder = tmp_path / "course"
    assert main(["classroom", "--course", str(folder)]) == 0
    assert len(list(folder.rglob("*.ipynb"))) == 3
    assert main(["classroom", "--course", str(folder)]) == 2
    assert "is not an empty folder" in capsys.readouterr().err


COMMANDS = [[], ["train"], ["sample"], ["reproduce"], ["derive"], ["classroom"]]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(command, capsys):
    with pytest.raises(SystemExit) as stopped:
        main([*command, "--help"])
    assert stopped.value.code == 0
    assert "usage: projflow-lite" in capsys.readouterr().out


def test_every_study_is_named_in_the_help_and_no_other_is_run(capsys):
    with pytest.raises(SystemExit):
        main(["reproduce", "--help"])
    text = capsys.readouterr().out
    assert all(name in text for name in STUDIES)
    assert main(["reproduce", "posteriors"]) == 2
    error = capsys.readouterr().err
    assert "'posteriors' is not a study" in error
    assert "ablations" in error


def test_the_camera_sees_the_left_hand_on_the_right_and_up_is_up():
    left, up = camera(np.array([[1.0, 0, 0], [0, 1.0, 0]]), yaw=0, pitch=0)
    np.testing.assert_allclose(left, [1, 0], atol=1e-12)
    np.testing.assert_allclose(up, [0, 1], atol=1e-12)
    from_above = camera(np.array([0.0, 1.0, 0.0]), yaw=0, pitch=90)
    np.testing.assert_allclose(from_above, [0, 0], atol=1e-12)


def test_pictures_are_written(tmp_path):
    x = np.random.default_rng(0).normal(size=(6, 22, 3))
    motion = pf.Motion(x, "a person waves", pf.pin("head", 1, [0, 1, 0]))
    contact_sheet([motion] * 3, tmp_path / "sheet.png", poses=3, columns=2)
    film(motion, tmp_path / "film.gif", trail="head")
    assert (tmp_path / "sheet.png").stat().st_size > 5000
    assert (tmp_path / "film.gif").read_bytes()[:6] == b"GIF89a"
