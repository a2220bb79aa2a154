"""What is known of the model in words and numbers, and its parameters."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QPushButton, QScrollArea

from app.gui.desk.desk import Desk
from app.gui.pages.fact_grid import Fact, FactGrid
from app.gui.pages.page import SidePanel
from app.gui.pages.parameters_part import FoldedParameters
from app.gui.pages.reconstruction.loading import MM, ShownModel
from app.gui.pages.reconstruction.modes import difference_numbers_mm
from app.gui.pages.scan_verdict import verdict_reasons, verdict_title
from app.gui.pages.staleness import StaleNote
from app.gui.theme import GRID_PX
from app.gui.views.fact_table import Column, FactTable, Row
from app.gui.views.labels import text_label, view_number, with_view_numbers
from core.geometry import FloatArray
from core.stages import groups_of

if TYPE_CHECKING:  # they bring the fusion along
    from core.quality.view_quality import ViewQuality
    from core.reconstruction.result import Reconstruction

STAGES = ("reconstruction", "quality", "collision")
_GROUPS = groups_of("reconstruction", "collision")
_ML = 1e6


class ModelSide(SidePanel):
    """Verdict, facts, pose health, parameters.

    Signals: `scan_requested` when the button of the empty state is pressed.
    """

    scan_requested = Signal()

    def __init__(self, desk: Desk) -> None:
        super().__init__(self.tr("Reconstruct"))
        self._verdict = text_label("model_verdict", "verdict")
        self._reasons = text_label("model_reasons")
        self._failed = text_label("model_failed", "failed")
        self.stale = StaleNote(STAGES)
        self._to_scan = QPushButton()
        self._to_scan.setObjectName("model_empty_button")
        self._to_scan.clicked.connect(self.scan_requested)
        self.facts = FactGrid("model_facts")
        self._health_head = text_label(
            "health_head", "heading", self.tr("Pose health of each view, lengths in mm")
        )
        self._health = text_label("health_sentence", "muted")
        self.table = self._make_table()
        self.parameters = FoldedParameters(desk, _GROUPS)
        self.parameters.opened.connect(lambda: QTimer.singleShot(0, self._scroll_to_parameters))
        above_table = (self._verdict, self._reasons, self._failed, self._to_scan, self.stale, self.facts)
        for widget in (*above_table, self.parameters, self._health_head, self._health, self.table):
            self.body.addWidget(widget)
        self.body.addStretch(1)
        self._failed.hide()

    def _make_table(self) -> FactTable:
        above = self.tr("In mm: how far above (+) or below (-) its place the view sees the table")
        off = self.tr("In mm: median distance of the view's points on the object to the model")
        moved = self.tr("In mm: how far the camera was moved so that the views agree")
        table = FactTable(
            [
                Column(self.tr("View"), tooltip=self.tr("The view's number, as on the Scan page")),
                Column(self.tr("Table"), tooltip=above, decimals=1),
                Column(self.tr("Tilt"), "°", self.tr("How far from level the view sees the table")),
                Column(self.tr("Off"), tooltip=off),
                Column(self.tr("Moved"), tooltip=moved, decimals=1),
            ]
        )
        table.setObjectName("health_table")
        table.setAccessibleName(self.tr("Pose health"))
        table.grow_with_rows()
        return table

    def show_empty(self, sentence: str, button: str) -> None:
        """Show what will be here, and the button that leads there; without a text there is no button."""
        self._verdict.setText(sentence)
        self._reasons.hide()
        self._to_scan.setText(button)
        self._to_scan.setVisible(bool(button))
        for widget in (self.facts, self._health_head, self._health, self.table):
            widget.hide()

    def show_failure(self, sentence: str) -> None:
        """Say why the model cannot be shown; empty: it can."""
        self._failed.setText(sentence)
        self._failed.setVisible(bool(sentence))

    def show_model(
        self, model: ShownModel, before: ShownModel | None, difference_m: FloatArray | None
    ) -> None:
        """Show what is known of a model, and of the one before."""
        verdict, reasons = self._verdict_texts(model)
        self._verdict.setText(verdict)
        self._reasons.setText(reasons)
        self._reasons.setVisible(bool(reasons))
        self._to_scan.hide()
        self.facts.setVisible(True)
        self.facts.set_facts(self._make_facts(model, before, difference_m))
        made = model.reconstruction
        for widget in (self._health_head, self._health, self.table):
            widget.setVisible(made is not None)
        self._health.setText("" if made is None else self._agreement(made))
        self._health.setToolTip(model.health)
        self.table.set_rows(_rows(model))
        self.table.setVisible(bool(self.table.rows))

    def _verdict_texts(self, model: ShownModel) -> tuple[str, str]:
        if model.reconstruction is None:
            said = self.tr(
                "It was not scanned, so there are no views, no pose health and no verdict on a scan. Only "
                "the parameters of its collision model have an effect."
            )
            return self.tr("Imported mesh"), said
        if model.quality is None:
            said = self.tr("The scan was not checked with this model yet: press Reconstruct.")
            return self.tr("Scan not checked"), said
        return verdict_title(model.quality), "\n".join(verdict_reasons(model.quality))

    def _make_facts(
        self, model: ShownModel, before: ShownModel | None, difference_m: FloatArray | None
    ) -> list[Fact]:
        size = self.tr("Edges of the bounding box along x, y and z, in mm")
        volume = self.tr("What the closed surface encloses: the object's material, not what it holds")
        facts = [
            Fact(title, text(model), tip, "" if before is None else text(before))
            for title, text, tip in (
                (self.tr("Size in mm"), self._size, size),
                (self.tr("Volume"), self._volume, volume),
                (self.tr("Faces"), self._faces, self.tr("Triangles of the surface")),
            )
        ]
        made = model.reconstruction
        if made is not None:
            height = self.tr("{z:.1f} mm").format(z=made.platform_height_m * MM)
            tip = self.tr("Height of the platform under the object in the robot's base frame")
            facts.append(Fact(self.tr("Platform"), height, tip))
        if difference_m is not None:
            mean_mm, most_mm = difference_numbers_mm(difference_m)
            text = self.tr("{mean:.2f} mm, 95 % within {most:.2f} mm").format(mean=mean_mm, most=most_mm)
            tip = self.tr("Mean distance of the new surface from the last one, at its vertices")
            facts.append(Fact(self.tr("Difference"), text, tip, is_wide=True))
        return facts

    def _size(self, model: ShownModel) -> str:
        x, y, z = model.mesh.extents_m * MM
        return self.tr("{x:.0f} × {y:.0f} × {z:.0f}").format(x=x, y=y, z=z)

    def _volume(self, model: ShownModel) -> str:
        if not model.is_closed:
            return self.tr("unknown, not closed")
        return self.tr("{volume:.0f} ml").format(volume=model.mesh.volume_m3 * _ML)

    def _faces(self, model: ShownModel) -> str:
        return f"{len(model.mesh.faces):,}".replace(",", "\u202f")

    def _agreement(self, made: Reconstruction) -> str:
        """How well the views' poses agree, in short; the tooltip says it in full."""
        health, refinement = made.pose_health, made.refinement
        if health.mean_height_m is None or health.sd_height_m is None or health.largest_tilt_rad is None:
            said = self.tr("Too few views see the table to measure how well the poses agree.")
        else:
            said = self.tr("Table seen at {mean:.1f} ± {sd:.1f} mm, tilted by up to {tilt:.1f}°.").format(
                mean=health.mean_height_m * MM,
                sd=health.sd_height_m * MM,
                tilt=degrees(health.largest_tilt_rad),
            )
        if refinement is not None and refinement.residual_before_m and refinement.residual_after_m:
            said += " " + self.tr(
                "Views {after:.1f} mm apart, {before:.1f} mm before their poses were corrected."
            ).format(after=refinement.residual_after_m * MM, before=refinement.residual_before_m * MM)
        return said

    def _scroll_to_parameters(self) -> None:
        area = self.findChild(QScrollArea)
        if isinstance(area, QScrollArea):
            area.ensureWidgetVisible(self.parameters, 0, 2 * GRID_PX)


def _rows(model: ShownModel) -> list[Row]:
    if model.quality is None or model.reconstruction is None:
        return []
    refinement = model.reconstruction.refinement
    moved_m = {} if refinement is None else {view.name: view.shift_m for view in refinement.views}
    return [_row(view, moved_m.get(view.name)) for view in model.quality.views]


def _row(view: ViewQuality, moved_m: float | None) -> Row:
    tilt_rad = view.table_tilt_rad
    return Row(
        (
            view_number(view.name),
            _without_minus_zero(_scaled(view.table_offset_m)),
            None if tilt_rad is None else degrees(tilt_rad),
            _scaled(view.residual_median_m),
            _scaled(moved_m),
        ),
        tooltip="\n".join(map(with_view_numbers, view.problems)),
        needs_attention=bool(view.problems),
    )


def _scaled(length_m: float | None) -> float | None:
    return None if length_m is None else length_m * MM


def _without_minus_zero(value: float | None) -> float | None:
    """What one decimal would show as -0.0 is nothing."""
    return 0.0 if value is not None and abs(value) < 0.05 else value
