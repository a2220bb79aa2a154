"""The menus and what they do: everything that has a key is here, so that it can be found."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from pathlib import Path

from PySide6.QtCore import QUrl
from PySide6.QtGui import QAction, QActionGroup, QDesktopServices, QKeySequence
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QGridLayout,
    QInputDialog,
    QLabel,
    QMenu,
    QMenuBar,
    QMessageBox,
    QVBoxLayout,
    QWidget,
)

from app.gui.pages.registry import OTHERS, WORK, tab_facts
from app.gui.shell.guide import Guide
from app.gui.shell.window import MainWindow
from app.gui.stop.panel import STOP_KEYS
from app.gui.theme import GRID_PX, apply_theme, theme_named
from app.jobs.session_work import SessionWork
from app.library.places import sessions_folder


class Menus(QMenuBar):
    """The menu bar, and the dialogs that its actions open."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._desk = window.desk
        self._session_actions: list[QAction] = []
        self._add_session_menu()
        self._add_edit_menu()
        self._add_view_menu()
        self._add_cell_menu()
        self._add_help_menu()
        window.welcome.new_wanted.connect(self.new_session)
        window.welcome.open_wanted.connect(self.open_session)
        window.top_bar.session.new_wanted.connect(self.new_session)
        self._desk.new_session_wanted.connect(self.new_session)
        self._desk.report_wanted.connect(self._write_report)
        window.top_bar.session.open_wanted.connect(self.open_session)
        self._desk.workspace.session_changed.connect(self._enable)
        self._enable()

    def new_session(self) -> None:
        """Ask for a name and open a new session."""
        name, is_given = QInputDialog.getText(
            self._window, self.tr("New session"), self.tr("What will be scanned?"), text=self.tr("object")
        )
        if is_given and name.strip() and self._desk.new_session(name.strip()):
            self._window.show_page("scan")

    def open_session(self) -> None:
        """Ask for a session's folder and open it."""
        start = str(self._desk.workspace.folder or sessions_folder())
        folder = QFileDialog.getExistingDirectory(self._window, self.tr("Open a session's folder"), start)
        if folder:
            self._desk.open_session(Path(folder))

    def show_keys(self) -> None:
        """Show all keys."""
        ShortcutOverview(self, self._window).open()

    def show_guide(self) -> None:
        """Show the operator's guide beside the window."""
        Guide(self._window).show()

    def _add_session_menu(self) -> None:
        menu = self.addMenu(self.tr("&Session"))
        _add(menu, self.tr("&New…"), "Ctrl+N", self.new_session)
        _add(menu, self.tr("&Open…"), "Ctrl+O", self.open_session)
        report = _add(menu, self.tr("Write &report"), "Ctrl+R", self._write_report)
        close = _add(menu, self.tr("&Close session"), "Ctrl+W", self._close_session)
        self._session_actions = [report, close]
        menu.addSeparator()
        self._add_imagine_after_scan(menu)
        menu.addSeparator()
        _add(menu, self.tr("&Quit"), "Ctrl+Q", self._window.close)

    def _add_imagine_after_scan(self, menu: QMenu) -> None:
        memory = self._window.memory

        def remember(is_wanted: bool) -> None:
            memory.imagines_after_scan = is_wanted

        action = menu.addAction(self.tr("&Imagine at once after a good scan"))
        action.setObjectName("imagine_after_scan")
        action.setCheckable(True)
        action.setChecked(memory.imagines_after_scan)
        action.toggled.connect(remember)

    def _add_edit_menu(self) -> None:
        menu = self.addMenu(self.tr("&Edit"))
        stack = self._desk.workspace.undo_stack
        undo, redo = (
            stack.createUndoAction(menu, self.tr("Undo")),
            stack.createRedoAction(menu, self.tr("Redo")),
        )
        undo.setShortcut(QKeySequence("Ctrl+Z"))
        redo.setShortcut(QKeySequence("Ctrl+Shift+Z"))
        menu.addActions([undo, redo])

    def _add_view_menu(self) -> None:
        menu = self.addMenu(self.tr("&View"))
        for number, key in enumerate((*WORK, *OTHERS), 1):
            _add(menu, tab_facts(key).title, f"Ctrl+{number}", partial(self._window.show_page, key))
        menu.addSeparator()
        _add(menu, self.tr("&Next step"), "Ctrl+Return", self._window.job_bar.go_on)
        _add(menu, self.tr("&Log"), "Ctrl+L", self._window.job_bar.toggle_log)
        themes = menu.addMenu(self.tr("&Theme"))
        group = QActionGroup(self)
        names = {"system": self.tr("Same as the system"), "light": self.tr("Light"), "dark": self.tr("Dark")}
        for name, text in names.items():
            action = _add(themes, text, "", partial(self._use_theme, name))
            action.setCheckable(True)
            action.setChecked(name == self._window.memory.theme)
            group.addAction(action)
        _add(menu, self.tr("&Reset layout"), "", self._window.reset_layout)

    def _add_cell_menu(self) -> None:
        menu = self.addMenu(self.tr("&Cell"))
        _add(menu, self.tr("&Simulated cell"), "", lambda: self._desk.cell.choose(None))
        _add(menu, self.tr("&Open a cell file…"), "", self._open_cell)
        _add(menu, self.tr("Set &up a cell"), "", partial(self._window.show_page, "cell"))

    def _add_help_menu(self) -> None:
        menu = self.addMenu(self.tr("&Help"))
        _add(menu, self.tr("&Operator's guide"), "Shift+F1", self.show_guide)
        _add(menu, self.tr("&Keys"), "F1", self.show_keys)
        _add(menu, self.tr("&About"), "", self._show_about)

    def _enable(self) -> None:
        for action in self._session_actions:
            action.setEnabled(self._desk.workspace.session is not None)

    def _close_session(self) -> None:
        if self._desk.jobs.is_idle:
            self._desk.workspace.close()

    def _write_report(self) -> None:
        """Write the report and open it in the browser."""
        if self._desk.workspace.session is not None:
            self._desk.jobs.start(
                self.tr("Report"), "history", self._desk.session_host, SessionWork.report,
                self._desk.workspace.task(), then=_open_file, steps=self._desk.workspace.steps_to("evidence"),
            )  # fmt: skip

    def _use_theme(self, name: str) -> None:
        self._window.memory.theme = name
        application = QApplication.instance()
        assert isinstance(application, QApplication), "there is a window"
        apply_theme(application, theme_named(name))

    def _open_cell(self) -> None:
        path, _ = QFileDialog.getOpenFileName(
            self._window, self.tr("Open a cell file"), str(Path.home()), self.tr("Cell files (*.toml)")
        )
        if path:
            self._desk.cell.choose(Path(path))

    def _show_about(self) -> None:
        QMessageBox.about(
            self._window,
            self.tr("About Poursight"),
            self.tr(
                "<b>Poursight {version}</b><p>Can I pour into it? "
                "The method of Wu & Chirikjian, RA-L 2020.</p>"
                "<p>STOP is a software stop. It is not safety-rated.</p>"
            ).format(version=version("poursight")),
        )


