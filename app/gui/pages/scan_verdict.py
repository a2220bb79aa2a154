"""The verdict on a scan, as the Scan and the Model page word it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

if TYPE_CHECKING:
    from collections.abc import Sequence

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


def view_title(index: int) -> str:
    """Return what people call a view; they count from one."""
    return translate("ScanVerdict", "View {number}").format(number=index + 1)


def verdict_reasons(quality: ScanQuality, names: Sequence[str]) -> list[str]:
    """Return why a scan is no better, a sentence each; none for a good one.

    Args:
        quality: the verdict.
        names: of the views, such as `frame-000003`, in their order; people call them by numbers.
    """
    return [] if quality.verdict == "good" else [_reason(reason, names) for reason in quality.reasons]


def _reason(reason: str, names: Sequence[str]) -> str:
    said = reason.removeprefix("usable: ").removeprefix("scan again: ")
    for index, name in enumerate(names):
        said = said.replace(name, view_title(index))
    return said[:1].upper() + said[1:]
