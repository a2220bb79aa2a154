"""How many candies to pour: asked for where the pours are, whose imagination alone depends on it."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QSizePolicy, QSpinBox, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.labels import heading
from core.imagination.risk.result import FewerCandies
from core.parameters import Parameters, apply_settings, describe

_BY_NUMBER = ("up_to", "number")


class HowMuchBox(QWidget):
    """What is asked for, and a smaller amount where only that is sure enough.

    Attributes:
        asked: the parameters with another amount.
        fewer_asked: the same, with the smaller amount; the pours are wanted at once.
    """

    asked = Signal(object)
    fewer_asked = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("how_much")
        self._parameters = Parameters()
        self._fewer: FewerCandies | None = None
        self._kind = QComboBox()
        self._kind.setObjectName("amount_kind")
        self._kind.setAccessibleName(self.tr("How much to pour"))
        for name, text, tip in (
            ("up_to", self.tr("Up to"), self.tr("So many candies, but no more than fit safely")),
            ("number", self.tr("Exactly"), self.tr("So many candies, whatever fits")),
            ("safe", self.tr("As much as is safe"), self.tr("As many candies as fit safely")),
            ("half", self.tr("Half full"), self.tr("Half as many candies as fit")),
        ):
            self._kind.addItem(text, name)
            self._kind.setItemData(self._kind.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
        self._kind.activated.connect(lambda _index: self._ask())
        self._number = QSpinBox()
        self._number.setObjectName("amount_number")
        self._number.setAccessibleName(self.tr("Number of candies"))
        facts = next(one for one in describe() if one.name == "pouring.n_pour")
        self._number.setRange(int(facts.low or 1), int(facts.high or 1))
        self._number.setSuffix(self.tr(" candies"))
        self._number.setKeyboardTracking(False)  # a number half typed is not asked for
        self._number.setMinimumHeight(self._kind.sizeHint().height())
        self._number.valueChanged.connect(lambda _value: self._ask())
        self._less = QPushButton()
        self._less.setObjectName("pour_fewer")
        self._less.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Fixed)
        self._less.clicked.connect(self._ask_for_fewer)
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        row.addWidget(self._kind)
        row.addWidget(self._number)
        row.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(heading(self.tr("How much?")))
        column.addLayout(row)
        column.addWidget(self._less)

    def show_amount(self, parameters: Parameters, fewer: FewerCandies | None, is_idle: bool) -> None:
        """Show what the parameters ask for; `fewer` is a smaller amount where only that is sure enough."""
        self._parameters, self._fewer = parameters, fewer
        pouring = parameters.pouring
        for widget in (self._kind, self._number):
            widget.blockSignals(True)
        self._kind.setCurrentIndex(self._kind.findData(pouring.amount))
        self._number.setValue(pouring.n_pour)
        for widget in (self._kind, self._number):
            widget.blockSignals(False)
        self._number.setVisible(pouring.amount in _BY_NUMBER)
        self._less.setVisible(fewer is not None)
        self._less.setEnabled(is_idle)
        if fewer is not None:
            self._less.setText(self.tr("Pour {n} instead").format(n=fewer.n_candies))
            self._less.setToolTip(
                self.tr("With {n} candies a clean pour is at least {percent:.0f} % likely").format(
                    n=fewer.n_candies, percent=100 * fewer.clean_at_least
                )
            )

    def _ask(self) -> None:
        kind, number = self._kind.currentData(), self._number.value()
        self._number.setVisible(kind in _BY_NUMBER)
        self.asked.emit(_with_amount(self._parameters, kind, number))

    def _ask_for_fewer(self) -> None:
        if self._fewer is not None:
            self.fewer_asked.emit(_with_amount(self._parameters, "up_to", self._fewer.n_candies))


def _with_amount(parameters: Parameters, kind: str, n_pour: int) -> Parameters:
    return apply_settings(parameters, {"pouring.amount": kind, "pouring.n_pour": n_pour})
