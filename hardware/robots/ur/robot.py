"""The real arm, behind the robot interface."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import radians
from threading import Lock
from typing import Any

import numpy.typing as npt

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from hardware.errors import RobotError, RobotLost, RobotStopped
from hardware.grippers.robotiq_line import RobotiqAddress
from hardware.interfaces import Kinematics, ReadyStep, RobotState
from hardware.modes import unreadiness
from hardware.robots.joint_motion import checked_path
from hardware.robots.ur.asking import (
    end_program_after,
    end_stopped_program,
    refuse_beyond_safety,
    stop_program,
    switch_tool_output,
)
from hardware.robots.ur.checks import (
    raise_if,
    refuse_local_control,
    refuse_other_kinematics,
    refuse_other_model,
)
from hardware.robots.ur.dashboard import Dashboard, make_ready
from hardware.robots.ur.glance import Glance, glance
from hardware.robots.ur.joint_limits import JointLimits, read_joint_limits
from hardware.robots.ur.link import UrMove, WorkerLink
from hardware.robots.ur.messages import Ended, Setup, robot_state
from hardware.robots.ur.own_kinematics import read_kinematics
from hardware.robots.ur.pose_vectors import vector_from_pose
from hardware.robots.ur.probe import probe
from hardware.robots.ur.readying import (
    RESTING_RAD_S,
    Tool,
    next_step,
    refuse_busy,
    refuse_foreign_program,
    refuse_other_arm,
    refuse_power_supply,
    refuse_taken,
    supply_tool,
    take_step,
)

STOP_ANSWER_S = 0.1
"""A driver that has not answered to a stop after this time is not waited for: the dashboard stops the arm."""
_CYCLE_S = 1 / 125
"""A CB3's; an e-Series could do 500 a second, but what is streamed has one target every 8 ms."""
_RESTS_WITHIN_S, _RELEASED_WITHIN_S = 0.3, 0.5

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Connection:
    dashboard: Dashboard
    worker: WorkerLink