class ShortcutOverview(QDialog):
    """Keys and what they do, gathered from the menus, so that the list cannot be outdated."""

    def __init__(self, menus: QMenuBar, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Keys"))
        rows = [(self.tr("STOP the arm"), ", ".join(STOP_KEYS)), *actions_with_keys(menus)]
        rows += [
            (self.tr("Play or pause a replay"), self.tr("Space")),
            (self.tr("Step in a replay, or to the next pour"), self.tr("Arrow keys")),
            (self.tr("Press the button that has the focus"), self.tr("Enter or Space")),
            (self.tr("Hold to pour"), self.tr("Space or Enter, held")),
        ]
        grid = QGridLayout()
        grid.setHorizontalSpacing(4 * GRID_PX)
        for k, (what, keys) in enumerate(rows):
            grid.addWidget(QLabel(what), k, 0)
            key = QLabel(keys)
            key.setProperty("role", "heading")
            grid.addWidget(key, k, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setContentsMargins(3 * GRID_PX, 2 * GRID_PX, 3 * GRID_PX, 2 * GRID_PX)
        column.setSpacing(2 * GRID_PX)
        column.addLayout(grid)
        column.addWidget(buttons)


def actions_with_keys(menus: QMenuBar) -> list[tuple[str, str]]:
    """Return each action of the menus that has a key, and that key, both as people read them."""
    actions = [action for menu in menus.findChildren(QMenu) for action in menu.actions()]
    return [
        (action.text().replace("&", ""), action.shortcut().toString())
        for action in actions
        if not action.shortcut().isEmpty()
    ]


def _add(menu: QMenu, text: str, key: str, do: Callable[[], object]) -> QAction:
    action = menu.addAction(text)
    if key:
        action.setShortcut(QKeySequence(key))
    action.triggered.connect(lambda _checked=False: do())
    return action


def _open_file(path: Path) -> None:
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))
