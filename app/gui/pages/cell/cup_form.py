"""What the step of the cup is told: where it stands, how large it is, and what it weighs."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QFormLayout, QPushButton, QWidget

from app.gui.pages.layouts import row_of
from app.gui.theme import GRID_PX
from app.operations.calibration.cup_entry import CupEntry, base_diameter_m, changed_cup
from core.parameters.bodies import CupParameters

MM = 1000.0
_REACH_MM = 2000.0


class CupForm(QWidget):
    """Its values are those of the cell's file until somebody changes them.

    Signals: `read_wanted` when the station is to be read from where the hand was guided to.
    """

    read_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._shown: CupEntry | None = None
        self._station = [_box(f"station_{axis}", -_REACH_MM, _REACH_MM, " mm", 1) for axis in "xyz"]
        self._length, self._mouth = (
            _box("cup_length", 20, 400, " mm", 1),
            _box("cup_mouth", 20, 400, " mm", 1),
        )
        self._base, self._wall = _box("cup_base", 5, 400, " mm", 1), _box("cup_wall", 0.5, 20, " mm", 1)
        self._payload, self._cup_kg = _box("payload", 0, 5, " kg", 2), _box("cup_mass", 0, 5, " kg", 2)
        self.read = QPushButton(self.tr("Read from the arm"))
        self.read.setObjectName("read_station")
        self.read.setToolTip(
            self.tr("The hand holds the standing cup, where it was guided to; nothing moves")
        )
        self.read.clicked.connect(self.read_wanted)
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.setSpacing(GRID_PX)
        form.addRow(self.tr("Foot at x, y"), row_of(*self._station[:2]))
        form.addRow(self.tr("Foot at z"), row_of(self._station[2], self.read))
        form.addRow(self.tr("Length, wall"), row_of(self._length, self._wall))
        form.addRow(self.tr("Mouth, base"), row_of(self._mouth, self._base))
        form.addRow(self.tr("At the flange, full cup"), row_of(self._payload, self._cup_kg))

    def show_entry(self, entry: CupEntry, can_read: bool) -> None:
        """Show what the file has; what was typed stays as long as the file is the same."""
        self.read.setVisible(can_read)
        if entry == self._shown:
            return
        self._shown = entry
        self.show_station(entry.station_m)
        cup = entry.cup
        for box, value in (
            (self._length, cup.length_m * MM), (self._wall, cup.wall_m * MM),
            (self._mouth, 2 * cup.mouth_radius_m * MM), (self._base, base_diameter_m(cup) * MM),
            (self._payload, entry.payload_kg), (self._cup_kg, entry.cup_kg),
        ):  # fmt: skip
            with QSignalBlocker(box):
                box.setValue(value)

    def show_station(self, station_m: tuple[float, float, float]) -> None:
        """Show another place (3,)."""
        for box, value_m in zip(self._station, station_m, strict=True):
            box.setValue(value_m * MM)

    @property
    def entry(self) -> CupEntry:
        """What is shown; raises `InputError` if there can be no such cup."""
        x, y, z = (box.value() / MM for box in self._station)
        held = CupParameters() if self._shown is None else self._shown.cup
        given = self._length.value(), self._mouth.value(), self._base.value(), self._wall.value()
        shown = held.length_m * MM, 2 * held.mouth_radius_m * MM, base_diameter_m(held) * MM, held.wall_m * MM
        changed = tuple(
            None if abs(value - known) <= 0.05 else value for value, known in zip(given, shown, strict=True)
        )
        length, mouth, base, wall = changed
        cup = changed_cup(held, (length, mouth, base, wall))
        return CupEntry((x, y, z), cup, self._payload.value(), self._cup_kg.value())


def _box(name: str, least: float, most: float, unit: str, decimals: int) -> QDoubleSpinBox:
    box = QDoubleSpinBox()
    box.setObjectName(name)
    box.setRange(least, most)
    box.setDecimals(decimals)
    box.setSuffix(unit)
    return box
