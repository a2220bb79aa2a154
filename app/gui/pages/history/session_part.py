"""What is known of the selected session, and what can be done with it, in the side panel."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.history import words
from app.gui.pages.history.card_painter import paint_verdict
from app.gui.pages.history.exports import KINDS, ExportKind
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import tabular
from app.library.summary import SessionSummary


class SessionPart(QWidget):
    """Facts and buttons of one session.

    Signals: `export_wanted` with an `ExportKind`; `compare_wanted`, `folder_wanted`, `forget_wanted` and
    `trash_wanted` when their buttons are pressed.
    """

    export_wanted = Signal(object)
    compare_wanted = Signal()
    folder_wanted = Signal()
    forget_wanted = Signal()
    trash_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("session")
        self._name = _wrapping("session_name", "title")
        self._mark = _VerdictMark()
        self._verdict = _wrapping("session_verdict", "verdict")
        self._problem = _wrapping("session_problem")
        self._rows: dict[str, tuple[QLabel, QLabel]] = {}
        self._exports: dict[ExportKind, QPushButton] = {}
        self._tips: dict[ExportKind, str] = {}
        verdict = QHBoxLayout()
        verdict.setSpacing(GRID_PX)
        verdict.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        verdict.addWidget(self._verdict, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(self._name)
        column.addLayout(verdict)
        column.addWidget(self._problem)
        column.addLayout(self._build_facts())
        column.addSpacing(GRID_PX)
        column.addWidget(_heading(self.tr("Compare")))
        column.addLayout(self._build_compare())
        column.addWidget(_heading(self.tr("Export")))
        column.addLayout(self._build_exports())
        column.addWidget(_heading(self.tr("Keep or delete")))
        column.addLayout(self._build_keeping())

    def show_session(self, session: SessionSummary, *, is_elsewhere: bool) -> None:
        """Show a session; `is_elsewhere` if its folder is not in the library's."""
        self._name.setText(session.name)
        self._mark.show_verdict(words.verdict_of(session))
        self._verdict.setText(words.verdict_sentence(session))
        self._problem.setText(session.problem)
        self._problem.setVisible(bool(session.problem))
        facts = {
            "made": words.date_words(session),
            "from": session.source,
            "views": str(session.n_views) if session.n_views else "",
            "best": words.best_words(session) if session.best is not None else "",
            "chosen": words.chosen_words(session) if session.chosen is not None else "",
            "outcome": session.outcome or (words.outcome_words(session) if not session.problem else ""),
            "size": "" if session.problem else words.size_words(session),
        }
        for key, text in facts.items():
            for label in self._rows[key]:
                label.setVisible(bool(text))
            self._rows[key][1].setText(text)
        self._folder.setToolTip(str(session.path))
        self._forget.setVisible(is_elsewhere)

    def set_can(self, *, export: bool, report: bool, compare: bool, change: bool, hint: str) -> None:
        """Enable what can be done now.

        Args:
            export: whether the session can be exported at all.
            report: whether there is something to report.
            compare: whether another session is open to compare with.
            change: whether the session can be deleted.
            hint: how to compare, in a sentence.
        """
        for kind, button in self._exports.items():
            is_told = report or not kind.needs_report
            button.setEnabled(export and is_told)
            button.setToolTip(
                self._tips[kind]
                if is_told
                else self.tr("There is nothing to report: imagine the object first.")
            )
        self._compare.setVisible(compare)
        self._hint.setText(hint)
        self._trash.setEnabled(change)

    def _build_facts(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(2 * GRID_PX)
        grid.setVerticalSpacing(GRID_PX // 2)
        grid.setColumnStretch(1, 1)
        inside = self.tr("Share of the poured candies that land inside, in the imagination.")
        for key, title, tip in (
            ("made", self.tr("Made"), self.tr("When the session was begun, by this computer's clock.")),
            ("from", self.tr("From"), self.tr("Where the object's surface is from.")),
            ("views", self.tr("Views"), self.tr("Images that the scan is made of.")),
            ("best", self.tr("Best pour"), inside),
            ("chosen", self.tr("Chosen pour"), inside),
            ("outcome", self.tr("Outcome"), self.tr("What came of the newest pour by an arm.")),
            ("size", self.tr("Size"), self.tr("What the session takes on the disk.")),
        ):
            name, value = QLabel(title), _wrapping(f"fact_{key}")
            name.setProperty("role", "muted")
            value.setFont(tabular(self.font()))
            row = len(self._rows)
            for column, label in enumerate((name, value)):
                label.setToolTip(tip)
                grid.addWidget(
                    label, row, column, Qt.AlignmentFlag.AlignTop if column == 0 else Qt.AlignmentFlag(0)
                )
            self._rows[key] = name, value
        return grid

    def _build_compare(self) -> QVBoxLayout:
        self._compare = _button("compare_with_open", self.tr("Compare with the open session"))
        self._compare.clicked.connect(self.compare_wanted)
        self._hint = _wrapping("compare_hint", "muted")
        column = QVBoxLayout()
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._compare, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self._hint)
        return column

    def _build_exports(self) -> QHBoxLayout:
        texts = {
            "html": (self.tr("HTML…"), self.tr("The report as one file for a browser.")),
            "pdf": (self.tr("PDF…"), self.tr("The report for paper, A4.")),
            "zip": (self.tr("ZIP…"), self.tr("The whole session; another Poursight can import it.")),
        }
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        for kind in KINDS:
            text, tip = texts[kind.key]
            button = _button(f"export_{kind.key}", text, tip)
            button.clicked.connect(lambda _=False, wanted=kind: self.export_wanted.emit(wanted))
            self._exports[kind], self._tips[kind] = button, tip
            row.addWidget(button)
        row.addStretch(1)
        return row

    def _build_keeping(self) -> QHBoxLayout:
        self._folder = _button("show_folder", self.tr("Show folder"))
        self._folder.clicked.connect(self.folder_wanted)
        self._forget = _button(
            "forget", self.tr("Take off the list"), self.tr("It lies in another folder and stays there.")
        )
        self._forget.clicked.connect(self.forget_wanted)
        self._trash = _button("trash", self.tr("Delete…"), self.tr("Move the session to the trash."))
        self._trash.clicked.connect(self.trash_wanted)
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        for button in (self._folder, self._forget, self._trash):
            row.addWidget(button)
        row.addStretch(1)
        return row


class _VerdictMark(QWidget):
    """The mark before the verdict."""

    def __init__(self) -> None:
        super().__init__()
        self._verdict: words.Verdict = "unknown"
        self.setFixedSize(QSize(20, 22))

    def show_verdict(self, verdict: words.Verdict) -> None:
        self._verdict = verdict
        self.update()

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        paint_verdict(QPainter(self), QRectF(self.rect()), self._verdict, theme_of(self))

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()


def _wrapping(name: str, role: str = "") -> QLabel:
    """A label that wraps, and that a long word does not make wider than its panel."""
    label = QLabel()
    label.setObjectName(name)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
    if role:
        label.setProperty("role", role)
    return label


def _heading(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "heading")
    return label


def _button(name: str, text: str, tip: str = "") -> QPushButton:
    button = QPushButton(text)
    button.setObjectName(name)
    button.setAccessibleName(text)
    button.setToolTip(tip)
    return button
