"""The views of the scan as the page knows them: from the session's files, and from a scan under way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
from PySide6.QtGui import QImage

from app.gui.pages.scan.loading import Picture, ScanContents
from app.gui.pages.scan.words import view_headline, view_problems
from app.gui.views.thumbnails import Thumbnail
from app.jobs.scan_news import ViewDone, ViewNews, ViewsPlanned

_THINNED = 2
"""Every second pixel is enough for a thumbnail."""


class ViewTable:
    """Keeps the views in their order, each with its picture.

    Attributes:
        views: what became of each.
    """

    def __init__(self) -> None:
        self.views: list[ViewNews] = []
        self._pictures: dict[str, Picture] = {}
        self._files: dict[Picture, Path] = {}
        self._live: dict[str, QImage] = {}

    @property
    def n_taken(self) -> int:
        """How many have images."""
        return sum(view.state in ("taken", "poor") for view in self.views)

    @property
    def n_done(self) -> int:
        """How many need no visit any more."""
        return sum(view.state != "pending" for view in self.views)

    @property
    def poor(self) -> list[str]:
        """Names of those that deserve another try."""
        return [view.name for view in self.views if view.state in ("poor", "failed")]

    def forget(self) -> None:
        """Another session: its views may have the same names."""
        self.views = []
        self._pictures, self._files, self._live = {}, {}, {}

    def take_over(self, contents: ScanContents) -> None:
        """Be what was read; pictures told live are the same ones, and stay."""
        self.views = list(contents.views)
        self._pictures = dict(contents.pictures or {})
        self._files = {picture: self._file(picture) for picture in self._pictures.values()}
        self._live = {name: image for name, image in self._live.items() if name in self._pictures}

    def plan(self, news: ViewsPlanned) -> None:
        """Be what a scan plans; what it kept of an interrupted one has its pictures already."""
        self.views = list(news.views)
        kept = {view.name for view in self.views if view.state in ("taken", "poor")}
        self._live = {name: image for name, image in self._live.items() if name in kept}
        self._pictures = {name: picture for name, picture in self._pictures.items() if name in kept}

    def done(self, news: ViewDone) -> int | None:
        """Take over what became of a view and return its index; none if it was never planned."""
        for index, view in enumerate(self.views):
            if view.name == news.view.name:
                self.views[index] = news.view
                if news.color is not None:
                    self._live[view.name] = _thumbnail(news.color)
                return index
        return None

    def picture(self, index: int, folder: Path | None) -> Picture | None:
        """Return a view's images on the disk; `folder` holds those of the scan that is under way."""
        view = self.views[index]
        if view.state not in ("taken", "poor"):
            return None
        if folder is not None:
            return Picture(folder / f"{view.name}.color.png", 0)
        return self._pictures.get(view.name)

    def thumbnail(self, index: int) -> Thumbnail:
        """Return a view as the grid shows it."""
        view = self.views[index]
        picture: QImage | Path | None = self._live.get(view.name)
        if picture is None and (known := self._pictures.get(view.name)) is not None:
            picture = self._file(known)
        tooltip = "\n".join(text for text in (view_headline(index, view), view_problems(view)) if text)
        return Thumbnail(view.name, str(index + 1), view.state, picture, tooltip)

    def thumbnails(self) -> list[Thumbnail]:
        """Return all views as the grid shows them."""
        return [self.thumbnail(index) for index in range(len(self.views))]

    def _file(self, picture: Picture) -> Path:
        """The very same path as long as the picture is the same: by that the grid knows."""
        return self._files.setdefault(picture, picture.color)


def _thumbnail(color: npt.NDArray[np.uint8]) -> QImage:
    small = np.ascontiguousarray(color[::_THINNED, ::_THINNED])
    height, width, _ = small.shape
    return QImage(small.tobytes(), width, height, 3 * width, QImage.Format.Format_RGB888).copy()
