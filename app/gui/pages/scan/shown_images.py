"""Which view's images the side panel shows: the newest one, or the one that somebody selected."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.gui.desk.background import Background
from app.gui.pages.scan.loading import Picture, load_images
from app.gui.pages.scan.side_part import ScanSide
from app.gui.pages.scan.view_table import ViewTable
from app.gui.pages.scan.words import view_headline, view_problems
from app.jobs.scan_news import ViewDone
from core.errors import PoursightError

Images = tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32]]


class ShownImages:
    """Loads a view's images in the background; the old ones stay until then.

    Attributes:
        selected: index of the view that somebody picked; none while the newest is followed.
        latest: index of the one that was taken last.
    """

    def __init__(self, side: ScanSide, views: ViewTable, background: Background) -> None:
        self.selected: int | None = None
        self.latest = 0
        self._side = side
        self._views = views
        self._background = background
        self._shown: Picture | None = None

    def select(self, index: int, folder: Path | None) -> None:
        """Show a view; `folder` holds the images of a scan under way."""
        self.selected = index
        self._tell(index)
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
        self._tell(index)
        if news.color is not None and news.depth_m is not None:
            self._shown = None
            self._side.show_images(news.color, news.depth_m)

    def forget(self) -> None:
        """Show nothing, and follow the newest."""
        self.selected = None
        self.latest = 0
        self._show(None)
        self._side.caption("")
        self._side.say("")

    def follow(self) -> None:
        """Look at the newest from its coming on."""
        self.selected = None

    def _tell(self, index: int) -> None:
        view = self._views.views[index]
        self._side.caption(view_headline(index, view))
        self._side.say(view_problems(view))

    def _show(self, images: Images | None) -> None:
        if images is None:
            self._shown = None
            self._side.show_images(None, None)
        else:
            self._side.show_images(*images)

    def _fail(self, error: PoursightError) -> None:
        self._show(None)
        self._side.say(str(error))
