"""The arm's own kinematics from the controller's bytes, sound and damaged; and over a socket."""

from __future__ import annotations

import os
import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from random import Random

import numpy as np
import pytest

from core.errors import MotionError
from core.motion.arm_models import UR5, UR5E
from core.motion.factory_calibration import calibrated
from core.motion.kinematics import flange_pose
from hardware.robots.ur.joint_limits import read_joint_limits
from hardware.robots.ur.own_kinematics import read_kinematics
from hardware.robots.ur.primary_interface import (
    PRIMARY_PORT,
    ROBOT_STATE,
    DamagedPackage,
    configuration_of,
    kinematics_of,
    next_package,
    receive_kinematics,
)
from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.identity import identity
from hardware.simulation.ur_controller.primary_server import (
    configuration_data,
    kinematics_info,
    robot_state,
    version_message,
)
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.awake import within
from tests.fuzz.mutation import damaged_bytes

ADDRESS = f"127.84.{os.getpid() % 256}.7"
JOINTS = np.array([0.2, -1.6, 1.4, -1.5, -1.5, 0.1])
THETA, A = (0.01, -0.9, 7.1, 0.07, 0.0, 0.0), UR5.a_m
D, ALPHA = (0.09, 303.4, -309.8, 6.5, 0.0946, 0.0823), UR5.alpha_rad
CHECKSUMS = (0xC0FFEE, 2, 3, 4, 5, 0xFFFFFFFF)


def package(kind: int, content: bytes) -> bytes:
    return struct.pack(">iB", len(content) + 5, kind) + content


def info(a_m: tuple[float, ...] = A) -> bytes:
    """The sub-package, byte by byte as the protocol has it."""
    numbers = b"".join(struct.pack(">6d", *row) for row in (THETA, a_m, D, ALPHA))
    return package(5, struct.pack(">6I", *CHECKSUMS) + numbers + struct.pack(">I", 0))


def test_the_kinematics_are_found_among_other_parts() -> None:
    assert len(info()) == 0xE1, "as a real one is"
    state = package(16, package(0, bytes(42)) + info() + package(9, b""))
    kind, content, rest = next_package(package(20, b"hello") + state + b"begin of another")  # type: ignore[misc]
    assert (kind, content) == (20, b"hello")
    kind, content, rest = next_package(rest)  # type: ignore[misc]
    assert (kind, rest) == (16, b"begin of another")
    found = kinematics_of(content)
    assert found is not None
    assert (found.theta_rad, found.a_m, found.d_m, found.alpha_rad) == (THETA, A, D, ALPHA)
    assert found.checksum == CHECKSUMS


def test_a_state_without_them_and_a_package_that_is_not_whole() -> None:
    assert kinematics_of(package(0, bytes(42)) + package(7, b"")) is None
    whole = package(16, info())
    assert all(next_package(whole[:n]) is None for n in range(len(whole)))


@pytest.mark.parametrize("size", [0, 4, -1, -(1 << 31), 1 << 20, (1 << 31) - 1])
def test_a_length_that_no_package_has_is_refused(size: int) -> None:
    with pytest.raises(DamagedPackage, match=f"a package of {size} bytes"):
        next_package(struct.pack(">iB", size, 16) + bytes(100))


@pytest.mark.parametrize("size", [5, 100, 1 << 10])
def test_a_part_with_a_wrong_length_is_refused(size: int) -> None:
    with pytest.raises(DamagedPackage):
        kinematics_of(struct.pack(">i", size) + info()[4:])


def test_parts_that_are_cut_off_are_refused() -> None:
    for n in range(1, len(info())):
        with pytest.raises(DamagedPackage, match="cut off"):
            kinematics_of(info()[:n])
    with pytest.raises(DamagedPackage, match="kinematics are cut off"):
        kinematics_of(package(5, info()[5:-9]))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_numbers_that_are_none_are_refused(value: float) -> None:
    with pytest.raises(DamagedPackage, match="no number"):
        kinematics_of(info((*A[:5], value)))


@pytest.mark.filterwarnings("error")
def test_damaged_bytes_are_refused_or_close_to_what_was_sent() -> None:
    sound = version_message(identity("UR5", "3.15")) + robot_state(
        package(0, bytes(42)), configuration_data(Arm(UR5, JOINTS)), kinematics_info(UR5)
    )
    for seed in range(2000):
        pick = Random(seed)
        rest = damaged_bytes(sound, pick)
        with suppress(DamagedPackage, MotionError):
            while (found := next_package(rest)) is not None:
                kind, content, rest = found
                if kind == ROBOT_STATE:
                    configuration_of(content)
                measured = kinematics_of(content) if kind == ROBOT_STATE else None
                if measured is not None:
                    apart = flange_pose(calibrated(UR5, measured), JOINTS) - flange_pose(UR5, JOINTS)
                    assert np.abs(apart).max() < 0.4, f"seed {seed}"


