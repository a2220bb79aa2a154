"""What a session still needs before the arm can pour, and where to get it."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication

from app.gui.desk.workspace import Workspace

translate = QCoreApplication.translate


@dataclass(frozen=True)
class Missing:
    """Something that is not there yet.

    Attributes:
        heading: what it is.
        text: why it is needed.
        button: what the primary button says.
        page: key of the page that the button leads to.
    """

    heading: str
    text: str
    button: str
    page: str


def missing_for_a_pour(workspace: Workspace, is_container: bool | None) -> Missing | None:
    """Return what is missing first; none if a pour can be planned.

    Args:
        workspace: with the session.
        is_container: what was imagined; none if that is not known.
    """
    if workspace.has("mesh"):
        return _to_scan(
            translate("RobotNeeds", "A mesh stands in no cell"),
            translate(
                "RobotNeeds",
                "This session holds a mesh, so nobody knows where such an object stands. To let the arm "
                "pour, begin a new session and scan the object.",
            ),
        )
    if not workspace.has("scan"):
        return _to_scan(
            translate("RobotNeeds", "No object yet"),
            translate(
                "RobotNeeds",
                "Here the arm pours candies into the object. First let it look at the object from all sides.",
            ),
        )
    if not (workspace.has("containability") and workspace.has("pouring")):
        return _to_imagination(
            translate("RobotNeeds", "No pours yet"),
            translate("RobotNeeds", "Here the arm makes the best of the imagined pours. First imagine them."),
        )
    if not (workspace.is_fresh("containability") and workspace.is_fresh("pouring")):
        return _to_imagination(
            translate("RobotNeeds", "The pours are out of date"),
            translate(
                "RobotNeeds",
                "They are from before something was changed; the arm makes only what belongs together. "
                "Imagine again.",
            ),
        )
    if is_container is False:
        return Missing(
            translate("RobotNeeds", "Nothing to pour into"),
            translate(
                "RobotNeeds",
                "This object is no open container: candies would not stay in it, so no pours were imagined.",
            ),
            translate("RobotNeeds", "See why"),
            "imagination",
        )
    return None


def _to_scan(heading: str, text: str) -> Missing:
    return Missing(heading, text, translate("RobotNeeds", "Go to Scan"), "scan")


def _to_imagination(heading: str, text: str) -> Missing:
    return Missing(heading, text, translate("RobotNeeds", "Go to Imagine"), "imagination")
