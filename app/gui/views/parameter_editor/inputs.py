"""The editors that open in a row: a number with its unit, a choice, a point."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QValidator
from PySide6.QtWidgets import QAbstractSpinBox, QComboBox, QDoubleSpinBox, QLineEdit, QWidget

from app.gui.views.parameter_editor.naming import Display, human_words

_MOST = 1e12
"""What can be typed; what is allowed is decided by the schema, which explains it in a sentence."""


class NumberInput(QDoubleSpinBox):
    """A number in the shown unit with all its digits; steps stay in the range, typing need not."""

    def __init__(
        self,
        display: Display,
        value: float | None,
        parent: QWidget | None = None,
        *,
        is_integer: bool = False,
        is_optional: bool = False,
    ) -> None:
        super().__init__(parent)
        self.setObjectName("parameter_number")
        self._display = display
        self._is_integer = is_integer
        self._is_optional = is_optional
        self.setKeyboardTracking(False)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setDecimals(0 if is_integer else 10)
        self.setRange(-_MOST, _MOST)
        self.setStepType(QAbstractSpinBox.StepType.AdaptiveDecimalStepType)
        self.setSpecialValueText(display.text(None))  # the least value means automatic
        if display.unit:
            self.setSuffix(display.unit if display.unit == "°" else f" {display.unit}")
        self.setValue(self.minimum() if value is None else display.to_shown(value))
        self._before = self.text()

    def data(self) -> tuple[bool, Any]:
        """Return whether something else was entered, and the parameter's new value (None: automatic)."""
        self.interpretText()
        if self.text() == self._before:
            return False, None
        if self.value() == self.minimum():
            return True, None
        return True, int(self.value()) if self._is_integer else self._display.to_data(self.value())

    def textFromValue(self, value: float) -> str:
        """All digits there are, no more."""
        return f"{value:.12g}"

    def valueFromText(self, text: str) -> float:
        """Decimal point or comma; empty is automatic; anything else leaves the value as it is."""
        bare = self._bare(text)
        if not bare and self._is_optional:
            return self.minimum()
        try:
            return float(bare)
        except ValueError:
            return self.value()

    def validate(self, text: str, at: int) -> tuple[QValidator.State, str, int]:
        """Accept any number, however large; an empty line may become one."""
        bare = self._bare(text)
        if text == self.specialValueText() or (not bare and self._is_optional):
            return QValidator.State.Acceptable, text, at
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
        if self.value() == self.minimum():
            self.setValue(low)
        elif self.value() == 0:
            self.setValue(max(low, steps * (1.0 if self._is_integer else high / 100)))
        else:
            super().stepBy(steps)
        self.setValue(min(max(self.value(), low), high))
        self.selectAll()


class ChoiceInput(QComboBox):
    """One of a few words; opens at once."""

    def __init__(self, display: Display, value: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("parameter_choice")
        for word in display.facts.choices:
            self.addItem(human_words(word), word)
        self.setCurrentIndex(self.findData(value))
        QTimer.singleShot(0, self, self._open)

    def data(self) -> tuple[bool, Any]:
        """Return that a choice was made, and which."""
        return True, self.currentData()

    def _open(self) -> None:
        if self.isVisible() and self.window().isActiveWindow():
            self.showPopup()


class PointInput(QLineEdit):
    """Three numbers in the shown unit, separated by commas or blanks."""

    def __init__(
        self, display: Display, value: tuple[float, ...] | None, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("parameter_point")
        self.setPlaceholderText(f"x, y, z {display.unit}")
        self._display = display
        if value is not None:
            self.setText(", ".join(display.number(number) for number in value))
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
