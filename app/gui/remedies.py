"""Remedies as the window words them: buttons and pages."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from core.errors import PoursightError, Remedy


def remedy_words(remedy: Remedy | None) -> str:
    """Return what to press or to do; empty without a remedy."""
    translate = QCoreApplication.translate
    words = {
        Remedy.RUN_AGAIN: translate("Remedy", "Run that step again."),
        Remedy.CONTINUE: translate("Remedy", "Press Try again to continue."),
        Remedy.FEWER_WORKERS: translate("Remedy", "Close other programs, then press Try again."),
        Remedy.RUN_STAGES: translate("Remedy", "Run its step again."),
        Remedy.JUDGE_MOTIONS: translate("Remedy", "Plan the pour again on the Robot page."),
        Remedy.IMPORT_SCAN: translate("Remedy", "Scan the object, or import a scan, on the Scan page."),
        Remedy.NEW_SESSION: translate("Remedy", "Start a new session."),
        Remedy.SCAN_THE_MESH: translate("Remedy", "On the Scan page choose the mesh as object, and scan."),
        Remedy.CHOOSE_OBJECT: translate("Remedy", "Choose the object on the Scan page."),
        Remedy.NO_OBJECT: translate("Remedy", "Put it there and scan."),
        Remedy.OTHER_CELL: translate("Remedy", "Choose another cell in the menu Cell."),
        Remedy.START_CLUSTER: translate("Remedy", "Start its workers, then press Try again."),
        Remedy.POUR_ANYWAY: translate("Remedy", "Tick its box on the Robot page to pour all the same."),
        Remedy.EMPTY_HAND: translate("Remedy", "On the Robot page bring the cup home, or open the gripper."),
        Remedy.RESTART_SCAN: translate("Remedy", "Press Start over on the Scan page to discard them."),
        Remedy.RESTART_CALIBRATION: translate(
            "Remedy", "Press Start over on the Cell page to leave them aside."
        ),
    }
    return "" if remedy is None else words[remedy]


def worded(error: PoursightError) -> str:
    """Return what went wrong and what to do about it."""
    return f"{error} {remedy_words(error.remedy)}".rstrip()
