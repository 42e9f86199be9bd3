"""The front door: what `import projflow_lite as pf` offers, and what it does not load."""

import subprocess
import sys

import pytest

import projflow_lite as pf


def test_every_name_that_is_offered_is_there():
    for name in dir(pf):
        assert getattr(pf, name) is not None


def test_other_names_are_refused():
    with pytest.raises(AttributeError, match="has no attribute 'sampel'"):
        _ = pf.sampel


def test_the_equations_load_without_torch_or_jupyter():
    code = (
        "import sys, projflow_lite as pf; pf.equations.project\n"
        "print([m for m in ('torch', 'anywidget', 'plotly', 'data_synth') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_lower_floors_do_not_import_higher_ones():
    """The order of the house, from the ground up; each may import only what stands before it."""
    floors = [
        "projflow_lite.equations", "projflow_lite.skeleton", "data_synth", "projflow_lite.motion",
        "projflow_lite.constraints", "projflow_lite.projection", "projflow_lite.prior",
        "projflow_lite.samplers",
    ]  # fmt: skip
    for number, floor in enumerate(floors):
        higher = floors[number + 1 :] + ["projflow_lite.widgets", "projflow_lite.studies"]
        code = f"import sys, {floor}; print([m for m in {higher} if m in sys.modules])"
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        )
        assert done.stdout.strip() == "[]", floor
