"""What to do next: the one button that leads from an object on the platform to candies in it."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication

from app.gui.desk.page_states import PageState
from app.gui.pages.registry import WORK


@dataclass(frozen=True)
class NextStep:
    """The page to go to, and the words for the button."""

    page: str
    words: str


def next_step(states: dict[str, PageState], is_container: bool | None, shown: str) -> NextStep | None:
    """Return the first thing of the work that is not as it should be; none when all is done.

    Args:
        states: of the pages.
        is_container: the verdict; none before there is one. Nothing is poured into what is no container.
        shown: the page that is shown: nobody lets the arm pour without having seen the pours.
    """
    translate = QCoreApplication.translate
    words = {
        "scan": translate("NextStep", "Next: scan the object"),
        "reconstruction": translate("NextStep", "Next: reconstruct the surface"),
        "imagination": translate("NextStep", "Next: imagine whether it contains"),
        "pours": translate("NextStep", "Next: review the pours"),
        "robot": translate("NextStep", "Next: let the arm pour"),
    }
    for page in WORK:
        if page in ("pours", "robot") and is_container is False:
            return None
        if states[page].word == "fresh":
            continue
        if page == "robot" and shown not in ("pours", "robot"):
            return NextStep("pours", words["pours"])
        return NextStep(page, words[page])
    return None
