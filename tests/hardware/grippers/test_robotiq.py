"""A Robotiq gripper in the hand of the real driver's arm: what it holds is watched while the arm moves."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from hardware.errors import GripperError, ObjectLost, RobotError
from hardware.grippers.robotiq import MODELS, Grip, RobotiqGripper
from hardware.grippers.robotiq_line import RobotiqAddress
from hardware.interfaces import ReadyStep
from hardware.simulation.ur_controller.process import ControllerProcess
from hardware.simulation.ur_controller.robotiq import OBJECT_M
from tests.awake import AwakeClock
from tests.hardware.robots.ur.bench import HOME, Bench, bent_way, driver
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

STANDS_WITHIN_S = 0.3
COUNT_M = 0.001


@pytest.fixture(scope="module", params=["2F-85", "Hand-E"])
def model(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def lasting(model: str) -> Iterator[tuple[Bench, RobotiqGripper]]:
    with ControllerProcess(joints_rad=HOME, robotiq=model) as controller:
        address = RobotiqAddress(controller.address)
        with driver(controller.address, robotiq=address, cup_kg=0.3) as robot:
            grip = Grip(MODELS[model].stroke_m, 0.0, 0.2, 1.0)
            with RobotiqGripper(robot, address, model, grip) as gripper:
                yield Bench(controller, robot), gripper


@pytest.fixture
def hand(lasting: tuple[Bench, RobotiqGripper]) -> tuple[Bench, RobotiqGripper]:
    """Open, sound, with something to close on, and the arm at home."""
    bench, gripper = lasting
    bench.controller.command("hand sane")
    bench.controller.command("hand full")
    if bench.robot.stopped_by() is not None:
        bench.robot.recover()
    bench.put_in_order()
    gripper.open()
    return bench, gripper


def test_it_opens_and_closes_and_tells_what_it_holds(hand: tuple[Bench, RobotiqGripper], model: str) -> None:
    bench, gripper = hand
    assert (gripper.is_closed, gripper.is_holding) == (False, False)
    assert gripper.width_m == pytest.approx(MODELS[model].stroke_m, abs=COUNT_M)
    gripper.close()
    assert (gripper.is_closed, gripper.is_holding) == (True, True)
    assert gripper.width_m == pytest.approx(OBJECT_M, abs=COUNT_M)
    assert bench.truth()["payload_kg"] == pytest.approx(1.2)
    gripper.open()
    assert bench.truth()["payload_kg"] == pytest.approx(0.9)
    bench.controller.command("hand empty")
    gripper.close()
    assert (gripper.is_closed, gripper.is_holding) == (True, False)
    assert gripper.width_m == pytest.approx(0.0, abs=COUNT_M)
    assert bench.truth()["payload_kg"] == pytest.approx(0.9)


@pytest.mark.parametrize(
    ("fault", "error", "said"),
    [
        ("hand empty", ObjectLost, "holds nothing any more"),
        ("hand silent", GripperError, "does not answer"),
        ("hand senseless", GripperError, "is no Robotiq gripper"),
        ("hand off", ObjectLost, "holds nothing any more"),
    ],
)
def test_what_is_lost_on_the_way_stops_the_arm(
    hand: tuple[Bench, RobotiqGripper], fault: str, error: type[RobotError], said: str
) -> None:
    bench, gripper = hand
    gripper.close()
    move = bench.begin("follow")
    with AwakeClock() as clock:
        began_s = clock.now_s()
        bench.controller.command(fault)
        with pytest.raises(error, match=said):
            move.wait(HANG_S)
        wait_until(lambda: not bench.is_moving())
        # a gripper that is silent is so after the 0.25 s that an answer may take
        assert clock.now_s() - began_s < STANDS_WITHIN_S + (0.25 if fault == "hand silent" else 0.0)
    assert bench.stays_where_it_is()
    bench.controller.command("hand sane")
    if fault == "hand off":
        bench.robot.take_step(ReadyStep.ACTIVATE_GRIPPER)
    bench.works_again()


def test_a_link_that_is_lost_for_a_moment_stops_the_arm_and_is_opened_again(
    hand: tuple[Bench, RobotiqGripper],
) -> None:
    bench, gripper = hand
    gripper.close()
    move = bench.begin("follow")
    bench.controller.command("drop robotiq")
    with pytest.raises(GripperError, match="does not answer"):
        move.wait(HANG_S)
    bench.works_again()
    with pytest.raises(GripperError):
        _ = gripper.is_holding  # its own connection was dropped, too
    assert gripper.is_holding


def test_what_is_lost_at_rest_is_said_before_the_next_move(hand: tuple[Bench, RobotiqGripper]) -> None:
    bench, gripper = hand
    gripper.close()
    bench.robot.follow(bent_way(0.8)).wait(HANG_S)
    bench.controller.command("hand empty")
    wait_until(lambda: not gripper.is_holding)
    here = bench.joints()

    def refused() -> bool:
        try:
            bench.robot.move_joints([here, here], 1.0, 1.0).wait(HANG_S)
        except ObjectLost:
            return True
        return False

    wait_until(refused)
    assert bench.stays_where_it_is()
    bench.works_again()


def test_an_empty_hand_may_move_and_an_opened_one_has_lost_nothing(
    hand: tuple[Bench, RobotiqGripper],
) -> None:
    bench, gripper = hand
    gripper.close()
    gripper.open()
    bench.controller.command("hand empty")
    gripper.close()
    bench.robot.follow(bent_way(0.8)).wait(HANG_S)
    assert bench.robot.stopped_by() is None


def test_a_driver_that_is_started_with_the_cup_in_the_hand_watches_it(
    hand: tuple[Bench, RobotiqGripper],
) -> None:
    bench, gripper = hand
    gripper.close()
    bench.robot.recover()
    assert bench.truth()["payload_kg"] == pytest.approx(1.2)
    move = bench.begin("follow")
    bench.controller.command("hand empty")
    with pytest.raises(ObjectLost):
        move.wait(HANG_S)
    bench.works_again()


def test_activation_is_a_step_of_connecting_that_is_asked_about() -> None:
    with ControllerProcess(joints_rad=HOME, robotiq="2F-140", faults=["hand off"]) as controller:
        address = RobotiqAddress(controller.address)
        with driver(controller.address, robotiq=address) as robot:
            gripper = RobotiqGripper(robot, address, "2F-140", Grip(0.14, 0.0, 0.2, 1.0))
            with pytest.raises(GripperError, match="not activated"):
                gripper.__enter__()
        pending = robot.pending_step()
        assert pending is not None
        assert pending[0] is ReadyStep.ACTIVATE_GRIPPER
        assert "nothing must be in the hand" in pending[1]
        robot.take_step(ReadyStep.ACTIVATE_GRIPPER)
        assert robot.pending_step() is None
        with robot, gripper:
            gripper.close()
            assert gripper.is_holding


def test_a_controller_without_such_a_gripper_is_said() -> None:
    with ControllerProcess(joints_rad=HOME) as controller:
        robot = driver(controller.address, robotiq=RobotiqAddress(controller.address))
        with pytest.raises(GripperError, match="Nobody serves a Robotiq gripper"):
            robot.__enter__()
