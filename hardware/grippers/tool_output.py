"""A gripper that a digital output of the arm's tool opens and closes."""

from __future__ import annotations

import time

from hardware.robots.ur.robot import UR5Robot


class ToolOutputGripper:
    """Closed while its output is on; whether it holds anything is not reported.

    Attributes:
        name: says which output.
    """

    def __init__(self, robot: UR5Robot, output: int, action_s: float) -> None:
        """Use an output of a robot's tool.

        Args:
            robot: must be entered before the gripper is used.
            output: tool digital output (0 or 1) that closes it.
            action_s: time it takes to open or close.
        """
        self.name = f"gripper at tool output {output}"
        self._robot = robot
        self._output = output
        self._action_s = action_s

    def __enter__(self) -> ToolOutputGripper:
        return self

    def __exit__(self, *exception: object) -> None:
        """It stays as it is: opening it here would drop what it holds."""

    @property
    def is_closed(self) -> bool:
        """Whether its output is on, as the controller reports it.

        Raises:
            RobotLost: it reports nothing.
        """
        return self._robot.state().tool_outputs[self._output]

    @property
    def width_m(self) -> None:
        """Not known."""

    @property
    def is_holding(self) -> None:
        """It reports nothing of that."""

    def close(self) -> None:
        """Close it and return when it had the time to.

        Raises:
            RobotError: the output does not change, or the robot cannot be reached.
        """
        self._set(True)

    def open(self) -> None:
        """Open it and return when it had the time to.

        Raises:
            RobotError: as with `close`.
        """
        self._set(False)

    def _set(self, value: bool) -> None:
        self._robot.set_tool_output(self._output, value)
        time.sleep(self._action_s)
        self._robot.set_held(value)
