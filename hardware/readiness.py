"""Whether an arm may be commanded, by what its controller reports: one judgement for all who watch it."""

from __future__ import annotations

from hardware.errors import EmergencyStop, ProtectiveStop, RobotError, RobotNotReady
from hardware.modes import RobotMode, SafetyMode


def unreadiness(safety: SafetyMode, mode: RobotMode) -> RobotError | None:
    """What of the safety system or of the arm's power stands in the way of motion; none if nothing does."""
    if safety.is_emergency:
        return EmergencyStop(
            "An emergency stop is pressed; see that all is safe, release it and recover the robot."
        )
    if safety is SafetyMode.PROTECTIVE_STOP:
        return ProtectiveStop(
            "The controller made a protective stop; see what the arm touched or what was too fast for it, "
            "then recover the robot."
        )
    if not safety.may_move:
        return RobotNotReady(
            f"The safety system is in '{safety.words}' and lets the arm not move; put that right at the "
            "robot's panel, then recover the robot."
        )
    if mode is not RobotMode.RUNNING:
        return RobotNotReady(
            f"The arm is in '{mode.words}', so its brakes hold or its power is off; recover the robot to "
            "switch it on, when nobody is near."
        )
    return None
