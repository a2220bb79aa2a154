"""Why ur_rtde could not connect to a controller, in words for people."""

from __future__ import annotations

from hardware.errors import DeviceError, NotInRemoteControl, RobotNotReady, RobotUnreachable


def refused_connection(error: RuntimeError, address: str) -> DeviceError:
    """Return the error that ur_rtde's own message (1.6.5) stands for, with what to do."""
    message = str(error)
    if "remote control" in message:
        return NotInRemoteControl(
            f"The controller at {address} is in local control; choose remote control at the top right of its "
            "panel, then recover the robot."
        )
    if "in use" in message or "variables" in message:
        return RobotNotReady(
            f"Another program drives the arm at {address} already; end it, then recover the robot."
        )
    if "control script" in message:
        return RobotNotReady(
            f"The control program does not start on the controller at {address}; see what its panel shows, "
            "then recover the robot."
        )
    return RobotUnreachable(
        f"The controller at {address} broke off ({message}); check the network cable, then try again."
    )
