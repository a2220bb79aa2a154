"""The verdict on a scan, as the Scan and the Model page word it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from app.gui.views.labels import with_view_numbers

if TYPE_CHECKING:
    from core.quality.measures import ScanQuality

translate = QCoreApplication.translate


def verdict_title(quality: ScanQuality) -> str:
    """Return the verdict in two words."""
    titles = {
        "good": translate("ScanVerdict", "Good scan"),
        "usable": translate("ScanVerdict", "Usable scan"),
        "scan again": translate("ScanVerdict", "Scan again"),
    }
    return titles.get(quality.verdict, quality.verdict)


def verdict_reasons(quality: ScanQuality) -> list[str]:
    """Return why a scan is no better, a sentence each; none for a good one."""
    return [] if quality.verdict == "good" else [_reason(reason) for reason in quality.reasons]


def _reason(reason: str) -> str:
    said = with_view_numbers(reason.removeprefix("usable: ").removeprefix("scan again: "))
    return said[:1].upper() + said[1:]
