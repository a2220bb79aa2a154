"""The pages by their keys. A page's module is imported late: the window must be on the screen before it."""

from __future__ import annotations

from importlib import import_module

from PySide6.QtCore import QCoreApplication

from app.gui.desk.desk import Desk
from app.gui.frame.tab_list import TabFacts
from app.gui.pages.page import Page

WORK = ("scan", "reconstruction", "imagination", "pours", "robot")
OTHERS = ("calibration", "history")
_CLASSES = {
    "scan": "ScanPage",
    "reconstruction": "ReconstructionPage",
    "imagination": "ImaginationPage",
    "pours": "PoursPage",
    "robot": "RobotPage",
    "calibration": "CalibrationPage",
    "history": "HistoryPage",
}


def import_page(key: str) -> type[Page]:
    """Return a page's class; safe in a thread, which is how the window keeps its imports from being felt."""
    page: type[Page] = getattr(import_module(f"app.gui.pages.{key}.page"), _CLASSES[key])
    return page


def make_page(key: str, desk: Desk) -> Page:
    """Make a page."""
    return import_page(key)(desk)


def tab_facts(key: str) -> TabFacts:
    """Return what a page's tab says."""
    translate = QCoreApplication.translate
    texts = {
        "scan": (
            translate("Tab", "Scan"),
            translate("Tab", "Let the robot look at the object from all sides."),
        ),
        "reconstruction": (
            translate("Tab", "Model"),
            translate("Tab", "The object's surface, and how good it is."),
        ),
        "imagination": (
            translate("Tab", "Imagine"),
            translate("Tab", "Would candies dropped on it stay? Told by physics."),
        ),
        "pours": (
            translate("Tab", "Pours"),
            translate("Tab", "From where to pour: 8 directions, 3 distances."),
        ),
        "robot": (translate("Tab", "Robot"), translate("Tab", "The planned motion, and the pour itself.")),
        "calibration": (
            translate("Tab", "Calibrate"),
            translate("Tab", "Try parameters on objects whose answer is known."),
        ),
        "history": (
            translate("Tab", "History"),
            translate("Tab", "Earlier sessions: look, compare, export."),
        ),
    }
    return TabFacts(key, *texts[key])
