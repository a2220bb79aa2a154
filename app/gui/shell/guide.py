"""The operator's guide, as a window of its own that can stay open beside the work."""

from __future__ import annotations

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QDesktopServices, QImage, QTextBlockFormat, QTextCursor
from PySide6.QtWidgets import QDialog, QHBoxLayout, QListWidget, QTextBrowser, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX
from core.resources import RESOURCES

DOCUMENTS = RESOURCES.parent / "docs"
GUIDE_FILE = DOCUMENTS / "operating.md"
_SIZE_PX = (960, 720)
_LIST_PX, _PICTURE_PX = 220, 620
_LINE_GAP_PX = 4


class GuideText(QTextBrowser):
    """The guide's text; its pictures are no wider than the text."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("guide_text")
        self.setOpenLinks(False)
        self.setSearchPaths([str(DOCUMENTS)])
        self.anchorClicked.connect(self._open)
        self.document().setDocumentMargin(3 * GRID_PX)
        self.setMarkdown(GUIDE_FILE.read_text(encoding="utf-8"))
        self._space_lines()
        self.moveCursor(QTextCursor.MoveOperation.Start)

    @override
    def loadResource(self, kind: int, name: QUrl | str) -> object:
        """Read a picture, small enough for the page."""
        loaded = super().loadResource(kind, name)
        picture = QImage(str(DOCUMENTS / QUrl(name).path()))
        if picture.isNull():
            return loaded
        return picture.scaledToWidth(_PICTURE_PX, Qt.TransformationMode.SmoothTransformation)

    def _space_lines(self) -> None:
        cursor = QTextCursor(self.document())
        cursor.select(QTextCursor.SelectionType.Document)
        spaced = QTextBlockFormat()
        spaced.setLineHeight(_LINE_GAP_PX, QTextBlockFormat.LineHeightTypes.LineDistanceHeight.value)
        cursor.mergeBlockFormat(spaced)

    def _open(self, link: QUrl) -> None:
        """Open a link of the guide: another document, in what the system reads it with."""
        target = link if link.scheme() else QUrl.fromLocalFile(str(DOCUMENTS / link.path()))
        QDesktopServices.openUrl(target)


class Guide(QDialog):
    """Headings at the left, the text at the right."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("guide")
        self.setWindowTitle(self.tr("Operator's guide"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(*_SIZE_PX)
        self.text = GuideText()
        self.headings = QListWidget()
        self.headings.setObjectName("guide_headings")
        self.headings.setAccessibleName(self.tr("Contents"))
        self.headings.setFixedWidth(_LIST_PX)
        self.headings.setSpacing(GRID_PX // 2)
        self._places: list[int] = []
        self._list_headings()
        self.headings.currentRowChanged.connect(self._show)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        row.addWidget(self.headings)
        row.addWidget(self.text, 1)

    def _list_headings(self) -> None:
        block = self.text.document().begin()
        while block.isValid():
            if block.blockFormat().headingLevel() in (2, 3):
                self.headings.addItem(block.text())
                self._places.append(block.position())
            block = block.next()

    def _show(self, row: int) -> None:
        """Scroll to a heading, so that it is the first line."""
        document = self.text.document()
        place = document.documentLayout().blockBoundingRect(document.findBlock(self._places[row]))
        self.text.verticalScrollBar().setValue(round(place.top()) - GRID_PX)
