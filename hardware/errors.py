"""What can go wrong with a device, by kind, so that a caller can decide whether trying again makes sense."""

from core.errors import PoursightError


class DeviceError(PoursightError):
    """A device cannot do what it was asked to."""


class DriverMissing(DeviceError):
    """A device's driver is not installed; the sentence names what to install."""


class CameraError(DeviceError):
    """The camera gave no usable image this time; another try may succeed."""


class CameraLost(CameraError):
    """The camera is not there (any more): it has to be connected again."""


class RobotError(DeviceError):
    """The robot cannot do what it was asked to."""


class RobotStopped(RobotError):
    """The robot was stopped on its way; it stands somewhere between start and target."""
