"""What is done to make a stopped arm ready is in the log of its run, and what refused as well."""

from __future__ import annotations

import pytest

from core.session.pour_runs import PourRun
from hardware.errors import ProtectiveStop, RobotNotReady
from hardware.interfaces import ReadyStep
from hardware.pouring.recovering import LoggedRecovery
from hardware.pouring.run_log import RunLog


class Held:
    """Refuses both until it was unlocked at the second attempt."""

    def __init__(self) -> None:
        self.refusals = [ProtectiveStop("It does not unlock.")]
        self.is_ready = False

    def take_step(self, step):
        if self.refusals:
            raise self.refusals.pop()
        self.is_ready = True

    def recover(self):
        if not self.is_ready:
            raise RobotNotReady("It is in a protective stop.")


def test_each_step_and_each_refusal_is_written_down(tmp_path):
    with RunLog(tmp_path) as log:
        arm = LoggedRecovery(Held(), log)
        with pytest.raises(RobotNotReady):
            arm.recover()
        with pytest.raises(ProtectiveStop):
            arm.take_step(ReadyStep.UNLOCK)
        arm.take_step(ReadyStep.UNLOCK)
        arm.recover()
    events = PourRun.load(tmp_path).events
    assert [(event["kind"], event["sentence"], event.get("step")) for event in events] == [
        ("not ready", "It is in a protective stop.", None),
        ("step failed", "It does not unlock.", "UNLOCK"),
        ("step", "Confirmed and done: unlock the protective stop.", "UNLOCK"),
        ("recovered", "The arm was made ready again.", None),
    ]
