from PySide6.QtWidgets import QWidget

from app.gui.views.frustum_legend import FrustumLegend


def test_only_the_states_that_occur_are_explained(qtbot):
    parent = QWidget()
    qtbot.addWidget(parent)
    legend = FrustumLegend(parent)
    parent.show()
    assert not legend.isVisible()
    legend.show_states(["taken", "poor", "taken"])
    assert legend.isVisible()
    assert legend.accessibleName() == "view taken, poor view"
    two_px = legend.height()
    legend.show_states(["taken"])
    assert legend.height() < two_px
    assert not legend.grab().isNull()
    legend.show_states([])
    assert not legend.isVisible()
