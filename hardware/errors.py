"""What can go wrong with a device, by kind, so that a caller can decide whether trying again makes sense."""

from core.errors import PoursightError


class DeviceError(PoursightError):
    """A device cannot do what was requested."""


class DriverMissing(DeviceError):
    """A device's driver is not installed; the sentence names what to install."""


class CameraError(DeviceError):
    """The camera gave no usable image this time; another try may succeed."""


class CameraLost(CameraError):
    """The camera is not there (any more): it has to be connected again."""


class RobotError(DeviceError):
    """The robot cannot do what was requested."""


class RobotUnreachable(RobotError):
    """Nobody answers at the robot's address, or something that is not a UR controller."""


class RobotLost(RobotError):
    """The link to the robot was there and is lost; what the arm does now is not known."""


class WrongRobot(RobotError):
    """The arm is not the one that the cell file names: its kinematics differ."""


class NotInRemoteControl(RobotError):
    """The controller is in local control: only its own panel moves the arm."""


class RobotNotReady(RobotError):
    """Power is off, brakes hold, or the safety system does not let the arm move."""


class MoveRefused(RobotError):
    """The controller did not take the move."""


class RobotStopped(RobotError):
    """The robot was stopped before it arrived; it rests somewhere between start and target."""


class ProtectiveStop(RobotStopped):
    """The controller stopped the arm, for example because it touched something."""


class EmergencyStop(RobotStopped):
    """Somebody pressed an emergency stop."""


class ProgramStopped(RobotStopped):
    """The control program on the robot was stopped or paused."""


class OutputChanged(RobotStopped):
    """An output of the tool changed while the arm moved: the gripper may have let go."""


class TrackingLost(RobotStopped):
    """The arm was not where it should have been and was stopped."""


class GripperError(RobotError):
    """The gripper does not answer, reports a fault, or does not do what it was asked for."""


class ObjectLost(RobotStopped):
    """The gripper holds nothing (any more) where it should hold the cup."""
