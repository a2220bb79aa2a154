"""What the program remembers from one start to the next: session, window, theme; losing it does no harm."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QByteArray, QSettings

_LAST, _RUNNING, _THEME, _GEOMETRY, _SPLITS = "session/last", "session/running", "theme", "geometry", "splits"
_GOES_ON = "scan/goes_on"


class Memory:
    """Reads and writes the user's settings."""

    def __init__(self) -> None:
        self._settings = QSettings()

    @property
    def last_session(self) -> Path | None:
        """The session that was open last, if it is still there."""
        text = str(self._settings.value(_LAST, ""))
        return Path(text) if text and Path(text).is_dir() else None

    def store_session(self, folder: Path | None) -> None:
        """Remember a session as open; none: it was left properly."""
        if folder is not None:
            self._settings.setValue(_LAST, str(folder))
        self._settings.setValue(_RUNNING, folder is not None)
        self._settings.sync()  # a kill a moment later must not lose it

    @property
    def was_cut_off(self) -> bool:
        """Whether the program ended with a session open: killed, or the power failed."""
        return str(self._settings.value(_RUNNING, "false")).lower() == "true"

    @property
    def theme(self) -> str:
        """`light`, `dark`, or `system`."""
        return str(self._settings.value(_THEME, "system"))

    @theme.setter
    def theme(self, name: str) -> None:
        self._settings.setValue(_THEME, name)

    @property
    def imagines_after_scan(self) -> bool:
        """Whether a good scan is imagined at once; else when somebody asks for it."""
        return str(self._settings.value(_GOES_ON, "true")).lower() == "true"

    @imagines_after_scan.setter
    def imagines_after_scan(self, is_wanted: bool) -> None:
        self._settings.setValue(_GOES_ON, is_wanted)

    @property
    def geometry(self) -> QByteArray | None:
        """Place and size of the window."""
        value = self._settings.value(_GEOMETRY)
        return value if isinstance(value, QByteArray) else None

    @geometry.setter
    def geometry(self, value: QByteArray) -> None:
        self._settings.setValue(_GEOMETRY, value)

    def split(self, page: str) -> list[int] | None:
        """Sizes of a page's two halves."""
        # Not QSplitter.restoreState: what it restores depends on the size the widget has at that moment.
        value = self._settings.value(f"{_SPLITS}/{page}")
        return [int(size) for size in value] if isinstance(value, list) and len(value) == 2 else None

    def store_split(self, page: str, sizes: list[int]) -> None:
        """Remember them."""
        if len(sizes) == 2 and all(sizes):
            self._settings.setValue(f"{_SPLITS}/{page}", sizes)
