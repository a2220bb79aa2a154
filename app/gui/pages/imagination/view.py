"""The left half: the drop in 3D with its time line, and under it the rendered pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PySide6.QtCore import QCoreApplication, QEvent, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.imagination.drop import PhaseKey, ShownBody, ShownDrop, push_of, tilted_pose
from app.gui.pages.layouts import lay_around
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.film_strip import FilmStrip
from app.gui.views.picture_dialog import Picture
from app.gui.views.scene import Scene3D, candy_legend
from app.gui.views.timeline import Section, Timeline
from core.geometry import FloatArray

_SEE_THROUGH = 0.4
_PICTURE_PX = 88
_SHEET = "pours.png"
_DROP_FILM, _POUR_FILM = "drop.mp4", "pour.mp4"


class DropReplay(QWidget):
    """Shows a drop at the time that the time line points at.

    Attributes:
        scene: the 3D view.
        timeline: plays the drop.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("drop_replay")
        self._drop: ShownDrop | None = None
        self.scene = Scene3D()
        self.scene.setObjectName("drop_scene")
        self.timeline = Timeline()
        self.timeline.time_changed.connect(self._show_time)
        self._legend = QLabel()
        self._legend.setObjectName("drop_legend")
        self._now = QLabel()
        self._now.setObjectName("drop_now")
        self._now.setProperty("role", "muted")
        self._see_through = QPushButton(self.tr("See through"))
        self._see_through.setObjectName("see_through")
        self._see_through.setCheckable(True)
        self._see_through.setChecked(True)
        self._see_through.setToolTip(
            self.tr("Make the object's walls transparent, to see the candies behind them")
        )
        self._see_through.toggled.connect(self._show_body)
        self._build()

    def _build(self) -> None:
        top = QHBoxLayout()
        top.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        top.addWidget(self._legend)
        top.addSpacing(2 * GRID_PX)
        top.addWidget(self._now)
        top.addStretch(1)
        top.addWidget(self._see_through)
        bottom = QHBoxLayout()
        bottom.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        bottom.addWidget(self.timeline)
        lay_around(self, top, self.scene, bottom)
        self.show_nothing()

    def show_nothing(self) -> None:
        """Show an empty view."""
        self._forget()
        self.scene.clear()
        self._show_legend()

    def show_body(self, shown: ShownBody) -> None:
        """Show an object on which nothing was dropped yet."""
        self._forget()
        self.scene.clear()
        self.scene.set_prepared_mesh("object", shown.body)
        radius_m = shown.ground_radius_m
        self.scene.set_ground("ground", shown.center_m, [radius_m] * 2, shown.casters_m)
        self.scene.fit("object")
        self._show_legend()

    def show_drop(self, drop: ShownDrop, *, is_played: bool = False) -> None:
        """Show another drop: played from its beginning, or at its end, where the verdict is seen."""
        is_first, self._drop = self._drop is None, drop
        self._see_through.show()
        self._fill(drop)
        sections = [Section(phase_title(phase.key), phase.begin_s, phase.end_s) for phase in drop.phases]
        self.timeline.set_sections(drop.moments.duration_s, sections)
        if is_first:
            self.scene.fit("object", "candies", "start")
        self.timeline.set_time(0.0 if is_played else drop.moments.duration_s)
        if is_played:
            self.timeline.play()
        self._show_legend()

    def _forget(self) -> None:
        self._drop = None
        self._see_through.hide()
        self.timeline.set_sections(0.0)

    def show_tilt(self, tilt_rad: float, toward_rad: float, words: str) -> None:
        """Tilt the object until the time line is used again; where candies are then was not recorded.

        Args:
            tilt_rad: how far.
            toward_rad: the side that sinks, against the x-axis.
            words: what is said of it.
        """
        drop = self._drop
        if drop is not None:
            self.timeline.pause()
            n = drop.drop.n_drop
            self.scene.set_candy_poses("candies", np.full((n, 3), np.nan), np.full((n, 4), np.nan))
            self.scene.set_pose("object", tilted_pose(drop.casters_m, drop.ground_m, tilt_rad, toward_rad))
            self._now.setText(words)

    def put_back(self) -> None:
        """Show the drop at the time of the time line, if the object was tilted."""
        self._show_time(self.timeline.time_s)

    def _fill(self, drop: ShownDrop) -> None:
        found = drop.drop
        self._show_body()
        middle = found.aabb_m.mean(axis=0)
        self.scene.set_ground(
            "ground", [*middle[:2], drop.ground_m], [drop.ground_radius_m] * 2, drop.casters_m
        )
        self.scene.set_line("start", _rectangle_m(found.drop_positions_m), color="muted", width_px=1)
        self.scene.set_candies("candies", found.n_drop, drop.candy, found.retained)

    def _show_body(self) -> None:
        if self._drop is not None:
            opacity = _SEE_THROUGH if self._see_through.isChecked() else 1.0
            self.scene.set_prepared_mesh("object", self._drop.body, opacity=opacity)

    def _show_time(self, time_s: float) -> None:
        drop = self._drop
        if drop is None:
            self._now.clear()
            return
        moments = drop.moments
        self.scene.set_candy_poses("candies", moments.positions_m(time_s), moments.quaternions(time_s))
        self.scene.set_pose("object", drop.moments.T_world_body(time_s))
        self._now.setText(self._words(drop, time_s))

    def _words(self, drop: ShownDrop, time_s: float) -> str:
        """What happens at a time."""
        phase = next((one for one in drop.phases if one.begin_s <= time_s < one.end_s), None)
        if phase is None:
            return self.tr("End")
        if phase.key == "drop":
            return self.tr("Candies fall and settle")
        if phase.key == "push":
            direction = push_of(drop.settings, time_s - phase.begin_s)
            return self.tr("Pushed along {direction}").format(direction=direction)
        angle_deg = float(np.degrees(drop.settings.rotation_rad))
        axis = "x" if phase.key == "tilt_x" else "y"
        return self.tr("Tilted by up to {angle:.3g}° about {axis}").format(angle=angle_deg, axis=axis)

    def _show_legend(self) -> None:
        if self._drop is None:
            self._legend.clear()
            return
        found = self._drop.drop
        kept = self.tr("{n} kept").format(n=found.n_in)
        lost = self.tr("{n} lost").format(n=found.n_drop - found.n_in)
        self._legend.setTextFormat(Qt.TextFormat.RichText)
        self._legend.setText(candy_legend(theme_of(self), kept, lost))

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show_legend()


