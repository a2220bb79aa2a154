"""What is asked before the window closes: while a job runs, and while the arm stands where it was stopped."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QMessageBox, QWidget

from app.gui.desk.arm_link import ArmLink
from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob

translate = QCoreApplication.translate


def may_close(window: QWidget, desk: Desk) -> bool:
    """Ask if there is a reason to; a job that may be ended is, and what it moves is stopped."""
    job, standing = desk.jobs.running, what_stands(desk.arm)
    if job is None and not standing:
        return True
    box = _question(window, job, standing)
    close = box.addButton(_to_close(job), QMessageBox.ButtonRole.AcceptRole)
    stay = box.addButton(_to_stay(job), QMessageBox.ButtonRole.RejectRole)
    box.setDefaultButton(stay)
    box.exec()
    if box.clickedButton() is not close:
        return False
    if job is not None:
        desk.arm.stop()
    return True


def what_stands(arm: ArmLink) -> str:
    """Say what an arm that pours holds, and where; empty if it holds nothing and stands on no path."""
    connected, status = arm.connected, arm.status
    if connected is None or status is None or not arm.is_ours_to_pour:
        return ""
    stopped_in, holds = status.stopped_in, bool(status.is_gripper_closed)
    if stopped_in is None and not holds:
        return ""
    if stopped_in is None:
        said = translate("Closing", "The gripper of the {name} is closed: it may hold the cup.")
        return said.format(name=connected.name)
    if not holds:
        said = translate("Closing", "The {name} stands where it was stopped in “{move}”, its gripper open.")
    elif stopped_in.is_over_the_object:
        said = translate("Closing", "The {name} holds the cup over the object; it was stopped in “{move}”.")
    else:
        said = translate(
            "Closing", "The {name} holds the cup away from its station; it was stopped in “{move}”."
        )
    return said.format(name=connected.name, move=stopped_in.label)


def _question(window: QWidget, job: RunningJob | None, standing: str) -> QMessageBox:
    box = QMessageBox(window)
    box.setObjectName("closing")
    box.setIcon(QMessageBox.Icon.Question)
    if job is not None:
        box.setWindowTitle(translate("Closing", "A job is running"))
        asked = translate("Closing", "“{title}” is still running. Stop it and close?")
        box.setText(asked.format(title=job.title))
        details = [translate("Closing", "Finished stages are kept; a moving arm is stopped where it is.")]
        box.setInformativeText(" ".join([*details, standing]).strip())
        return box
    box.setWindowTitle(translate("Closing", "The arm is not at home"))
    box.setText(standing)
    box.setInformativeText(
        translate(
            "Closing", "It stays like that when the program closes. The Robot page brings it back first."
        )
    )
    return box


def _to_close(job: RunningJob | None) -> str:
    return translate("Closing", "Close anyway") if job is None else translate("Closing", "Stop and close")


def _to_stay(job: RunningJob | None) -> str:
    return translate("Closing", "Stay") if job is None else translate("Closing", "Keep working")
