"""The explorer of guides: what the sliders say reaches the formulas, and back comes a picture."""

import numpy as np
import pytest

from projflow_lite.equations import TABLE_5
from projflow_lite.skeleton import JOINTS
from projflow_lite.studies.guide_explorer import RANGES, GuideExplorer, worst_acceleration

WRIST, ELBOW = JOINTS.index("left_wrist"), JOINTS.index("left_elbow")


class Formulas:
    """Stand-ins that remember what they were asked."""

    def trust(self, c, t, observed):
        self.c, self.t, self.observed = c, t, observed
        if c["pi_min"] > c["pi_max"]:
            raise ValueError("pi_min is above pi_max")
        active = np.zeros_like(observed)
        active[3, WRIST] = True
        return np.full(11, 2.0), np.full(observed.shape, 0.5), active

    def project(self, c, observed, y, pi, active):
        self.y = y
        x = np.zeros(observed.shape)
        x[5, WRIST] = 0.0 if active.any() else 0.1
        return x

    def through_sampling(self, c, t, raw, joints):
        self.raw, self.joints = raw, list(joints)
        return np.array([0.0, 0.5]), np.array([1.0, 0.25])


@pytest.fixture
def formulas():
    return Formulas()


@pytest.fixture
def explorer(formulas):
    x1_hat = np.full((11, 22, 3), 0.9)
    keyframes = {2: 1.0, 8: 0.7}
    functions = formulas.trust, formulas.project, formulas.through_sampling
    return GuideExplorer(x1_hat, keyframes, *functions)


def test_it_begins_with_the_constants_of_the_paper(explorer, formulas):
    for name in RANGES:
        assert formulas.c[name] == TABLE_5[name], name
    assert formulas.t == 0
    assert list(np.argwhere(formulas.observed).ravel()) == [2, WRIST, 8, WRIST]
    assert formulas.raw == 2.0
    assert formulas.joints == [WRIST]


def test_what_is_asked_lies_on_a_line_between_keyframes(explorer, formulas):
    explorer.path.drag = {"moves": {"key 2": [2, 1.3, 1]}}
    assert formulas.y[2:9, WRIST] == pytest.approx(np.linspace(1.3, 0.7, 7))
    explorer.both.value = True
    assert formulas.joints == [ELBOW, WRIST]
    assert formulas.y[5, ELBOW] == pytest.approx(1.0)  # 10 cm above the prediction


def test_time_moves_in_steps(explorer, formulas):
    explorer.sliders["steps"].value = 10
    explorer.sliders["t"].value = 0.52
    assert formulas.t == 0.5
    explorer.sliders["t"].value = 1.0
    assert formulas.t == 0.9


def test_an_error_is_said_and_table_5_brings_everything_back(explorer, formulas):
    explorer.sliders["pi_max"].value = 0.05
    explorer.sliders["pi_min"].value = 0.4
    assert explorer.says.value == "<b>pi_min is above pi_max</b>"
    explorer.table_5.click()
    assert formulas.c["pi_max"] == TABLE_5["pi_max"]
    assert "1 guided frames" in explorer.says.value
    assert "bare 80, guided 0 m/s²" in explorer.says.value  # 2 x 10 cm x 20²


def test_the_picture_has_the_trust_of_guides_that_are_active(explorer):
    layers = {each["name"]: each for each in explorer.trusted.layers}
    points = np.frombuffer(explorer.trusted.data, "<f4").reshape(-1, 2)
    clipped = points[layers["clipped"]["start"] :][: layers["clipped"]["count"]]
    np.testing.assert_allclose(clipped, [[3, 0], [3, 0.5], [np.nan, np.nan]])
    beside = np.frombuffer(explorer.times.data, "<f4").reshape(-1, 2)[:2]
    np.testing.assert_allclose(beside, [[0, 1], [0.5, 0.25]])


def test_acceleration_by_hand():
    assert worst_acceleration(np.array([0.0, 0.0, 0.35, 0.0])) == pytest.approx(280)
