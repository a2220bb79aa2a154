"""The views of the scan as the page knows them, and which one's images are shown."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QCoreApplication
from PySide6.QtGui import QImage

from app.gui.desk.background import Background
from app.gui.pages.scan.appearance import Appearance
from app.gui.pages.scan.loading import Picture, ScanContents, load_images
from app.gui.pages.scan.side import ScanSide
from app.gui.remedies import worded
from app.gui.views.labels import view_number, view_title
from app.gui.views.thumbnails import Thumbnail
from app.jobs.scan_events import ViewDone, ViewProgress, ViewsPlanned
from core.errors import PoursightError

Images = tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32]]
_THINNED = 2
"""Every second pixel is enough for a thumbnail."""


class ViewTable:
    """The views in their order, each with its picture.

    Attributes:
        views: what became of each.
    """

    def __init__(self) -> None:
        self.views: list[ViewProgress] = []
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
        """Take over what was read; pictures that arrived live are the same ones, and stay."""
        self.views = list(contents.views)
        self._pictures = dict(contents.pictures or {})
        self._files = {picture: self._file(picture) for picture in self._pictures.values()}
        self._live = {name: image for name, image in self._live.items() if name in self._pictures}

    def plan(self, news: ViewsPlanned) -> None:
        """Take over what a scan plans; views of an interrupted one have their pictures already."""
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
        """Return a view's images on the disk; `folder` holds those of the running scan."""
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
        tooltip = "\n".join(text for text in (_headline(view), _problems(view)) if text)
        return Thumbnail(view.name, view_number(view.name), view.state, picture, tooltip)

    def thumbnails(self) -> list[Thumbnail]:
        """Return all views as the grid shows them."""
        return [self.thumbnail(index) for index in range(len(self.views))]

    def _file(self, picture: Picture) -> Path:
        """The very same object as long as the picture is the same: by that the grid knows."""
        return self._files.setdefault(picture, picture.color)


class ShownImages:
    """Loads a view's images in the background; the old ones stay until then.

    Attributes:
        selected: index of the view that somebody picked; none while the newest is shown.
        latest: index of the one that was taken last.
    """

    def __init__(self, side: ScanSide, views: ViewTable, background: Background) -> None:
        self.selected: int | None = None
        self.latest = 0
        self._side = side
        self._views = views
        self._background = background
        self._shown: Picture | None = None
        self._appearance = Appearance(side.appearance, side.show_color, background)

    def select(self, index: int, folder: Path | None) -> None:
        """Show a view; `folder` holds the images of a running scan."""
        self.selected = index
        self._describe(index)
        picture = self._views.picture(index, folder)
        if picture is None:
            self._show(None)
        elif picture != self._shown or folder is not None:
            self._shown = picture
            load = partial(load_images, picture)
            self._background.run("images of a view", load, self._show, lambda error: self._fail(error))

    def newest(self, index: int, news: ViewDone) -> None:
        """A view was taken just now: show it, unless somebody looks at another one."""
        self.latest = index
        if self.selected is not None:
            return
        self._describe(index)
        if news.color is not None and news.depth_m is not None:
            self._shown = None
            self._side.show_images(news.color, news.depth_m)
            self._appearance.follow(None, news.color)

    def forget(self) -> None:
        """Show nothing, and follow the newest."""
        self.selected = None
        self.latest = 0
        self._show(None)
        self._side.caption("")
        self._side.show_problems("")

    def follow(self) -> None:
        """Show the next view that is taken, and those after it."""
        self.selected = None

    def _describe(self, index: int) -> None:
        view = self._views.views[index]
        self._side.caption(_headline(view))
        self._side.show_problems(_problems(view))

    def _show(self, images: Images | None) -> None:
        if images is None:
            self._shown = None
            self._side.show_images(None, None)
        else:
            self._side.show_images(*images)
        self._appearance.follow(self._shown, None if images is None else images[0])

    def _fail(self, error: PoursightError) -> None:
        self._show(None)
        self._side.show_problems(worded(error))


def _thumbnail(color: npt.NDArray[np.uint8]) -> QImage:
    small = np.ascontiguousarray(color[::_THINNED, ::_THINNED])
    height, width, _ = small.shape
    return QImage(small.tobytes(), width, height, 3 * width, QImage.Format.Format_RGB888).copy()


def _headline(view: ViewProgress) -> str:
    """Say what became of a view."""
    translate = QCoreApplication.translate
    states = {
        "pending": translate("ScanViews", "not taken yet"),
        "taken": translate("ScanViews", "taken"),
        "poor": translate("ScanViews", "taken, but poor"),
        "failed": translate("ScanViews", "left out"),
    }
    return f"{view_title(view.name)}: {states[view.state]}"


def _problems(view: ViewProgress) -> str:
    """Say what is wrong with a view; its frame's name means nothing to people."""
    it = QCoreApplication.translate("ScanViews", "It")
    return " ".join(problem.replace(view.name, it) for problem in view.problems)
