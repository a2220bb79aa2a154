"""The worker process: the only place that knows ur_rtde, whose faults end this process and no other.

Measured with ur_rtde 1.6.5: constructors against a silent server hang for ever and hold the interpreter's
lock, destructors after a lost link crash, blocking moves cannot be stopped, and two threads that call one
control object get each other's answers. So here one thread makes all control calls, all of them asynchronous,
another one reads states, the process ends without destructors, and its parent ends it when it is silent.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from threading import Event, Lock, Thread
from typing import NoReturn

import numpy as np
import rtde_control
import rtde_io
import rtde_receive

from core.geometry import AnyArray, FloatArray
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from hardware.errors import (
    MoveRefused,
    ProgramStopped,
    RobotError,
    RobotStopped,
    TrackingLost,
)
from hardware.realtime import take_precedence
from hardware.robots.ur.checks import deviation, moved_at_rest, output_changed, raise_if, unsafe
from hardware.robots.ur.connecting import refused_connection
from hardware.robots.ur.heartbeat import Heartbeat
from hardware.robots.ur.held_object import HeldObject
from hardware.robots.ur.messages import (
    RUNTIME_PLAYING,
    Connected,
    Ended,
    Pulse,
    Reply,
    Request,
    Setup,
    Started,
    StateMailbox,
    tool_outputs,
)
from hardware.robots.ur.motions import RESTING_RAD_S, Following, JointMoves, Motion, UsualLag, joints_at_rest
from hardware.robots.ur.polling import PollingThreads
from hardware.robots.ur.reading import RECEIVED, read_state

_HANGS_S = 12
"""Later than the parent, which ends a worker that does not connect in time; this is for when it is gone."""
WATCHDOG_HZ = 3.5
"""Without a word for this time's inverse the controller ends the program, and the arm brakes to rest."""
_KICK_S = 0.04
_IDLE_S = 0.01
_STANDING_S = 0.02
"""How often both threads look around while the arm stands."""
_CALM_S = 1.0
"""An arm that has stood for this long, and of which nothing was asked, is watched with less haste, ..."""
_STARVED_S, _BUSY_S = 0.06, 3.0
"""... unless states fail to come because the machine is busy; then not for this long."""
_BRAKE_WITHIN_S = 0.12
_BRAKE_LIMITS_RAD_S2 = 5.0, 30.0
_REASON_S = 0.06
"""The safety system's word may come some cycles after the program has ended because of it."""
_LONGEST_REASON_S = 0.3
"""An arm whose power was switched off says so when its brakes have brought it to rest."""
_TAKEN_S = 1.0
_SAME = 1e-4
_HEARD_S = 0.2
"""The thread that makes the control calls loops within milliseconds; after this time it is stuck, ..."""
_HANDSHAKE_S = 2.0
"""... but for calls that wait for the controller's answers, over a slow link, or for the arm's rest."""


def serve(connection: Connection, setup: Setup, mailbox: StateMailbox, pulse: Pulse) -> NoReturn:
    """Connect, report it to the parent, and do what it requests until it requests the end or is gone."""
    # A constructor that hangs keeps Python from running at all; this signal ends the process all the same.
    signal.alarm(_HANGS_S)
    take_precedence()
    connection.send(Started())
    try:
        worker = _Worker(setup, connection, mailbox, pulse)
    except RobotError as error:
        connection.send(Connected(error))
        os._exit(1)
    signal.alarm(0)
    connection.send(Connected(None))
    try:
        worker.run()
    finally:
        os._exit(0)


