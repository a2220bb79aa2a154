"""Looks laid over a view's colour image: what the network takes for containing, and its score."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QCheckBox, QVBoxLayout, QWidget

from app.gui.desk.background import Background
from app.gui.pages.scan.loading import COLOR_ENDING, POSE_ENDING, Picture
from app.gui.remedies import worded
from app.gui.theme import GRID_PX
from app.gui.views.labels import say, text_label
from core.appearance.network import held_out_accuracy
from core.errors import PoursightError

if TYPE_CHECKING:
    from core.scan.model import ColorImage


@dataclass(frozen=True, eq=False)
class ShownLook:
    """How a view looks.

    Attributes:
        color: (H, W, 3), the image with the contain map over it.
        score: from 0 to 1: how surely it shows an open container.
        contain_share: share of the square around the object that contains.
        is_container_by_physics: what the imagination says; none where it says nothing yet, or cannot tell.
    """

    color: ColorImage
    score: float
    contain_share: float
    is_container_by_physics: bool | None


def load_look(picture: Picture) -> ShownLook | None:
    """Look at a view; none if it does not show the object, or its scan is not finished.

    Raises:
        PoursightError: a file is damaged, or the network's weights are.
    """
    from core.appearance.looking import CONTAINS, look_at_view
    from core.appearance.network import shipped_network
    from core.scan.authors_layout import FACTS_FILE, INTRINSICS_FILE, read_facts
    from core.scan.model import RELEASED_BOX, RgbdFrame
    from core.scan.view_files import read_color, read_depth, read_intrinsics, read_pose

    folder, name = picture.color.parents[1], picture.color.name.removesuffix(COLOR_ENDING)
    if not (folder / INTRINSICS_FILE).is_file():
        return None
    facts = folder / FACTS_FILE
    box = read_facts(facts)[1] if facts.is_file() else None
    pose = read_pose(picture.color.with_name(name + POSE_ENDING))
    frame = RgbdFrame(name, read_color(picture.color), read_depth(picture.depth), pose)
    intrinsics = read_intrinsics(folder / INTRINSICS_FILE)
    seen = look_at_view(shipped_network(), frame, intrinsics, box or RELEASED_BOX)
    if seen is None:
        return None
    share = float((seen.look.contain > CONTAINS).mean())
    return ShownLook(seen.overlaid(frame.color), seen.look.score, share, _by_physics(picture))


def _by_physics(picture: Picture) -> bool | None:
    from core.files import read_json
    from core.imagination.judgement import JUDGEMENT_FILE
    from core.imagination.verdict import Verdict

    path = picture.color.parents[2] / "judgement" / JUDGEMENT_FILE
    if not path.is_file():
        return None
    table = read_json(path).get("verdict")
    verdict = None if table is None else Verdict.from_table(table)
    return None if verdict is None or verdict.is_undecided else verdict.is_container


class AppearanceRow(QWidget):
    """Switches the overlay on and off, and says what it means.

    Attributes:
        toggled: it was switched.
    """

    toggled = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._switch = QCheckBox(self.tr("Appearance"))
        self._switch.setObjectName("appearance")
        self._switch.setToolTip(
            self.tr(
                "What a network that sees colours alone takes for a hollow, in green. For comparison only: "
                "of views of objects like those it learnt from it judges {share:.0f} % rightly, and nothing "
                "goes by it."
            ).format(share=100 * held_out_accuracy())
        )
        self._said = text_label("appearance_said", "muted")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._switch)
        column.addWidget(self._said)
        self._switch.toggled.connect(lambda _: self.toggled.emit())
        self.tell("")

    @property
    def is_on(self) -> bool:
        """Whether the overlay is wanted."""
        return self._switch.isChecked()

    def tell(self, text: str) -> None:
        """Say what the view looks like."""
        say(self._said, text)

    def describe(self, look: ShownLook | None) -> None:
        """Say what was seen."""
        if look is None:
            self.tell(self.tr("This view does not show the object, or the scan is not finished."))
            return
        said = self.tr("Score {score:.2f}: looks like {what}. {share:.0f} % of the frame contains.").format(
            score=look.score,
            what=self.tr("an open container") if look.score > 0.5 else self.tr("no open container"),
            share=100 * look.contain_share,
        )
        self.tell(f"{said} {self._physics(look)}".rstrip())

    def _physics(self, look: ShownLook) -> str:
        if look.is_container_by_physics is None:
            return ""
        if look.is_container_by_physics is (look.score > 0.5):
            return self.tr("Physics agrees.")
        if look.is_container_by_physics:
            return self.tr("By physics it is an open container.")
        return self.tr("By physics it is none.")


class Appearance(QObject):
    """Lays the looks of the shown view over its colour image, while that is wanted."""

    def __init__(
        self, row: AppearanceRow, show: Callable[[ColorImage | None], None], background: Background
    ) -> None:
        super().__init__(row)
        self._row = row
        self._show = show
        self._background = background
        self._picture: Picture | None = None
        self._color: ColorImage | None = None
        row.toggled.connect(self._toggle)

    def follow(self, picture: Picture | None, color: ColorImage | None) -> None:
        """Another image is shown: (H, W, 3), and its files; none of one that is not on the disk yet."""
        self._picture, self._color = picture, color
        self._row.tell("")
        if self._row.is_on:
            self._look()

    def _toggle(self) -> None:
        if self._row.is_on:
            self._look()
        else:
            self._row.tell("")
            self._show(self._color)

    def _look(self) -> None:
        if self._picture is not None:
            load = partial(load_look, self._picture)
            shown = partial(self._take, self._picture)
            self._background.run("appearance of a view", load, shown, self._fail)

    def _take(self, picture: Picture, look: ShownLook | None) -> None:
        if picture != self._picture or not self._row.is_on:
            return
        self._row.describe(look)
        if look is not None:
            self._show(look.color)

    def _fail(self, error: PoursightError) -> None:
        self._row.tell(worded(error))
