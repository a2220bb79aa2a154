import pytest
from PySide6.QtWidgets import QDoubleSpinBox, QPushButton

from app.gui.pages.reconstruction.crop_bar import CropBar


@pytest.fixture
def bar(qtbot):
    bar = CropBar()
    qtbot.addWidget(bar)
    return bar


def number(bar, name):
    return bar.findChild(QDoubleSpinBox, name)


def test_a_box_is_shown_in_millimetres_without_being_told(bar, qtbot):
    with qtbot.assertNotEmitted(bar.edited):
        bar.set_box((-0.3, -0.55, 0.03), (0.18, -0.15, 0.35), True)
    assert number(bar, "crop_min_x").value() == -300
    assert number(bar, "crop_max_z").value() == 350
    assert not bar.findChild(QPushButton, "crop_reset").isEnabled()


def test_a_number_that_is_entered_is_told_in_metres(bar, qtbot):
    bar.set_box((-0.3, -0.55, 0.03), (0.18, -0.15, 0.35), False)
    with qtbot.waitSignal(bar.edited) as told:
        number(bar, "crop_max_z").setValue(280)
    low, high = told.args
    assert low == pytest.approx((-0.3, -0.55, 0.03))
    assert high == pytest.approx((0.18, -0.15, 0.28))
    with qtbot.waitSignal(bar.reset_wanted):
        bar.findChild(QPushButton, "crop_reset").click()
