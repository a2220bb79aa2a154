"""The model as it is really drawn. Run with -m gl under xvfb-run."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest

from app.gui.pages.reconstruction.loading import key_of, load_model
from app.gui.pages.reconstruction.view import ModelView
from app.gui.views.scene.view import SceneView
from core.pipeline.session_view import SessionView

pytestmark = pytest.mark.gl


@pytest.fixture
def view(qtbot, mug_session):
    loaded = load_model(key_of(SessionView.of(mug_session)))
    view = ModelView()
    view.resize(660, 560)
    qtbot.addWidget(view)
    with qtbot.waitExposed(view):
        view.show()
    view.show_model(loaded.model, np.linspace(-0.002, 0.002, len(loaded.model.mesh.vertices_m)))
    view.set_box(loaded.own_box.min_m, loaded.own_box.max_m, is_own=True)
    return view


def pixels(view):
    image = view.scene.grab_image().convertToFormat(QImage.Format.Format_RGBX8888)
    data = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), -1, 4)
    return data[:, : image.width(), :3].astype(int)


def n_colored(view):
    """Pixels that are clearly no grey."""
    picture = pixels(view)
    return int((picture.max(axis=-1) - picture.min(axis=-1) > 60).sum())


@pytest.mark.parametrize("mode", ["height", "coverage", "difference"])
def test_each_colouring_is_seen(view, mode):
    assert n_colored(view) == 0
    view.modes.choose(mode)
    assert n_colored(view) > 10_000


def test_the_collision_model_lies_over_the_surface(view):
    before = pixels(view)
    view.modes.choose("collision")
    assert (np.abs(pixels(view) - before).max(axis=-1) > 20).sum() > 5_000


def test_the_ruler_measures_between_two_real_clicks(view):
    view._ruler_button.click()
    view.scene.look_from("front")
    gl = view.scene.findChild(SceneView)
    middle = QPoint(gl.width() // 2, gl.height() // 2)
    for step in (-60, 60):
        QTest.mouseClick(
            gl, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, middle + QPoint(0, step)
        )
    scale = 0.097 / (0.9 * gl.height())  # m per pixel, roughly: the mug's height nearly fills the view
    assert view.ruler.distance_m == pytest.approx(120 * scale, rel=0.35)
