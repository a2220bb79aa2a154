"""The pages by their keys. A page's module is imported late: the window must be on the screen before it."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

from PySide6.QtCore import QCoreApplication

from app.gui.desk.desk import Desk
from app.gui.pages.page import Page

WORK = ("scan", "reconstruction", "imagination", "pours", "robot")
OTHERS = ("tuning", "history", "cell")
_CLASSES = {
    "scan": "scan.page:ScanPage",
    "reconstruction": "reconstruction.page:ReconstructionPage",
    "imagination": "imagination.page:ImaginationPage",
    "pours": "pours.page:PoursPage",
    "robot": "robot.page:RobotPage",
    "tuning": "tuning.page:TuningPage",
    "history": "history.page:HistoryPage",
    "cell": "cell.page:CellPage",
}


@dataclass(frozen=True)
class TabFacts:
    """A page's key, its title, and what it is for."""

    key: str
    title: str
    tip: str


def import_page(key: str) -> type[Page]:
    """Return a page's class; safe in a thread, which is how the window keeps its imports from being felt."""
    module, name = _CLASSES[key].split(":")
    page: type[Page] = getattr(import_module(f"app.gui.pages.{module}"), name)
    return page


def make_page(key: str, desk: Desk) -> Page:
    """Make a page."""
    return import_page(key)(desk)


def tab_facts(key: str) -> TabFacts:
    """Return what a page's tab says."""

    def tr(text: str) -> str:
        return QCoreApplication.translate("Tab", text)

    texts = {
        "scan": (tr("Scan"), tr("Let the robot scan the object from all sides.")),
        "reconstruction": (tr("Model"), tr("The object's surface, and how good it is.")),
        "imagination": (tr("Imagine"), tr("Test by physics whether dropped candies stay in the object.")),
        "pours": (tr("Pours"), tr("Where to pour from: 8 directions, 3 distances.")),
        "robot": (tr("Robot"), tr("The planned motion, and the pour itself.")),
        "tuning": (tr("Tune"), tr("Try parameters on objects whose answer is known.")),
        "history": (tr("History"), tr("Earlier sessions: view, compare, export.")),
        "cell": (tr("Cell"), tr("From a bare table to a calibrated cell.")),
    }
    return TabFacts(key, *texts[key])
