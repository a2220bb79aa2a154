"""A Robotiq gripper: 2F-85, 2F-140 or Hand-E, by its own socket protocol."""

from __future__ import annotations

import time
from dataclasses import dataclass

from hardware.errors import GripperError
from hardware.grippers.robotiq_line import (
    HIGHEST,
    Contact,
    RobotiqAddress,
    RobotiqLine,
    refuse_faulty,
)
from hardware.robots.ur.robot import UR5Robot

_ARRIVES_WITHIN_S = 8.0
_POLL_S = 0.01
_BEGINS_S = 0.1
"""So soon after a command its status tells of that command."""


@dataclass(frozen=True)
class RobotiqModel:
    """How far a gripper opens, by its manual; counts between are taken as evenly spaced.

    Attributes:
        stroke_m: from closed to open.
        open_count, closed_count: its position register there, without special fingertips.
    """

    stroke_m: float
    open_count: int
    closed_count: int

    def width_m(self, count: int) -> float:
        """Return the width between the fingers at a count of its position register."""
        share = (self.closed_count - count) / (self.closed_count - self.open_count)
        return min(max(share, 0.0), 1.0) * self.stroke_m


MODELS = {
    "2F-85": RobotiqModel(0.085, 3, 230),
    "2F-140": RobotiqModel(0.140, 3, 230),
    "Hand-E": RobotiqModel(0.050, 0, 255),
}


@dataclass(frozen=True)
class Grip:
    """How it opens and closes.

    Attributes:
        open_m, closed_m: width between the fingers.
        force, speed: shares of what it can, 0 to 1.
    """

    open_m: float
    closed_m: float
    force: float
    speed: float


class RobotiqGripper:
    """Opens and closes to widths, and tells whether it holds something.

    While it does, the arm's driver watches that it goes on doing so, in its own process.

    Attributes:
        name: model and address.
    """

    def __init__(self, robot: UR5Robot, address: RobotiqAddress, model: str, grip: Grip) -> None:
        """Know what to connect to; entering connects.

        Args:
            robot: must be entered before the gripper is.
            address: where it is served.
            model: one of `MODELS`.
            grip: how it opens and closes.
        """
        self.name = f"Robotiq {model} at {address}"
        self._robot, self._address, self._model, self._grip = robot, address, MODELS[model], grip
        self._line: RobotiqLine | None = None

    def __enter__(self) -> RobotiqGripper:
        """Connect; nothing moves.

        Raises:
            GripperError: nobody answers, it reports a fault, or it is not activated.
        """
        line = RobotiqLine(self._address)
        try:
            refuse_faulty(line, self._address)
        except BaseException:
            line.close()
            raise
        self._line = line
        return self

    def __exit__(self, *exception: object) -> None:
        """It stays as it is: opening it here would drop what it holds."""
        if self._line is not None:
            self._line.close()
            self._line = None

    @property
    def is_closed(self) -> bool:
        """Whether it was last commanded to close, as it echoes the command.

        Raises:
            GripperError: it does not answer.
        """
        asked, opened = self._connected().get("PRE"), self._count(self._grip.open_m)
        return asked > (opened + self._count(self._grip.closed_m)) / 2

    @property
    def is_holding(self) -> bool:
        """Whether its fingers met something while they closed, and still press on it.

        Raises:
            GripperError: it does not answer.
        """
        return self._connected().get("OBJ") == Contact.WHILE_CLOSING

    @property
    def width_m(self) -> float:
        """Between its fingers, as its position tells.

        Raises:
            GripperError: it does not answer.
        """
        return self._model.width_m(self._connected().get("POS"))

    def close(self) -> None:
        """Close it and return when its fingers stand; what they hold is watched from then on.

        Raises:
            GripperError: it does not answer, does not move, or reports a fault.
            RobotError: the arm cannot be reached.
        """
        self._go(self._grip.closed_m)
        self._robot.set_held(self.is_holding)

    def open(self) -> None:
        """Open it and return when its fingers stand.

        Raises:
            GripperError, RobotError: as with `close`; also where the fingers met something.
        """
        self._robot.set_held(False)  # before: what is let go is not lost
        if self._go(self._grip.open_m) is Contact.WHILE_OPENING:
            raise GripperError(
                f"The {self.name} met something when it opened, and stands at {self.width_m * 1000:.0f} mm; "
                "see what blocks its fingers."
            )

    def _go(self, width_m: float) -> Contact:
        line, count = self._connected(), self._count(width_m)
        force, speed = (round(share * HIGHEST) for share in (self._grip.force, self._grip.speed))
        line.set(GTO=1, SPE=speed, FOR=force, POS=count)
        began_s = time.monotonic()
        time.sleep(_BEGINS_S)
        while (contact := line.get("OBJ")) == Contact.MOVING or line.get("PRE") != count:
            if time.monotonic() - began_s > _ARRIVES_WITHIN_S:
                raise GripperError(
                    f"The {self.name} does not come to rest; see to its power and what blocks its fingers."
                )
            time.sleep(_POLL_S)
        refuse_faulty(line, self._address)
        return Contact(contact) if contact in set(Contact) else Contact.MOVING

    def _count(self, width_m: float) -> int:
        model = self._model
        share = 1 - min(width_m / model.stroke_m, 1.0)
        return round(model.open_count + share * (model.closed_count - model.open_count))

    def _connected(self) -> RobotiqLine:
        """The line; opened anew where it was lost, as after a recovery."""
        if self._line is None:
            raise GripperError(f"The {self.name} is not connected; connect the arm.")
        if self._line.is_closed:
            self._line = RobotiqLine(self._address)
        return self._line