class _Worker:
    """One thread reads states, the other one, in `run`, makes all control calls."""

    def __init__(self, setup: Setup, connection: Connection, mailbox: StateMailbox, pulse: Pulse) -> None:
        self._connection = connection
        self._sending = Lock()
        self._mailbox = mailbox
        self._cycle_s = setup.cycle_s
        self._payload_center_m = setup.payload_center_m
        self._motion: Motion | None = None
        self._lag = UsualLag()
        self._rest_rad: FloatArray | None = None
        self._outputs = (False, False)
        self._switched: set[int] = set()
        self._is_over = False
        self._refusal = "The arm was stopped; recover the robot first."
        self._program = Heartbeat(pulse, os.getppid())
        self._held = None if setup.robotiq is None else HeldObject(setup.robotiq)
        self._ask_watch_held(setup.is_held)
        self._due_s = float("inf")
        self._fresh = Event()
        self._kicked_s = 0.0
        self._polling = PollingThreads()
        self._polling.hasten(_CALM_S)
        rate_hz = 1 / self._cycle_s
        try:
            with self._polling.starting():
                self._receive = rtde_receive.RTDEReceiveInterface(setup.address, rate_hz, list(RECEIVED))
            self._latest = read_state(self._receive)
            raise_if(unsafe(self._latest))
            with self._polling.starting():
                self._control = rtde_control.RTDEControlInterface(setup.address, rate_hz)
            self._io = rtde_io.RTDEIOInterface(setup.address)
            self._set_up(setup)
        except RuntimeError as error:
            raise refused_connection(error, setup.address) from error

    def run(self) -> NoReturn:
        """Serve requests and move, until the parent is gone."""
        Thread(target=self._publish, daemon=True).start()
        while True:
            self._due_s = time.monotonic() + _HEARD_S
            is_fresh = self._wait()
            self._listen_for_program()
            while self._connection.poll():
                request = self._connection.recv()
                self._polling.hasten(_CALM_S)
                self._due_s = time.monotonic() + _HANDSHAKE_S
                self._serve(request)
                self._due_s = time.monotonic() + _HEARD_S
            if is_fresh and self._motion is not None:
                self._polling.hasten(_CALM_S)
                self._step(self._motion)
            if self._motion is None:
                self._polling.slacken()
            self._kick()

    def _wait(self) -> bool:
        """Until there may be something to do; whether a new state is it."""
        if self._motion is None:
            self._connection.poll(_STANDING_S)
            return False
        is_fresh = self._fresh.wait(_IDLE_S)
        self._fresh.clear()
        return is_fresh

    def _listen_for_program(self) -> None:
        """A program that stood still does not go on: somebody has to look at the arm first."""
        problem = self._program.problem()
        if not problem or self._is_over:
            return
        self._is_over = True
        self._refusal = (
            f"{problem}, so the arm was stopped; see that all is well, then recover the robot and plan anew."
        )
        motion, self._motion = self._motion, None
        if motion is not None:
            self._brake(motion)
            self._send(Ended(RobotStopped(self._refusal), motion.progress))

    def _set_up(self, setup: Setup) -> None:
        """Set tool and payload, and read them back: what the controller takes for granted must be ours."""
        if (
            not self._control.setTcp(setup.tool)
            or np.abs(np.subtract(self._control.getTCPOffset(), setup.tool)).max() > _SAME
        ):
            raise MoveRefused(
                "The controller did not take the tool's pose; see what its panel shows, then recover the "
                "robot."
            )
        self._ask_set_payload(setup.payload_kg)
        self._control.setWatchdog(WATCHDOG_HZ)

    def _ask_set_payload(self, payload_kg: float) -> None:
        """Tell the controller what the flange carries, and read it back."""
        if not self._control.setPayload(payload_kg, self._payload_center_m):
            raise MoveRefused(
                f"The controller did not take the payload of {payload_kg:g} kg; see what its panel shows, "
                "then recover the robot."
            )
        deadline_s = time.monotonic() + _TAKEN_S
        while abs(self._receive.getPayload() - payload_kg) > _SAME:
            if time.monotonic() > deadline_s:
                raise MoveRefused(
                    f"The controller reports a payload of {self._receive.getPayload():g} kg in place of "
                    f"{payload_kg:g} kg; see what its panel shows, then recover the robot."
                )
            time.sleep(_IDLE_S)

    def _ask_are_safe(self, joints_rad: FloatArray) -> None:
        for row in joints_rad:
            if not self._control.isJointsWithinSafetyLimits(row.tolist()):
                raise MoveRefused("The safety limits on the controller do not allow it.")

    def _serve(self, request: Request) -> None:
        if request.name in ("stop", "end"):
            self._stop(request)
            return
        error: RobotError | None = None
        try:
            getattr(self, f"_ask_{request.name}")(*request.arguments)
        except RobotError as refused:
            error = refused
        except RuntimeError as failed:
            error = MoveRefused(f"The controller did not take it ({failed}); recover the robot.")
        self._send(Reply(request.number, error))

    def _ask_move_joints(self, path_rad: FloatArray, speed_rad_s: float, acceleration_rad_s2: float) -> None:
        self._begin(JointMoves(self._control, path_rad, speed_rad_s, acceleration_rad_s2))

    def _ask_follow(self, trajectory: JointTrajectory, margin: PathMargin | None) -> None:
        self._begin(Following(self._control, trajectory, self._cycle_s, margin, self._lag))

    def _ask_set_tool_output(self, output: int, value: bool) -> None:
        if not self._io.setToolDigitalOut(output, value):
            raise MoveRefused(f"The controller did not take tool output {output}; recover the robot.")
        self._outputs = (value, self._outputs[1]) if output == 0 else (self._outputs[0], value)
        self._switched.add(output)

    def _ask_watch_held(self, is_held: bool) -> None:
        if self._held is not None:
            self._held.watch(is_held)

    def _begin(self, motion: Motion) -> None:
        if self._is_over:
            raise MoveRefused(self._refusal)
        if self._motion is not None:
            raise MoveRefused("The arm is still moving; stop it or wait until it stops.")
        self._outputs = tool_outputs(self._latest)
        self._switched.clear()
        raise_if(self._lost_object())
        self._motion, self._rest_rad = motion, None
        self._fresh.clear()  # what was seen before it began does not pace it

    def _stop(self, request: Request) -> None:
        """Stop for good: only a new worker moves again, so no request in flight can begin a move later."""
        self._is_over = True
        self._send(Reply(request.number, None))
        motion, self._motion = self._motion, None
        if motion is not None:
            self._brake(motion)
            stopped = RobotStopped("The arm was stopped before it arrived; plan its motion anew.")
            self._send(Ended(stopped, motion.progress))
        if request.name == "end":
            self._control.stopScript()
            os._exit(0)

    def _step(self, motion: Motion) -> None:
        """Go on with the motion; whatever is wrong with it ends it."""
        error: RobotError | None = None
        if not motion.is_streaming or motion.progress >= 1:
            self._due_s = time.monotonic() + _HANDSHAKE_S
        try:
            raise_if(self._lost_object())
            self._watch_outputs()
            raw = self._latest
            is_done = motion.step(raw)
            if motion.is_streaming:
                self._kicked_s = time.monotonic()
            if not is_done:
                return
            # From this state on: the arm may be pushed before the next one is read.
            self._rest_rad = joints_at_rest(raw)
        except RobotError as wrong:
            error = wrong
        except RuntimeError as failed:
            error = MoveRefused(f"The controller refused ({failed}); recover the robot and plan anew.")
        self._motion = None
        if error is not None:
            self._is_over = True
            if isinstance(error, TrackingLost):
                # It may be that another program has the arm, which would not hear us: the parent ends it.
                error = unsafe(self._latest) or error
            else:
                self._brake(motion)
                error = self._reason(error, self._kick)
        self._send(Ended(error, motion.progress))

    def _watch_rest(self, raw: AnyArray) -> None:
        """Between two motions nothing moves, and the control program is ours: it runs without a break.

        The thread that reads watches: the other one may wait for a program that another one has replaced.
        """
        rest_rad = self._rest_rad  # the other thread may begin a motion, and forget it
        if rest_rad is None:
            rest_rad = self._rest_rad = joints_at_rest(raw)
        error = deviation(raw)
        if error is None and rest_rad is not None:
            error = moved_at_rest(raw["joints_rad"], rest_rad)
        if error is not None:
            self._is_over = True
            Thread(target=self._report_rest, args=(error,), daemon=True).start()

    def _report_rest(self, error: RobotError) -> None:
        self._send(Ended(self._reason(error), 0.0))

    def _lost_object(self) -> RobotError | None:
        return None if self._held is None else self._held.problem()

    def _watch_outputs(self) -> None:
        """What we switched ourselves is watched from the state on that shows it.

        Raises:
            OutputChanged: an output is not as it should be.
        """
        now = tool_outputs(self._latest)
        self._switched = {number for number in self._switched if now[number] != self._outputs[number]}
        before = tuple(
            now[number] if number in self._switched else self._outputs[number] for number in (0, 1)
        )
        raise_if(output_changed((before[0], before[1]), now))

    def _brake(self, motion: Motion) -> None:
        self._due_s = time.monotonic() + _HANDSHAKE_S
        fastest_rad_s = float(np.abs(self._latest["joint_speeds_rad_s"]).max())
        # The parent sees an arm that does not come to rest, and ends the program through the dashboard.
        with suppress(RuntimeError):
            motion.stop(float(np.clip(fastest_rad_s / _BRAKE_WITHIN_S, *_BRAKE_LIMITS_RAD_S2)))

    def _reason(self, error: RobotError, meanwhile: Callable[[], None] = lambda: None) -> RobotError:
        """The gravest thing to be seen just after something went wrong."""
        latest_s = time.monotonic() + _LONGEST_REASON_S
        deadline_s = time.monotonic() + _REASON_S
        while (now_s := time.monotonic()) < deadline_s:
            graver = unsafe(self._latest)
            if graver is not None:
                return graver
            also = deviation(self._latest)
            if isinstance(also, ProgramStopped):
                error = also
                if np.abs(self._latest["joint_speeds_rad_s"]).max() > RESTING_RAD_S:
                    deadline_s = min(now_s + _REASON_S, latest_s)
            meanwhile()
            time.sleep(_IDLE_S)
        return error

    def _kick(self) -> None:
        """Signal the controller that we are there; a stopped program does not listen."""
        now_s = time.monotonic()
        if now_s - self._kicked_s > _KICK_S and int(self._latest["runtime_state"]) == RUNTIME_PLAYING:
            self._kicked_s = now_s
            self._control.kickWatchdog()

    def _send(self, message: Reply | Ended) -> None:
        with self._sending:
            self._connection.send(message)

    def _publish(self) -> None:
        """Pass every state on; when there are none any more, their age shows it to the parent."""
        while True:
            if self._polling.are_slack:
                time.sleep(_STANDING_S)
            if self._receive.getTimestamp() == self._latest["controller_s"]:
                if time.monotonic() - self._latest["time_s"] > _STARVED_S:
                    self._polling.hasten(_BUSY_S)
                time.sleep(self._cycle_s / 4)
                continue
            raw = read_state(self._receive)
            raw["progress"] = 0.0 if self._motion is None else self._motion.progress
            raw["due_s"] = self._due_s
            self._latest = raw
            self._mailbox.write(raw)
            if self._motion is None and not self._is_over:
                self._watch_rest(raw)
            self._fresh.set()
