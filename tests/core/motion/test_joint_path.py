import numpy as np
import pytest

from core.errors import MotionError
from core.motion.arm_models import UR5, arm_shape
from core.motion.clearance import MotionScene, axis_aligned_obstacle
from core.motion.joint_path import RouteSettings, check_path, find_route, sample_move

LEFT_RAD, RIGHT_RAD = np.radians([[-40.0, -50, 60, -100, -90, 0], [40, -50, 60, -100, -90, 0]])
RAISED_RAD = np.radians([[-40.0, -110, 30, -100, -90, 0], [40, -110, 30, -100, -90, 0]])
CLEARANCE_M = 0.02


def walled() -> MotionScene:
    wall = axis_aligned_obstacle("wall", (-1.2, -0.22, 0.0), (-0.40, -0.12, 0.5))
    return MotionScene(UR5, arm_shape(UR5), [wall])


def test_samples_are_at_most_a_degree_apart_and_hold_both_ends():
    samples = sample_move(LEFT_RAD, RIGHT_RAD)
    assert np.degrees(np.abs(np.diff(samples, axis=0)).max()) <= 1 + 1e-9
    assert np.array_equal(samples[[0, -1]], [LEFT_RAD, RIGHT_RAD])


def test_wall_between_is_found_and_named():
    check = check_path(walled(), [LEFT_RAD, RIGHT_RAD], CLEARANCE_M)
    assert check.problem is not None
    assert check.problem.distance_m < CLEARANCE_M
    assert check.problem.between[1] == "wall"
    assert check.problem.segment == 0
    assert 0 < check.problem.share < 1
    assert check.clearance_m < CLEARANCE_M


def test_clear_path_has_its_clearance():
    scene = MotionScene(UR5, arm_shape(UR5), [])
    samples = sample_move(LEFT_RAD, RIGHT_RAD)
    check = check_path(scene, [LEFT_RAD, RIGHT_RAD], CLEARANCE_M)
    assert check.is_clear
    assert check.clearance_m == scene.clearance(samples).distance_m.min()


def test_joint_beyond_its_limit_is_named_with_its_position():
    beyond = LEFT_RAD.copy()
    beyond[2] = np.radians(361)
    scene = MotionScene(UR5, arm_shape(UR5), [])
    problem = check_path(scene, [LEFT_RAD, beyond], -1.0).problem
    assert problem is not None
    assert problem.distance_m is None
    assert problem.between[0] == "elbow"
    assert problem.share > 0.99
    assert "elbow joint is beyond its limit" in str(problem)


def test_straight_route_where_nothing_is_in_the_way():
    route = find_route(MotionScene(UR5, arm_shape(UR5), []), LEFT_RAD, RIGHT_RAD)
    assert np.array_equal(route, [LEFT_RAD, RIGHT_RAD])


def test_known_via_points_help_over_the_wall():
    settings = RouteSettings(via_rad=tuple(map(tuple, RAISED_RAD)), time_limit_s=0)
    route = find_route(walled(), LEFT_RAD, RIGHT_RAD, settings)
    known = {via.tobytes() for via in RAISED_RAD}
    assert np.array_equal(route[[0, -1]], [LEFT_RAD, RIGHT_RAD])
    assert {via.tobytes() for via in route[1:-1]} <= known
    assert check_path(walled(), route, CLEARANCE_M).is_clear


def test_search_finds_a_clear_path_over_the_wall_and_the_same_again():
    scene, settings = walled(), RouteSettings(time_limit_s=10)
    routes = [find_route(scene, LEFT_RAD, RIGHT_RAD, settings) for _ in range(2)]
    assert np.array_equal(*routes)
    assert np.array_equal(routes[0][[0, -1]], [LEFT_RAD, RIGHT_RAD])
    assert check_path(scene, routes[0], CLEARANCE_M).is_clear


def test_start_in_the_wall_is_refused_in_a_sentence():
    inside = np.radians([12.0, -20, 40, -100, -90, 0])
    with pytest.raises(MotionError, match=r"start of the move.*wall.*choose another"):
        find_route(walled(), inside, RIGHT_RAD)


def test_no_path_in_time_is_a_sentence():
    with pytest.raises(MotionError, match=r"No clear path was found in 0 s .*wrist 1 and wall"):
        find_route(walled(), LEFT_RAD, RIGHT_RAD, RouteSettings(time_limit_s=0))