def test_the_simulated_controller_serves_them_as_real_ones_do() -> None:
    kind, content, rest = next_package(version_message(identity("UR5e", "5.11")))  # type: ignore[misc]
    assert (kind, rest) == (20, b"")
    assert content[8:].startswith(b"\xfe\x03\x09URControl\x05\x0b")
    kind, content, _ = next_package(robot_state(kinematics_info(UR5E)))  # type: ignore[misc]
    found = kinematics_of(content)
    assert found is not None
    assert (found.a_m, found.d_m, found.alpha_rad) == (UR5E.a_m, UR5E.d_m, UR5E.alpha_rad)
    assert set(found.checksum) == {0xFFFFFFFF}, "as an arm that was never calibrated"


def test_what_is_configured_is_found_among_other_parts() -> None:
    arm = Arm(UR5, JOINTS)
    arm.safe_rad[:, 2], arm.safe_speeds_rad_s[2] = (-2.5, 2.0), 1.5
    data = configuration_data(arm)
    assert len(data) == 445, "as a real one is"
    found = configuration_of(package(0, bytes(42)) + kinematics_info(UR5) + data)
    assert found is not None
    assert (found[4:6], found[16]) == ((-2.5, 2.0), 1.5)
    assert configuration_of(kinematics_info(UR5)) is None
    with pytest.raises(DamagedPackage, match="cut off"):
        configuration_of(package(6, data[5:-1]))


@pytest.mark.parametrize(
    "numbers", [(float("nan"),) * 24, (1.0, -1.0) * 12, (-1.0, 1.0) * 6 + (0.0, 1.0) * 6]
)
def test_limits_that_cannot_be_are_none(numbers: tuple[float, ...]) -> None:
    data = package(6, struct.pack(">53d4i", *numbers, *(0.0,) * 29, 0, 0, 0, 0))
    with serving(robot_state(data), then_silent=True):
        assert read_joint_limits(ADDRESS) is None
    with serving(robot_state(configuration_data(Arm(UR5, JOINTS))), then_silent=True):
        assert read_joint_limits(ADDRESS) is not None


@contextmanager
def serving(*parts: bytes, then_silent: bool = False) -> Iterator[None]:
    """Somebody on the primary port who sends these, then closes or keeps silent."""
    over = threading.Event()

    def serve(listener: socket.socket) -> None:
        with suppress(OSError):
            line, _ = listener.accept()
            with line:
                for part in parts:
                    line.sendall(part)
                if then_silent:
                    over.wait(10)

    with socket.create_server((ADDRESS, PRIMARY_PORT)) as listener:
        thread = threading.Thread(target=serve, args=(listener,), daemon=True)
        thread.start()
        try:
            yield
        finally:
            over.set()
            listener.shutdown(socket.SHUT_RDWR)
            thread.join(10)


def test_packages_that_come_in_pieces_are_put_together() -> None:
    stream = version_message(identity("UR5", "3.15")) + package(16, package(0, b"")) + package(16, info())
    pieces = [stream[k : k + 7] for k in range(0, len(stream), 7)]
    with serving(*pieces, then_silent=True):
        assert receive_kinematics(ADDRESS).checksum == CHECKSUMS


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        ([], "closed the connection"),
        ([b"220 mail.example.org ESMTP: say hello first\r\n"], "announces a package of"),
        ([package(16, info())[:100]], "closed the connection"),
        ([package(16, info()[:60])], "cut off"),
        ([package(16, info((float("nan"),) * 6))], "no number"),
        ([robot_state(kinematics_info(UR5E))], "differ by up to 73 mm"),
    ],
)
def test_what_is_damaged_or_implausible_leaves_the_published_ones(parts: list[bytes], why: str) -> None:
    with serving(*parts):
        kinematics = read_kinematics(ADDRESS, UR5)
    assert kinematics.model is UR5
    assert kinematics.checksum == ""
    assert why in kinematics.caution
    assert "1 to 3 mm" in kinematics.caution


def test_silence_and_nobody_leave_the_published_ones_soon() -> None:
    with within(2), serving(package(20, b""), then_silent=True):
        assert read_kinematics(ADDRESS, UR5).model is UR5
    with within(2):
        assert "refused" in read_kinematics(ADDRESS, UR5).caution


@pytest.mark.parametrize("version", ["3.15", "5.11"])
def test_a_controllers_own_kinematics_are_its_arms(version: str) -> None:
    with ControllerProcess(version=version, faults=["calibration 4.5"]) as controller:
        kinematics = read_kinematics(controller.address, UR5)
    assert kinematics.caution == ""
    assert len(kinematics.checksum.split("-")) == 6
    off_m = (flange_pose(kinematics.model, JOINTS) - flange_pose(UR5, JOINTS))[:3, 3]
    assert np.linalg.norm(off_m) == pytest.approx(0.0045)
