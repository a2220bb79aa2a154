"""The rendered pictures as a film strip that fills while they are drawn."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.film_strip import FilmStrip, Picture

_HEIGHT_PX = 88
SHEET = "pours.png"
DROP_FILM, POUR_FILM = "drop.mp4", "pour.mp4"


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
            self.tr("Draw stills and films with shadows, for the report; some ten seconds")
        )
        self.button.clicked.connect(self.render_wanted)
        self._film_buttons = {
            DROP_FILM: self._film_button("drop_film", self.tr("Film of the drop"), DROP_FILM),
            POUR_FILM: self._film_button("pour_film", self.tr("Film of the pour"), POUR_FILM),
        }
        self.strip = FilmStrip(_HEIGHT_PX)
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
        button.setToolTip(self.tr("Open it in the program that plays films here"))
        button.clicked.connect(lambda: QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._films[film]))))
        return button

    def show_none(self, sentence: str = "") -> None:
        """Show that there are none, and why."""
        self._show_films({})
        self._said.setText(sentence)
        self.strip.set_pictures([])
        self.strip.hide()

    def show_drawing(self, paths: list[Path], with_pours: bool) -> None:
        """Show those that are drawn so far, and which ones are awaited."""
        self._show_films({})
        expected = [name for name in self._captions() if with_pours or name != SHEET]
        self._said.setText(self.tr("Drawing pictures: {n} of {all}").format(n=len(paths), all=len(expected)))
        self._show(paths, expected)

    def show_drawn(self, paths: list[Path]) -> None:
        """Show all."""
        self._said.setText(self.tr("Pictures: click one to see it large"))
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
            "drop_5_pushed.png": self.tr("Shoved"),
            "drop_6_end.png": self.tr("End"),
            SHEET: self.tr("All pours"),
        }
