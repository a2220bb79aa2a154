from __future__ import annotations

from itertools import combinations

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter

from app.gui.theme import DARK, LIGHT
from app.gui.views.state_mark import STATES, StateMark, paint_mark


def silhouette(state, theme=LIGHT):
    image = QImage(32, 32, QImage.Format.Format_ARGB32)
    image.fill(Qt.GlobalColor.transparent)
    painter = QPainter(image)
    paint_mark(painter, QRectF(0, 0, 32, 32), state, theme)
    painter.end()
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(32, 32, 4)
    return pixels[:, :, 3] > 128


def test_every_state_has_a_shape_of_its_own(qtbot):
    """Without colour, any two differ in at least a tenth of what either covers."""
    shapes = {state: silhouette(state) for state in STATES}
    for one, other in combinations(STATES, 2):
        differing = (shapes[one] ^ shapes[other]).sum()
        assert differing > 0.1 * max(shapes[one].sum(), shapes[other].sum()), (one, other)


def test_the_shape_is_the_same_in_both_themes(qtbot):
    for state in STATES:
        assert (silhouette(state, LIGHT) == silhouette(state, DARK)).all()


def test_the_word_comes_with_the_mark(qtbot):
    mark = StateMark()
    qtbot.addWidget(mark)
    mark.set_state("stale")
    assert mark.state == "stale"
    assert mark.toolTip() == mark.accessibleName() == "stale"
