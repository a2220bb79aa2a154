"""A mouse for a real X screen: what it presses reaches windows of any process, as a person's hand does."""

from __future__ import annotations

import ctypes
import ctypes.util


class XPointer:
    """Presses the left button by the XTest extension."""

    def __init__(self) -> None:
        """Connect to the screen of DISPLAY."""
        self._x11 = ctypes.CDLL("libX11.so.6")
        self._test = ctypes.CDLL("libXtst.so.6")
        self._x11.XOpenDisplay.restype = ctypes.c_void_p
        self._display = ctypes.c_void_p(self._x11.XOpenDisplay(None))
        assert self._display, "there is a screen"

    def move(self, x: int, y: int) -> None:
        """Go to a pixel of the screen."""
        self._test.XTestFakeMotionEvent(self._display, -1, x, y, 0)
        self._x11.XFlush(self._display)

    def press(self) -> None:
        """Press where it is; `release` before the next one."""
        self._button(is_down=True)

    def release(self) -> None:
        """Let go."""
        self._button(is_down=False)

    def _button(self, is_down: bool) -> None:
        self._test.XTestFakeButtonEvent(self._display, 1, int(is_down), 0)
        self._x11.XFlush(self._display)
