import numpy as np
import pytest

from core.geometry import transform_points
from core.motion.arm_models import UR5
from core.motion.joint_path import check_path
from core.motion.kinematics import flange_pose, singularity_measure, within_limits
from core.motion.view_tour import ViewNet, plan_tour
from core.motion.views import (
    Dome,
    ReachableView,
    choose_spread_views,
    coverage,
    dome_directions,
    reachable_views,
)
from tests.core.motion.cell import HOME_RAD, T_FLANGE_CAMERA, TASK, simulated_cell

DOME = Dome(tuple(range(30, 91, 15)), tuple(range(-180, 180, 30)), (0.55, 0.7), (-90, 0, 90))


@pytest.fixture(scope="module")
def views() -> tuple[ReachableView, ...]:
    return reachable_views(simulated_cell(), TASK, DOME)


def test_views_are_where_they_say_and_look_at_the_target(views):
    assert len(views) > 50
    joints = np.array([view.joints_rad for view in views])
    poses = np.array([view.T_base_camera for view in views])
    assert flange_pose(UR5, joints) @ T_FLANGE_CAMERA == pytest.approx(poses, abs=1e-6)
    for view in views:
        ahead = view.T_base_camera @ [0, 0, view.distance_m, 1]
        assert ahead[:3] == pytest.approx(TASK.target_m, abs=1e-9)
        assert np.degrees(np.arcsin(view.direction[2])) == pytest.approx(view.elevation_deg, abs=1e-6)


def test_views_are_clear_within_limits_and_not_singular(views):
    joints = np.array([view.joints_rad for view in views])
    assert simulated_cell().clearance(joints).distance_m.min() >= TASK.min_clearance_m
    assert within_limits(UR5, joints).all()
    assert singularity_measure(UR5, joints).min() >= TASK.min_singularity


def test_best_view_first(views):
    qualities = [view.quality for view in views]
    assert qualities == sorted(qualities, reverse=True)


def test_seen_share_counts_points_in_the_image_beyond_the_least_range(views):
    points = np.random.default_rng(0).uniform(TASK.box_min_m, TASK.box_max_m, (4000, 3))
    for view in (views[0], views[-1]):
        x, y, z = transform_points(np.linalg.inv(view.T_base_camera), points).T
        half_x, half_y = np.tan(np.radians(TASK.field_of_view_deg) / 2)
        seen = (np.abs(x / z) < half_x) & (np.abs(y / z) < half_y) & (z > TASK.min_range_m)
        assert view.seen_share == pytest.approx(seen.mean(), abs=0.04)


def test_coverage_of_one_view_and_of_many():
    cap = (1 - np.cos(np.radians(25))) / (1 - np.sin(np.radians(20)))
    assert coverage(np.array([[0.0, 0, 1]])) == pytest.approx(cap, abs=0.005)
    assert coverage(dome_directions(60, 20)) == 1


def test_choice_covers_more_than_the_best_views_alone_and_holds_a_steep_one(views):
    chosen = choose_spread_views(views, 12)
    directions = np.array([view.direction for view in chosen])
    first = np.array([view.direction for view in views[:12]])
    assert len({view.joints_rad.tobytes() for view in chosen}) == 12
    assert coverage(directions) > coverage(first) + 0.2
    assert max(view.elevation_deg for view in chosen) >= 75


def test_no_views_no_choice():
    assert choose_spread_views((), 3) == ()


def test_tour_takes_every_direction_once_on_clear_paths(views):
    the_scene = simulated_cell()
    net = ViewNet(the_scene, views, HOME_RAD, TASK.min_clearance_m)
    assert 0 < len(net.views) <= len(views)
    chosen = choose_spread_views(net.views, 8)
    stops = plan_tour(net, chosen)
    wanted = sorted(tuple(view.direction.round(3) + 0.0) for view in chosen)
    assert sorted(tuple(stop.view.direction.round(3) + 0.0) for stop in stops) == wanted
    here = HOME_RAD
    for stop in stops:
        assert np.array_equal(stop.route_rad[[0, -1]], [here, stop.view.joints_rad])
        assert check_path(the_scene, stop.route_rad, TASK.min_clearance_m).is_clear
        here = stop.view.joints_rad
