"""What the step of the cup is told: where it stands, how large it is, and what it weighs."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QFormLayout, QPushButton, QWidget

from app.gui.pages.cell.number_box import number_box
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
        self._of: Path | None = None
        self._station = [number_box(f"station_{axis}", -_REACH_MM, _REACH_MM) for axis in "xyz"]
        self._length, self._wall = number_box("cup_length", 20, 400), number_box("cup_wall", 0.5, 20)
        self._mouth, self._base = number_box("cup_mouth", 20, 400), number_box("cup_base", 5, 400)
        self._payload, self._cup_kg = number_box("payload", 0, 5, 2), number_box("cup_mass", 0, 5, 2)
        self.read = QPushButton(self.tr("Read from the arm"))
        self.read.setObjectName("read_station")
        self.read.setToolTip(
            self.tr("The hand holds the standing cup, where it was guided to; nothing moves")
        )
        self.read.clicked.connect(self.read_wanted)
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.setSpacing(GRID_PX)
        for title, boxes in (
            (self.tr("Foot: x, y, z in mm"), self._station),
            (self.tr("Length, wall in mm"), [self._length, self._wall]),
            (self.tr("Mouth, base in mm"), [self._mouth, self._base]),
            (self.tr("All, full cup in kg"), [self._payload, self._cup_kg]),
        ):
            for box in boxes:
                box.setAccessibleName(title)
            form.addRow(title, row_of(*boxes))
        form.addRow("", row_of(self.read))
        self._payload.setToolTip(self.tr("All that hangs at the flange: gripper, camera and full cup"))
        self._cup_kg.setToolTip(self.tr("Of that the full cup; 0: the arm is not told when it holds one"))

    def show_entry(self, cell_file: Path | None, entry: CupEntry, can_read: bool) -> None:
        """Show what a cell's file has; what was typed stays as long as it is the same."""
        self.read.setVisible(can_read)
        if (cell_file, entry) == (self._of, self._shown):
            return
        self._of, self._shown = cell_file, entry
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
