"""ur_rtde's own clients, each run in a process with a time limit: they can hang, and crash.

As a program: `python clients.py NAME ADDRESS [NUMBER]`; prints what the function returns, as JSON.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

LIMIT_S = 20.0


class Hung(Exception):
    """The client did not come back in time."""


class Crashed(Exception):
    """The client ended otherwise than by returning; what it complained of."""


_KEPT: list[object] = []
"""Clients whose link is lost end the process when they are destroyed."""


def run(name: str, address: str, *numbers: float, limit_s: float = LIMIT_S) -> Any:
    """Run one of the functions below against a controller and return what it returns."""
    process = subprocess.Popen(
        [sys.executable, __file__, name, address, *map(str, numbers)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    try:
        said, complaints = process.communicate(timeout=limit_s)
    except subprocess.TimeoutExpired as error:
        process.kill()
        process.communicate()
        raise Hung(name) from error
    if process.returncode != 0:
        raise Crashed(f"{process.returncode}: {complaints.decode()}")
    return json.loads(said.decode().splitlines()[-1])


def _control(address: str) -> Any:
    from rtde_control import RTDEControlInterface

    return _kept(RTDEControlInterface(address))


def _receive(address: str) -> Any:
    from rtde_receive import RTDEReceiveInterface

    return _kept(RTDEReceiveInterface(address))


def _io(address: str) -> Any:
    from rtde_io import RTDEIOInterface

    return _kept(RTDEIOInterface(address))


def _kept(client: Any) -> Any:
    _KEPT.append(client)
    return client


def _tell(address: str, *lines: str) -> None:
    import socket

    from hardware.simulation.ur_controller.identity import CONTROL_PORT

    with socket.create_connection((address, CONTROL_PORT), 5) as connection:
        for line in lines:
            connection.sendall(line.encode() + b"\n")
            answer = connection.recv(4096)
            assert answer == b"ok\n", answer


def _turned(joints: list[float], angle_rad: float) -> list[float]:
    return [joints[0] + angle_rad, *joints[1:]]


def _wait(is_so: Callable[[], bool], limit_s: float = 5.0) -> float:
    begin_s = time.monotonic()
    while not is_so() and time.monotonic() - begin_s < limit_s:
        time.sleep(0.002)
    return time.monotonic() - begin_s


def _error(make: Callable[[], object]) -> list[Any]:
    begin_s = time.monotonic()
    try:
        make()
    except Exception as error:
        return [str(error), time.monotonic() - begin_s]
    return ["", time.monotonic() - begin_s]


def moves(address: str, period_s: float) -> Any:
    """A move to its end, one that is stopped, following, and the tool's output."""
    control, receive, io = _control(address), _receive(address), _io(address)
    home = receive.getActualQ()
    begin_s = receive.getTimestamp()
    result: dict[str, Any] = {"is_taken": control.moveJ(_turned(home, 0.5), 1.0, 2.0, True)}
    _wait(lambda: control.getAsyncOperationProgress() < 0)
    result["move_s"] = receive.getTimestamp() - begin_s
    time.sleep(0.1)  # the receiver has a connection of its own, which may be a little behind
    result["reached"] = receive.getActualQ()[0] - home[0]
    control.moveJ(home, 1.0, 8.0, True)
    _wait(lambda: abs(receive.getActualQd()[0]) > 0.9)
    begin_s = receive.getTimestamp()
    control.stopJ(8.0)
    result["stop_s"] = receive.getTimestamp() - begin_s
    time.sleep(0.05)
    result["speed_after_stop"] = max(map(abs, receive.getActualQd()))
    target = receive.getActualQ()
    for _ in range(round(0.4 / period_s)):
        begin = control.initPeriod()
        target = _turned(target, 0.3 * period_s)
        control.servoJ(target, 0, 0, period_s, 0.05, 300)
        control.waitPeriod(begin)
    result["lag"] = target[0] - receive.getActualQ()[0]
    time.sleep(0.4)
    result["left"] = target[0] - receive.getActualQ()[0]
    control.servoStop()
    io.setToolDigitalOut(0, True)
    result["output_s"] = _wait(lambda: bool(receive.getActualDigitalOutputBits() >> 16 & 1))
    io.setToolDigitalOut(1, True)
    io.setToolDigitalOut(0, False)
    _wait(lambda: receive.getActualDigitalOutputBits() >> 16 == 2)
    result["outputs"] = receive.getActualDigitalOutputBits() >> 16
    result["slider"] = io.setSpeedSlider(0.4), _wait(lambda: receive.getTargetSpeedFraction() == 0.4)
    return result


def path(address: str) -> Any:
    """Three blended joint moves, asynchronous; joint speeds on the way."""
    control, receive = _control(address), _receive(address)
    joints, way = receive.getActualQ(), []
    for k, blend_m in enumerate([0.05, 0.05, 0.0]):
        joints = [joints[0] + 0.3, joints[1] + 0.1 * (-1) ** k, *joints[2:]]
        way.append([*joints, 1.5, 6.0, blend_m])
    is_taken = control.moveJ(way, True)
    _wait(receive.isConnected and (lambda: max(map(abs, receive.getActualQd())) > 0.3))
    speeds, steps = [], set()
    while (step := control.getAsyncOperationProgress()) >= 0:
        speeds.append(max(map(abs, receive.getActualQd())))
        steps.add(step)
        time.sleep(0.005)
    time.sleep(0.1)
    reached = max(abs(a - b) for a, b in zip(receive.getActualQ(), way[-1], strict=False))
    return {"is_taken": is_taken, "speeds": speeds, "steps": sorted(steps), "off_rad": reached}