class UR5Robot:
    """A UR5 or UR5e with a CB3 or e-Series controller, driven through ur_rtde in a worker process.

    A software stop is not a safety-rated one: the emergency stop is the button on the panel.

    Attributes:
        name: model and address, or as given.
        controller_version: of the controller's software, such as (3, 15); empty before it was connected.
        kinematics: of the arm that was connected last, or looked at; as published before.
        joint_limits: on the controller that was connected last, or looked at; none: it told none.
        robotiq: where a gripper is served whose grip is watched; none: there is none.
    """

    def __init__(
        self,
        arm: ArmModel,
        address: str,
        T_flange_tool: FloatArray,
        payload_kg: float,
        payload_center_m: Sequence[float],
        tool_voltage_v: int | None = None,
        tolerance_m: float = 0.005,
        tolerance_rad: float = radians(1),
        name: str | None = None,
        cup_kg: float = 0.0,
        robotiq: RobotiqAddress | None = None,
    ) -> None:
        """Know what to connect to; entering connects.

        Args:
            arm: the model that the cell file names.
            address: the controller's, an IP address or a host's name.
            T_flange_tool: (4, 4) the tool frame that is set on the controller.
            payload_kg: mass at the flange, set on the controller.
            payload_center_m: (3,) its centre in the flange's frame.
            tool_voltage_v: supply of the tool connector to be set; none: as set on the panel.
            tolerance_m: how far the reported tool may be from where the model's kinematics put it.
            tolerance_rad: how far it may be turned.
            name: what people call it; model and address without one.
            cup_kg: of the payload; not there as long as the hand is empty.
            robotiq: see above.
        """
        self.name = name or f"{arm.name} at {address}"
        self.controller_version: tuple[int, ...] = ()
        self._arm = arm
        self.kinematics = Kinematics(arm)
        self.joint_limits: JointLimits | None = None
        self._T_flange_tool = T_flange_tool
        self.robotiq = robotiq
        self._tool = Tool(tool_voltage_v, (tolerance_m, tolerance_rad), robotiq)
        self._address = address
        self._payload_kg = (float(payload_kg - cup_kg), float(payload_kg))
        self._payload_center_m = [float(x) for x in payload_center_m]
        self._connection: _Connection | None = None
        self._move: UrMove | None = None
        self._refusal: RobotError | None = None
        self._command_lock = Lock()

    def __enter__(self) -> UR5Robot:
        """Connect, and check that it is the arm of the cell file and that it is ready.

        Raises:
            RobotUnreachable: nobody answers, or somebody else; known within 5 s.
            WrongRobot: it is another arm.
            NotInRemoteControl: only its panel moves it.
            RobotNotReady: its power is off, its brakes hold, or another program drives it.
            RobotError: a protective or emergency stop holds it.
        """
        with self._command_lock:
            self._refusal = None
            self.kinematics = Kinematics(self._arm)
            self._connect()
        return self

    def __exit__(self, *exception: object) -> None:
        """Stop what moves; leave no process and no thread."""
        if self._move is not None and not self._move.is_done:
            with suppress(RobotError):
                self.stop()
        with self._command_lock:
            self._disconnect()

    def state(self) -> RobotState:
        """Return the newest state.

        Raises:
            RobotLost: it is older than `link.LOST_S`, or the robot is not connected.
        """
        return robot_state(self._connected().worker.state(), self.kinematics.model)

    def move_joints(self, path_rad: npt.ArrayLike, speed_rad_s: float, acceleration_rad_s2: float) -> UrMove:
        """Start to move through joint configurations (N, 6), the first being where the arm is.

        Raises:
            RobotError: the path is not one, the arm is elsewhere, moving or not ready, was stopped and not
                recovered, or cannot be reached.
        """
        path = checked_path(self._arm, self.name, path_rad)
        return self._start("move_joints", path, float(speed_rad_s), float(acceleration_rad_s2), start=path[0])

    def follow(self, trajectory: JointTrajectory, margin: PathMargin | None = None) -> UrMove:
        """Start to follow a timed motion of the joints, at the pace of the controller's clock.

        The driver stops an arm that leaves its path by more than the margin, or by 0.02 rad without one.

        Raises:
            RobotError: as with `move_joints`.
        """
        checked_path(self._arm, self.name, trajectory.joints_rad)
        return self._start("follow", trajectory, margin, start=trajectory.start_rad)

    def stop(self) -> None:
        """Stop what moves and refuse further moves until `recover`; returns when the arm is at rest.

        Works from any thread. A driver that does not answer within `STOP_ANSWER_S`, or an arm that does not
        come to rest, is stopped through the dashboard, and a warning in the log says so.

        Raises:
            RobotLost: no connection to the controller is left.
        """
        stopped = RobotStopped(f"The {self.name} was stopped; see that all is well, then recover the robot.")
        self._refusal = self._refusal or stopped
        connection = self._connected()
        try:
            connection.worker.ask("stop", within_s=STOP_ANSWER_S)
            if connection.worker.comes_to_rest(_RESTS_WITHIN_S, RESTING_RAD_S):
                return
            why = "it did not come to rest"
        except RobotError as error:
            why = str(error)
        _log.warning("The %s was stopped through its dashboard: %s", self.name, why)
        try:
            stop_program(connection.dashboard, connection.worker.is_lost)
        except RobotLost as error:
            raise RobotLost(
                f"The {self.name} cannot be reached for a stop ({error}); press the emergency stop if "
                "it moves."
            ) from error
        if self._move is not None:
            self._move.end(stopped)

    def stopped_by(self) -> RobotError | None:
        """What stopped it for good, moving or at rest, until it is recovered; none if nothing did."""
        return self._refusal

    def look(self) -> Glance:
        """Look without writing anything to the controller, and check that it is the arm of the cell file.

        Raises:
            RobotError: it is not there, another one, or in local control.
        """
        probe(self._address)
        with Dashboard(self._address) as dashboard:
            seen = self._look(dashboard)
            self.controller_version = dashboard.version()
        return seen

    def pending_step(self) -> tuple[ReadyStep, str] | None:
        """What has to be done before it can be connected, and why; none if that is nothing or not known."""
        with suppress(RobotError), Dashboard(self._address) as dashboard:
            return next_step(dashboard, self._look(dashboard), self._tool, self.name)
        return None

    def take_step(self, step: ReadyStep) -> None:
        """Do that; the arm follows no path.

        Raises:
            RobotError: it could not be done; the sentence says what a person has to do.
        """
        with Dashboard(self._address) as dashboard:
            take_step(dashboard, step, self._tool, self.name)

    def recover(self) -> None:
        """Bring the robot back to where it takes moves, with a new worker; nothing goes on.

        Raises:
            EmergencyStop: it is still pressed.
            NotInRemoteControl: only its panel moves it.
            RobotError: something else has to be done by a person first; the sentence says what.
        """
        with self._command_lock:
            if self._connection is not None and self._refusal is None:
                end_stopped_program(self._connection.worker, self._connection.dashboard, self.name)
            self._disconnect()
            was_lost = isinstance(self._refusal, RobotLost)
            # Not later: a stop that comes meanwhile has to be recovered from anew. Not earlier: the old
            # worker's last message may come until it is gone.
            self._refusal = None
            probe(self._address)
            with Dashboard(self._address) as dashboard:
                refuse_local_control(dashboard, self.name)
                refuse_foreign_program(
                    dashboard, self.name, lambda: was_lost and not glance(self._address).is_moving
                )
                make_ready(dashboard, self.name)
            self._connect()

    def set_tool_output(self, output: int, value: bool) -> None:
        """Set a digital output of the tool (0 or 1) and see that it is set.

        Raises:
            RobotError: it does not change, or the robot cannot be reached.
        """
        switch_tool_output(self._connected().worker, self.name, output, value)

    def set_held(self, is_held: bool) -> None:
        """Tell the controller whether the hand carries the cup, as far as its mass is known; watch the grip.

        Raises:
            RobotError: the controller does not take it.
        """
        self._connected().worker.ask("watch_held", is_held)
        if self._payload_kg[0] != self._payload_kg[1]:
            self._connected().worker.ask("set_payload", self._payload_kg[is_held])

    def refuse_unsafe(self, trajectory: JointTrajectory, label: str) -> None:
        """Refuse a motion that the controller's configuration or its safety system does not allow.

        Raises:
            RobotError: one does not, or does not answer.
        """
        T_base_tool = flange_pose(self.kinematics.model, trajectory.joints_rad) @ self._T_flange_tool
        worker, limits, tool_m = self._connected().worker, self.joint_limits, T_base_tool[:, :3, 3]
        refuse_beyond_safety(worker, limits, self.name, trajectory, label, tool_m)

    def _connect(self) -> None:
        probe(self._address)
        dashboard = Dashboard(self._address)
        try:
            seen = self._look(dashboard)
            if not seen.has_free_inputs:
                # those of the worker before are given back when the controller hears that it has gone
                time.sleep(_RELEASED_WITHIN_S)
                seen = self._look(dashboard)
            raise_if(unreadiness(seen.safety_mode, seen.robot_mode))
            refuse_taken(dashboard, seen, self.name)
            supply_tool(self._address, seen, self._tool, self.name)  # until here nothing was written
            self.controller_version = dashboard.version()
            is_held = self._tool.holds(seen)
            setup = Setup(
                self._address,
                vector_from_pose(self._T_flange_tool).tolist(),
                self._payload_kg[is_held],
                self._payload_center_m,
                _CYCLE_S,
                self._tool.robotiq,
                is_held,
            )
            worker = WorkerLink(setup, self._on_ended, self._on_lost)
            try:
                raw = worker.state()
                reported, T_tool = (raw["joints_rad"], raw["tool_pose"]), self._T_flange_tool
                refuse_other_kinematics(*reported, self.kinematics.model, T_tool, self._tool.tolerances)
            except BaseException:
                worker.end()
                raise
        except BaseException:
            dashboard.close()
            raise
        self._move = None
        self._connection = _Connection(dashboard, worker)

    def _look(self, dashboard: Dashboard) -> Glance:
        refuse_local_control(dashboard, self.name)
        refuse_other_model(dashboard, self._arm, self.name)
        if not self.kinematics.checksum:
            self.kinematics = read_kinematics(self._address, self._arm)
        self.joint_limits = read_joint_limits(self._address)
        seen = glance(self._address)
        refuse_other_arm(seen, self.kinematics.model, self._tool)
        refuse_power_supply(seen, self._tool, self.name)
        return seen

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        if connection is not None:
            connection.worker.end()
            connection.dashboard.close()
        if self._move is not None:
            self._move.end(RobotStopped(f"The {self.name} was let go; plan its motion anew."))

    def _connected(self) -> _Connection:
        if self._connection is None:
            raise RobotLost(f"The {self.name} is not connected; recover the robot.")
        return self._connection

    def _start(self, request: str, *arguments: Any, start: FloatArray) -> UrMove:
        """Hand a motion to the worker if the arm is ready and at rest where it begins."""
        with self._command_lock:
            worker = self._connected().worker
            if self._refusal is not None:
                raise self._refusal
            is_moving = self._move is not None and not self._move.is_done
            refuse_busy(worker.state(), start, is_moving, self.name)
            move = self._move = UrMove(self.name, worker.progress, self.stop)
            try:
                worker.ask(request, *arguments)
            except RobotError as error:
                move.end(error)
                raise self._refusal or error from error
            return move

    def _on_ended(self, ended: Ended) -> None:
        """A move is over. One that went wrong takes the control program with it, lest anything goes on."""
        move, error = self._move, ended.error
        if error is not None and type(error) is not RobotStopped:
            error = self._end_program(error)
        self._refusal = self._refusal or error
        if move is not None:
            move.end(error, ended.progress)

    def _on_lost(self, error: RobotLost) -> None:
        self._refusal = error
        if self._move is not None:
            self._move.end(error)
        self._end_program(error)

    def _end_program(self, error: RobotError) -> RobotError:
        connection = self._connection
        return error if connection is None else end_program_after(error, connection.dashboard, self.name)
