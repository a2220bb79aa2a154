"""What the menus do with the window."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QApplication, QFileDialog, QInputDialog, QMessageBox

from app.gui.frame.menus import Menus, MenuWishes
from app.gui.frame.shortcuts import ShortcutOverview
from app.gui.palette import apply_theme
from app.jobs.session_work import SessionWork
from app.library.places import sessions_folder

if TYPE_CHECKING:
    from app.gui.window import MainWindow


class WindowActions(QObject):
    """Dialogs, and the deeds behind the menus.

    Attributes:
        menus: the window's menu bar.
    """

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._desk = window.desk
        wishes = MenuWishes(
            new_session=self.new_session,
            open_session=self.open_session,
            close_session=self.close_session,
            write_report=self.write_report,
            show_page=window.show_page,
            toggle_log=window.job_bar.toggle_log,
            use_theme=self.use_theme,
            reset_layout=window.reset_layout,
            use_simulated_cell=lambda: self._desk.cell.choose(None),
            open_cell=self.open_cell,
            show_keys=self.show_keys,
            show_about=self.show_about,
            quit=self._quit,
        )
        self.menus = Menus(wishes, self._desk.workspace.undo_stack, window.memory.theme)
        window.welcome.new_wanted.connect(self.new_session)
        window.welcome.open_wanted.connect(self.open_session)
        self._desk.workspace.session_changed.connect(self._enable)
        self._enable()

    def new_session(self) -> None:
        """Ask for a name and open a new session."""
        name, is_given = QInputDialog.getText(
            self._window, self.tr("New session"), self.tr("What will be scanned?"), text=self.tr("object")
        )
        if is_given and name.strip():
            self._desk.new_session(name.strip())

    def open_session(self) -> None:
        """Ask for a session's folder and open it."""
        start = str(self._desk.workspace.folder or sessions_folder())
        folder = QFileDialog.getExistingDirectory(self._window, self.tr("Open a session's folder"), start)
        if folder:
            self._desk.open_session(Path(folder))

    def close_session(self) -> None:
        """Go back to the beginning."""
        if self._desk.jobs.is_idle:
            self._desk.workspace.close()

    def write_report(self) -> None:
        """Write the report and open it in the browser."""
        if self._desk.workspace.session is not None:
            self._desk.jobs.start(
                self.tr("Report"), "history", self._desk.session_host, SessionWork.report,
                self._desk.workspace.task(), then=_open_file,
            )  # fmt: skip

    def use_theme(self, name: str) -> None:
        """Show the program light, dark, or like the system."""
        from app.gui.main import theme_named

        self._window.memory.theme = name
        application = QApplication.instance()
        assert isinstance(application, QApplication), "there is a window"
        apply_theme(application, theme_named(name))

    def open_cell(self) -> None:
        """Ask for a cell's file and work with that cell."""
        path, _ = QFileDialog.getOpenFileName(
            self._window, self.tr("Open a cell file"), str(Path.home()), self.tr("Cell files (*.toml)")
        )
        if path:
            self._desk.cell.choose(Path(path))

    def show_keys(self) -> None:
        """Show all keys."""
        ShortcutOverview(self.menus, self._window).open()

    def show_about(self) -> None:
        """Say what this is."""
        QMessageBox.about(
            self._window,
            self.tr("About Poursight"),
            self.tr(
                "<b>Poursight {version}</b><p>Can I pour into it? "
                "The method of Wu & Chirikjian, RA-L 2020.</p>"
                "<p>STOP is a software stop. It is not safety-rated.</p>"
            ).format(version=version("poursight")),
        )

    def _quit(self) -> None:
        self._window.close()

    def _enable(self) -> None:
        for action in self.menus.session_actions:
            action.setEnabled(self._desk.workspace.session is not None)


def _open_file(path: Path) -> None:
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))
