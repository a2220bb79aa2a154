"""What the page says of moves, plans and the arm's state, in the user's language."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from app.gui.pages.fact_grid import Fact
from app.jobs.arm_news import ArmStatus, MoveProgress
from core.session.cups import Cup

if TYPE_CHECKING:
    from core.motion.pour.plan import PourPlan

MM = 1000.0
translate = QCoreApplication.translate


def move_words(name: str) -> str:
    """Say what a move does; its name, if it has none of its own."""
    words = {
        "to the cup": translate("RobotWords", "the open gripper goes to the cup"),
        "grasp": translate("RobotWords", "around the cup; then the gripper closes"),
        "lift": translate("RobotWords", "the cup is lifted straight up"),
        "carry": translate("RobotWords", "the cup is carried upright"),
        "lay": translate("RobotWords", "the cup is laid down over the object"),
        "lower": translate("RobotWords", "the cup's rim comes down to the pivot"),
        "pour": translate("RobotWords", "the cup turns about its rim and pours"),
        "turn back": translate("RobotWords", "the cup turns back"),
        "raise": translate("RobotWords", "the cup is raised"),
        "stand up": translate("RobotWords", "the cup is turned upright"),
        "carry back": translate("RobotWords", "the cup is carried back"),
        "put down": translate("RobotWords", "the cup is put down; then the gripper opens"),
        "retreat": translate("RobotWords", "the gripper leaves the cup"),
        "home": translate("RobotWords", "the arm goes home"),
        "back on the way": translate("RobotWords", "the arm goes back to its checked way"),
    }
    return words.get(name, name)


def minutes_words(seconds: float) -> str:
    """Say a time: seconds below two minutes, then minutes."""
    if seconds < 120:
        return translate("RobotWords", "{n} s").format(n=max(round(seconds), 0))
    return translate("RobotWords", "{n} min").format(n=round(seconds / 60))


def plan_facts(plan: PourPlan) -> list[Fact]:
    """Return what a person wants to know of a plan before it is carried out."""
    slower_s = plan.turn_s - plan.imagined_turn_s
    turn = translate("RobotWords", "{turn:.1f} s").format(turn=plan.turn_s)
    if slower_s > 0.05:
        turn = translate("RobotWords", "{turn:.1f} s, {slower:.1f} s slower than imagined").format(
            turn=plan.turn_s, slower=slower_s
        )
    nearest = translate("RobotWords", "{mm:.0f} mm between {first} and {second}").format(
        mm=plan.clearance_m * MM, first=plan.nearest[0], second=plan.nearest[1]
    )
    return [
        Fact(
            translate("RobotWords", "Takes"),
            translate("RobotWords", "{n} moves, {seconds:.0f} s").format(
                n=len(plan.moves), seconds=plan.duration_s
            ),
            translate(
                "RobotWords", "Seconds that the arm moves, without the gripper's own time; from the plan"
            ),
            is_wide=True,
        ),
        Fact(
            translate("RobotWords", "The turn"),
            turn,
            translate(
                "RobotWords",
                "The time of the turn that pours; imagined: {imagined:.1f} s, without speeding up.",
            ).format(imagined=plan.imagined_turn_s),
            is_wide=True,
        ),
        Fact(
            translate("RobotWords", "Free"),
            nearest,
            translate(
                "RobotWords",
                "The smallest distance of arm, gripper and camera to anything on the way; from the plan",
            ),
            is_wide=True,
        ),
        Fact(
            translate("RobotWords", "Cup"),
            translate("RobotWords", "{mm:.0f} mm around it").format(mm=plan.cup_clearance_m * MM),
            translate(
                "RobotWords",
                "The smallest distance of the held cup to anything but what it stands on; from the plan",
            ),
            is_wide=True,
        ),
        Fact(
            translate("RobotWords", "Pivot"),
            translate("RobotWords", "stays within {mm:.2f} mm").format(mm=max(plan.pivot_error_m * MM, 0.01)),
            translate(
                "RobotWords",
                "How far the point of the rim about which the cup turns wanders meanwhile; from the plan",
            ),
            is_wide=True,
        ),
    ]


def state_facts(status: ArmStatus, stop_line: bool) -> list[Fact]:
    """Return how the arm is, as its controller says."""
    state = status.state
    grip = {None: "--", True: translate("RobotWords", "closed"), False: translate("RobotWords", "open")}[
        status.is_gripper_closed
    ]
    return [
        Fact(
            translate("RobotWords", "Arm"),
            state.robot_mode.words if state is not None else translate("RobotWords", "does not answer"),
            translate(
                "RobotWords",
                "The robot mode that the controller reports; 'running' means power on, brakes released",
            ),
        ),
        Fact(
            translate("RobotWords", "Safety"),
            state.safety_mode.words if state is not None else "--",
            translate("RobotWords", "The safety mode that the controller reports"),
        ),
        Fact(
            translate("RobotWords", "Speed"),
            translate("RobotWords", "{percent:.0f} %").format(percent=100 * state.speed_scaling)
            if state is not None
            else "--",
            translate(
                "RobotWords",
                "What the speed slider at the panel makes of all speeds, as the controller reports it",
            ),
        ),
        Fact(
            translate("RobotWords", "Gripper"),
            grip,
            translate("RobotWords", "As read back from the tool's output"),
        ),
        Fact(
            translate("RobotWords", "STOP"),
            translate("RobotWords", "own line open")
            if stop_line
            else translate("RobotWords", "by the arm's process"),
            translate(
                "RobotWords",
                "Which way STOP takes besides the arm's process. A software stop, not safety-rated.",
            ),
        ),
    ]


def progress_words(progress: MoveProgress, n_moves: int) -> str:
    """Say which move is under way and how long it will take to the end."""
    return translate("RobotWords", "Move {k} of {n}, about {left} left").format(
        k=progress.index + 1, n=n_moves, left=minutes_words(progress.left_s)
    )


def checks(cup: Cup) -> list[tuple[str, str, str]]:
    """Return what somebody has to see to before the arm moves, as (name, words, more words)."""
    if cup.n_cups == 1:
        said = translate("RobotWords", "Cup at its station, {n} candies in it")
    else:
        said = translate("RobotWords", "Cup {k} of {cups} at its station, {n} candies in it")
    return [
        (
            "cup",
            said.format(n=cup.n_candies, k=cup.number, cups=cup.n_cups),
            translate("RobotWords", "As many candies as were imagined, and the cup upright on its mark"),
        ),
        (
            "area",
            translate("RobotWords", "Nobody in the arm's reach"),
            translate("RobotWords", "And nothing stands there that the cell's file does not know"),
        ),
        (
            "speed",
            translate("RobotWords", "Speed slider where I want it"),
            translate("RobotWords", "At the robot's panel; below 100 % everything takes longer"),
        ),
        (
            "stop",
            translate("RobotWords", "Emergency stop within my reach"),
            translate(
                "RobotWords", "The red STOP of this window is a software stop and no substitute for it"
            ),
        ),
    ]