def services(address: str) -> Any:
    """What the program answers."""
    control, receive = _control(address), _receive(address)
    pose = receive.getActualTCPPose()
    return {
        "set": control.setTcp([0, 0, 0.1, 0, 0, 0]),
        "tcp": control.getTCPOffset(),
        "pose": pose,
        "with_tool": _wait(lambda: receive.getActualTCPPose() != pose),
        "ik": [control.getInverseKinematics(receive.getActualTCPPose()), receive.getActualQ()],
        "within": control.isPoseWithinSafetyLimits(receive.getActualTCPPose()),
        "steady": control.isSteady(),
        "payload": control.setPayload(1.5, [0, 0, 0.05]),
        "trans": control.poseTrans([0.1, 0, 0, 0, 0, 1], [0.1, 0, 0, 0, 0, 1]),
        "impossible": control.getInverseKinematics([3, 0, 0, 0, 0, 0]),
        "runs_after": control.isProgramRunning(),
    }


def _interrupted(address: str, fault: str) -> Any:
    control, receive = _control(address), _receive(address)
    home = receive.getActualQ()
    _tell(address, f"when moving in 0.3 {fault}")
    begin_s = time.monotonic()
    result: dict[str, Any] = {"blocking": control.moveJ(_turned(home, 1.5), 1.0, 2.0)}
    result["took_s"] = time.monotonic() - begin_s
    time.sleep(0.4)
    result["again"] = control.moveJ(home, 1.0, 2.0)
    result |= {
        "at": receive.getActualQ()[0] - home[0],
        "safety_mode": receive.getSafetyMode(),
        "is_protective": receive.isProtectiveStopped(),
        "is_emergency": receive.isEmergencyStopped(),
        "runtime_state": receive.getRuntimeState(),
        "reupload": control.reuploadScript(),
    }
    _wait(control.isProgramRunning, 0.5)
    result["runs"] = control.isProgramRunning()
    result["after_reupload"] = control.moveJ(_turned(home, 0.1), 1.0, 2.0)
    return result


def protective_stop(address: str) -> Any:
    return _interrupted(address, "protective stop")


def emergency_stop(address: str) -> Any:
    return _interrupted(address, "emergency stop")


def program_stop(address: str) -> Any:
    return _interrupted(address, "program stop")


def program_pause(address: str) -> Any:
    return _interrupted(address, "program pause")


def goes_on(address: str) -> Any:
    """The danger: after a pause the call has returned False, and play lets its move go on."""
    from dashboard_client import DashboardClient

    control, receive = _control(address), _receive(address)
    home = receive.getActualQ()
    _tell(address, "when moving in 0.2 program pause")
    result = {"blocking": control.moveJ(_turned(home, 0.6), 1.0, 4.0)}
    time.sleep(0.4)
    result["paused_at"] = receive.getActualQ()[0] - home[0]
    dashboard = DashboardClient(address)
    dashboard.connect()
    dashboard.play()
    _wait(lambda: abs(receive.getActualQ()[0] - home[0] - 0.6) < 1e-6, 3)
    return result | {"ends_at": receive.getActualQ()[0] - home[0]}


def asynchronous_stop(address: str) -> Any:
    control, receive = _control(address), _receive(address)
    _tell(address, "when moving in 0.2 protective stop")
    control.moveJ(_turned(receive.getActualQ(), 1.5), 1.0, 2.0, True)
    _wait(receive.isProtectiveStopped)
    time.sleep(0.6)
    return [control.getAsyncOperationProgress(), max(map(abs, receive.getActualQd()))]


def starved(address: str) -> Any:
    control, receive = _control(address), _receive(address)
    control.setWatchdog(5)
    control.moveJ(_turned(receive.getActualQ(), 3.0), 0.5, 2.0, True)
    for _ in range(15):
        time.sleep(0.04)
        control.kickWatchdog()
    fed = control.isProgramRunning()
    return [fed, _wait(lambda: not control.isProgramRunning())]


def drop_receive(address: str) -> Any:
    receive = _receive(address)
    joints = receive.getActualQ()
    _tell(address, "link drop")
    return [_wait(lambda: not receive.isConnected()), receive.getActualQ() == joints]


def drop_io(address: str) -> Any:
    io = _io(address)
    _tell(address, "link drop")
    time.sleep(0.1)
    first = io.setToolDigitalOut(0, True)
    time.sleep(0.1)
    return [first, _error(lambda: io.setToolDigitalOut(0, True))[0]]


def drop_control(address: str) -> Any:
    _control(address)
    _tell(address, "link drop")
    time.sleep(LIMIT_S)
    return "nothing happened"


def silent_move(address: str) -> Any:
    control, receive = _control(address), _receive(address)
    _tell(address, "when moving in 0.2 link silent")
    control.moveJ(_turned(receive.getActualQ(), 0.5), 1.0, 2.0)
    return "returned"


def silent_receive(address: str) -> Any:
    receive = _receive(address)
    joints = receive.getActualQ()
    _tell(address, "link silent")
    return [_wait(lambda: not receive.isConnected()), receive.getActualQ() == joints]


def construct(address: str) -> Any:
    return _error(lambda: _control(address))


def construct_second(address: str) -> Any:
    first = _control(address)
    return [_error(lambda: _control(address)), first.isConnected()]


def round_trips(address: str) -> Any:
    """How long an answer takes, in the middle of several."""
    control = _control(address)
    times = sorted(_error(lambda: control.getTCPOffset())[1] for _ in range(9))
    return times[4]


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[4]))
    print(json.dumps(globals()[sys.argv[1]](sys.argv[2], *map(float, sys.argv[3:]))), flush=True)
    os._exit(0)  # the clients' destructors wait half a second each, or crash