def phase_title(key: PhaseKey) -> str:
    """Return a phase's name."""
    translate = QCoreApplication.translate
    titles: dict[PhaseKey, str] = {
        "drop": translate("Phase", "drop"),
        "tilt_x": translate("Phase", "tilt x"),
        "tilt_y": translate("Phase", "tilt y"),
        "push": translate("Phase", "push"),
    }
    return titles[key]


def _rectangle_m(drop_positions_m: FloatArray) -> FloatArray:
    """Closed line (5, 3) around where the candies begin, at the highest of them."""
    positions = drop_positions_m
    low, high = positions.min(axis=0), positions.max(axis=0)
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]), (low[0], low[1])]
    return np.array([[x, y, high[2]] for x, y in corners])


class PicturesPart(QWidget):
    """A line that says what there is, with the button that renders, and the strip under it.

    Signals: `render_wanted`.

    Attributes:
        button: renders.
        strip: the pictures.
    """

    render_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("pictures_part")
        self._films: dict[str, Path] = {}
        self._said = QLabel()
        self._said.setObjectName("pictures_said")
        self._said.setProperty("role", "muted")
        self.button = QPushButton(self.tr("Render pictures"))
        self.button.setObjectName("render_pictures")
        self.button.setToolTip(
            self.tr("Render stills and films with shadows for the report; takes about ten seconds")
        )
        self.button.clicked.connect(self.render_wanted)
        self._film_buttons = {
            _DROP_FILM: self._film_button("drop_film", self.tr("Film of the drop"), _DROP_FILM),
            _POUR_FILM: self._film_button("pour_film", self.tr("Film of the pour"), _POUR_FILM),
        }
        self.strip = FilmStrip(_PICTURE_PX)
        row = QHBoxLayout()
        row.setContentsMargins(GRID_PX, 0, GRID_PX, GRID_PX // 2)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self._said)
        row.addStretch(1)
        for button in self._film_buttons.values():
            row.addWidget(button)
        row.addWidget(self.button)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(row)
        column.addWidget(self.strip)
        self.show_none()

    def _film_button(self, name: str, text: str, film: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setProperty("role", "link")
        button.setToolTip(self.tr("Open it in your film player"))
        button.clicked.connect(lambda: QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._films[film]))))
        return button

    def show_none(self, sentence: str = "") -> None:
        """Show no pictures, and say why."""
        self._show_films({})
        self._said.setText(sentence)
        self.strip.set_pictures([])
        self.strip.hide()

    def show_drawing(self, paths: list[Path], with_pours: bool) -> None:
        """Show those that are rendered so far, and which ones are still to come."""
        self._show_films({})
        expected = [name for name in self._captions() if with_pours or name != _SHEET]
        self._said.setText(
            self.tr("Rendering pictures: {n} of {all}").format(n=len(paths), all=len(expected))
        )
        self._show(paths, expected)

    def show_drawn(self, paths: list[Path]) -> None:
        """Show all."""
        self._said.setText(self.tr("Click a picture to enlarge it"))
        self._show_films({path.name: path for path in paths if path.suffix == ".mp4"})
        self._show([path for path in paths if path.suffix == ".png"], [])

    def _show(self, paths: list[Path], expected: list[str]) -> None:
        captions = self._captions()
        pictures = [Picture(captions.get(path.name, path.stem), path) for path in paths]
        self.strip.set_pictures(pictures, [captions[name] for name in expected])
        self.strip.show()

    def _show_films(self, films: dict[str, Path]) -> None:
        self._films = films
        for name, button in self._film_buttons.items():
            button.setVisible(name in films)

    def _captions(self) -> dict[str, str]:
        """What each file shows, in their order."""
        return {
            "drop_1_start.png": self.tr("Start"),
            "drop_2_falling.png": self.tr("Falling"),
            "drop_3_settled.png": self.tr("Settled"),
            "drop_4_rotated.png": self.tr("Tilted"),
            "drop_5_pushed.png": self.tr("Pushed"),
            "drop_6_end.png": self.tr("End"),
            _SHEET: self.tr("All pours"),
        }
