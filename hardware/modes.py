"""What a UR controller reports of itself, and whether an arm in these modes may be commanded.

The numbers are those of its data interface (RTDE).
"""

from __future__ import annotations

from enum import IntEnum

from hardware.errors import EmergencyStop, ProtectiveStop, RobotError, RobotNotReady


class RobotMode(IntEnum):
    """How far the arm is switched on."""

    NO_CONTROLLER = -1
    DISCONNECTED = 0
    CONFIRM_SAFETY = 1
    BOOTING = 2
    POWER_OFF = 3
    POWER_ON = 4
    IDLE = 5
    BACKDRIVE = 6
    RUNNING = 7
    UPDATING_FIRMWARE = 8

    @property
    def words(self) -> str:
        """For people."""
        return self.name.lower().replace("_", " ")


class SafetyMode(IntEnum):
    """Whether the safety system lets the arm move."""

    NORMAL = 1
    REDUCED = 2
    PROTECTIVE_STOP = 3
    RECOVERY = 4
    SAFEGUARD_STOP = 5
    SYSTEM_EMERGENCY_STOP = 6
    ROBOT_EMERGENCY_STOP = 7
    VIOLATION = 8
    FAULT = 9
    VALIDATE_JOINT_ID = 10
    UNDEFINED = 11

    @property
    def is_emergency(self) -> bool:
        """Whether an emergency stop is pressed."""
        return self in (SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP)

    @property
    def may_move(self) -> bool:
        """Whether the arm may move in it."""
        return self in (SafetyMode.NORMAL, SafetyMode.REDUCED)

    @property
    def words(self) -> str:
        """For people."""
        return self.name.lower().replace("_", " ")


def unreadiness(safety: SafetyMode, mode: RobotMode) -> RobotError | None:
    """What prevents motion, in the safety system or the arm's power; none if nothing does."""
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
            f"The safety system is in '{safety.words}' and does not let the arm move; clear that at the "
            "robot's panel, then recover the robot."
        )
    if mode is not RobotMode.RUNNING:
        return RobotNotReady(
            f"The arm is in '{mode.words}', so its brakes hold or its power is off; recover the robot to "
            "switch it on, when nobody is near."
        )
    return None
