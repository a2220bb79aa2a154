"""A Robotiq gripper on the simulated controller, and the server of its URCap.

Source: as `hardware.grippers.robotiq_line`. Between the fingers stands something of a width, which stops them
when they close; faults let it slip, and let the server or the gripper go wrong.
"""

from __future__ import annotations

import re

from hardware.grippers.robotiq import MODELS, RobotiqModel
from hardware.grippers.robotiq_line import ACTIVE, HIGHEST, Contact
from hardware.simulation.ur_controller.journal import Journal
from hardware.simulation.ur_controller.link import LineLink, Network

_FASTEST_S = 0.6
"""From open to closed at full speed; at the lowest it takes some times as long."""
_SLOWEST = 0.13
_ACTIVATING = 1
_ACTIVATING_S = 1.0
_NEEDS_ACTIVATION = 7
_WRITTEN = ("ACT", "GTO", "ATR", "SPE", "FOR", "POS")
OBJECT_M = 0.03
"""How wide the hand finds what it closes on; a Hand-E opens to 0.05 m."""


class RobotiqHand:
    """The gripper itself, moved by the controller's clock.

    Attributes:
        object_m: width of what stands between the fingers; none: nothing does.
        fault: the fault register.
        is_silent: a fault: nothing is answered.
        is_senseless: a fault: something else is answered.
    """

    def __init__(self, name: str) -> None:
        """Be activated and open, as it is after a day's first use."""
        self.object_m: float | None = OBJECT_M
        self.fault = 0
        self.is_silent = self.is_senseless = False
        self._model: RobotiqModel = MODELS[name]
        self._written = dict.fromkeys(_WRITTEN, 0) | {"ACT": 1, "GTO": 1, "SPE": HIGHEST, "FOR": HIGHEST}
        self._status = ACTIVE
        self._activated_in_s = 0.0
        self._position = float(self._model.open_count)
        self._written["POS"] = self._model.open_count
        self._contact = Contact.NONE

    def step(self, dt_s: float) -> None:
        """One cycle of the controller."""
        if self._status == _ACTIVATING:
            self._activated_in_s -= dt_s
            if self._activated_in_s <= 0:
                self._status = ACTIVE
        if self._status != ACTIVE or not self._written["GTO"]:
            return
        span = self._model.closed_count - self._model.open_count
        share = max(self._written["SPE"] / HIGHEST, _SLOWEST)
        most = span / _FASTEST_S * share * dt_s
        away = self._aim() - self._position
        self._position += max(-most, min(most, away))
        if abs(self._aim() - self._position) > 1e-9:
            self._contact = Contact.MOVING
        elif abs(self._asked() - self._position) < 1:
            self._contact = Contact.NONE
        else:
            self._contact = Contact.WHILE_CLOSING

    def deactivate(self) -> None:
        """Be as after a loss of power; the fingers stay where they are."""
        self._status, self._written["ACT"] = 0, 0
        self._contact = Contact.MOVING

    def set(self, name: str, value: int) -> bool:
        """Write a register; False if there is none such."""
        if name not in _WRITTEN or not 0 <= value <= HIGHEST:
            return False
        if name == "ACT" and value != self._written["ACT"]:
            self._status, self._activated_in_s = (_ACTIVATING, _ACTIVATING_S) if value else (0, 0.0)
            self.fault = 0
        self._written[name] = value
        if name == "POS":
            self._contact = Contact.MOVING
        return True

    def get(self, name: str) -> int | None:
        """Read a register; none if there is none such."""
        read = {
            "STA": self._status,
            "OBJ": int(self._contact),
            "POS": round(self._position),
            "PRE": self._written["POS"],
            "FLT": self.fault or (0 if self._status == ACTIVE else _NEEDS_ACTIVATION),
        }
        return read.get(name, self._written.get(name))

    def _asked(self) -> float:
        return float(min(max(self._written["POS"], self._model.open_count), self._model.closed_count))

    def _aim(self) -> float:
        """Where the fingers go: no further than what is between them, if they close."""
        asked = self._asked()
        if self.object_m is None or asked < self._position:
            return asked
        model = self._model
        share = 1 - min(self.object_m / model.stroke_m, 1.0)
        blocked = model.open_count + share * (model.closed_count - model.open_count)
        return min(asked, max(blocked, self._position))


class RobotiqLink(LineLink):
    """One client of the URCap's server."""

    name = "robotiq"

    def __init__(self, network: Network, hand: RobotiqHand, journal: Journal) -> None:
        """Wait for lines."""
        super().__init__(network, journal)
        self._hand = hand

    def line_received(self, line: str) -> None:
        """Do it and answer: an acknowledgement has no end of line."""
        if self._hand.is_silent:
            return
        if self._hand.is_senseless:
            self.send(b"?\n")
            return
        words = line.split()
        if words[:1] == ["GET"] and len(words) == 2 and (value := self._hand.get(words[1])) is not None:
            self.send(f"{words[1]} {value}\n".encode())
        elif words[:1] == ["SET"] and len(words) > 2 and self._set(words[1:]):
            self._journal.note("robotiq", line=line)
            self.send(b"ack")
        else:
            self.send(b"?\n")

    def _set(self, words: list[str]) -> bool:
        pairs = list(zip(words[::2], words[1::2], strict=False))
        are_numbers = all(re.fullmatch(r"\d{1,3}", value) for _, value in pairs)
        return (
            len(words) % 2 == 0
            and are_numbers
            and all(self._hand.set(name, int(value)) for name, value in pairs)
        )
