"""The editors that open in a row: a number with its unit, a choice, a point."""

from __future__ import annotations

from math import floor, log10
from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QValidator
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QLineEdit, QWidget

from app.gui.views.parameter_editor.model import RowFacts
from app.gui.views.parameter_editor.naming import Display, human_words

_MOST = 1e12
"""What can be typed; what is allowed is the schema's to say, in a sentence."""


class NumberInput(QDoubleSpinBox):
    """A number in the shown unit with all its digits; steps stay in the range, typing need not."""

    def __init__(self, facts: RowFacts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("parameter_number")
        self.setAccessibleName(facts.title)
        self._display = facts.display
        self._is_integer = facts.kind == "integer"
        self.setKeyboardTracking(False)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setDecimals(0 if self._is_integer else 10)
        self.setRange(-_MOST, _MOST)
        self.setSpecialValueText(facts.display.text(None))  # stands for the least value: automatic
        if self._display.unit:
            self.setSuffix(self._display.unit if self._display.unit == "°" else f" {self._display.unit}")
        self.set_data(facts.value)
        self._before = self.text()

    def set_data(self, value: float | None) -> None:
        """Show a value of the parameter; None: automatic."""
        self.setValue(self.minimum() if value is None else self._display.to_shown(value))

    def data(self) -> tuple[bool, Any]:
        """Return whether something else was entered, and the parameter's new value (None: automatic)."""
        if self.text() == self._before:
            return False, None
        self.interpretText()
        if self.value() == self.minimum():
            return True, None
        return True, int(self.value()) if self._is_integer else self._display.to_data(self.value())

    def textFromValue(self, value: float) -> str:
        """All digits there are, no more."""
        return f"{value:.12g}"

    def valueFromText(self, text: str) -> float:
        """Decimal point or comma; what is no number leaves the value as it is."""
        try:
            return float(self._bare(text))
        except ValueError:
            return self.value()

    def validate(self, text: str, at: int) -> tuple[QValidator.State, str, int]:
        """A number is a number, however large; an empty line is on the way to one."""
        if text == self.specialValueText():
            return QValidator.State.Acceptable, text, at
        bare = self._bare(text)
        if any(letter not in "+-.0123456789eE" for letter in bare):
            return QValidator.State.Invalid, text, at
        try:
            float(bare)
        except ValueError:
            return QValidator.State.Intermediate, text, at
        return QValidator.State.Acceptable, text, at

    def _bare(self, text: str) -> str:
        return text.removesuffix(self.suffix()).removesuffix(self._display.unit).strip().replace(",", ".")

    def stepBy(self, steps: int) -> None:
        """Step by the digit after the leading one, within the range."""
        facts = self._display.facts
        if facts.low is None or facts.high is None:
            return
        low, high = self._display.to_shown(facts.low), self._display.to_shown(facts.high)
        value = low if self.value() == self.minimum() else self.value() + steps * self._step(steps)
        value = min(max(value, low), high)
        self.setValue(float(f"{value:.10g}"))
        self.selectAll()

    def _step(self, steps: int) -> float:
        size = abs(self.value())
        if size == 0:
            high = self._display.facts.high
            size = self._display.to_shown(high) / 10 if high else 1.0
        elif steps * self.value() < 0:
            size *= 0.999  # from 10 down it goes in the steps below 10, as it came up
        step = 10.0 ** (floor(log10(size)) - 1)
        return max(step, 1.0) if self._is_integer else step


class ChoiceInput(QComboBox):
    """One of a few words; opens at once."""

    def __init__(self, facts: RowFacts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("parameter_choice")
        self.setAccessibleName(facts.title)
        for word in facts.display.facts.choices:
            self.addItem(human_words(word), word)
        self.setCurrentIndex(self.findData(facts.value))
        QTimer.singleShot(0, self, self._open)

    def _open(self) -> None:
        if self.isVisible() and self.window().isActiveWindow():
            self.showPopup()


class PointInput(QLineEdit):
    """Three numbers in the shown unit, separated by commas or blanks."""

    def __init__(self, facts: RowFacts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("parameter_point")
        self.setAccessibleName(facts.title)
        self.setPlaceholderText(f"x, y, z {facts.display.unit}")
        self._display: Display = facts.display
        if facts.value is not None:
            self.setText(", ".join(self._display.number(number) for number in facts.value))
        self._before = self.text()
        self.setAlignment(Qt.AlignmentFlag.AlignRight)

    def data(self) -> tuple[bool, Any]:
        """Return whether something else was entered, and the new value.

        None is automatic; what is no point is returned as its text, for the schema to refuse.
        """
        text = self.text().strip()
        if text == self._before:
            return False, None
        if not text:
            return True, None
        words = text.removesuffix(self._display.unit).replace(",", " ").split()
        try:
            return True, tuple(self._display.to_data(float(word)) for word in words)
        except ValueError:
            return True, text
