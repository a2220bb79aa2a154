"""The ruler and the crop box of the model's view."""

import numpy as np
import pytest
from PySide6.QtWidgets import QDoubleSpinBox, QPushButton

from app.gui.pages.reconstruction.view import CropBar, Ruler
from app.gui.views.scene import Scene3D

PLACES = {"object": np.array([[0.0, 0.0, 0.0], [0.03, 0.0, 0.04], [0.0, 0.0, 0.1]])}


@pytest.fixture
def scene(qtbot):
    scene = Scene3D()
    qtbot.addWidget(scene)
    return scene


@pytest.fixture
def ruler(scene):
    ruler = Ruler(scene)
    ruler.set_places(PLACES)
    ruler.set_on(True)
    return ruler


def test_two_clicks_measure_and_a_third_starts_over(scene, ruler):
    assert "click two places" in ruler.sentence
    scene.picked.emit("object", 0)
    assert ruler.distance_m is None
    assert "second place" in ruler.sentence
    scene.picked.emit("object", 1)
    assert ruler.distance_m == pytest.approx(0.05)
    assert ruler.sentence == "Ruler: 50.0 mm (x 30.0, y 0.0, z 40.0 mm)."
    assert {"ruler_points", "ruler_line", "ruler_label"} <= set(scene.layers())
    scene.picked.emit("object", 2)
    assert len(ruler.points_m) == 1
    assert "ruler_line" not in scene.layers()


def test_it_measures_only_while_it_is_on_and_leaves_nothing_behind(scene, ruler):
    for index in (0, 1):
        scene.picked.emit("object", index)
    ruler.set_on(False)
    assert ruler.sentence == ""
    assert scene.layers() == ()
    scene.picked.emit("object", 0)
    assert ruler.points_m == []


def test_clicks_on_other_things_do_not_count(scene, ruler):
    scene.picked.emit("crop", 0)
    assert ruler.points_m == []


@pytest.fixture
def bar(qtbot):
    bar = CropBar()
    qtbot.addWidget(bar)
    return bar


def number(bar, name):
    return bar.findChild(QDoubleSpinBox, name)


def test_a_box_is_shown_in_millimetres_without_a_signal(bar, qtbot):
    with qtbot.assertNotEmitted(bar.edited):
        bar.set_box((-0.3, -0.55, 0.03), (0.18, -0.15, 0.35), True)
    assert number(bar, "crop_min_x").value() == -300
    assert number(bar, "crop_max_z").value() == 350
    assert not bar.findChild(QPushButton, "crop_reset").isEnabled()


def test_a_number_that_is_entered_is_emitted_in_metres(bar, qtbot):
    bar.set_box((-0.3, -0.55, 0.03), (0.18, -0.15, 0.35), False)
    with qtbot.waitSignal(bar.edited) as told:
        number(bar, "crop_max_z").setValue(280)
    low, high = told.args
    assert low == pytest.approx((-0.3, -0.55, 0.03))
    assert high == pytest.approx((0.18, -0.15, 0.28))
    with qtbot.waitSignal(bar.reset_wanted):
        bar.findChild(QPushButton, "crop_reset").click()
