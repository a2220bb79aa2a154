from __future__ import annotations

import numpy as np
import pytest

from app.gui.theme import LIGHT
from app.gui.views.scene import Frustum
from app.gui.views.scene.arm import Arm
from app.gui.views.scene.arm_mesh import arm_pieces
from app.gui.views.scene.camera import Camera
from app.gui.views.scene.candies import Candies
from app.gui.views.scene.layers import (
    CropBox,
    frusta_layer,
    label_layer,
    line_layer,
    points_layer,
)
from app.gui.views.scene.shapes import box_mesh
from core.geometry import look_at, make_pose, transform_points
from core.motion.arm_models import UR5, UR5E, Capsule, arm_shape
from core.motion.kinematics import flange_pose, link_poses

SIZE = (900, 600)
STATES = ("pending", "taken", "poor", "failed")


LENTIL = box_mesh((-0.006, -0.006, -0.003), (0.006, 0.006, 0.003))
FLAT = (0, 0, 0, 1)


def candies(n=4, kept=None):
    made = Candies(n, LENTIL, kept)
    made.move(np.arange(3 * n, dtype=float).reshape(n, 3), np.tile(FLAT, (n, 1)))
    return made


def test_lost_candies_have_a_rim_and_less_colour():
    bodies, rims = candies(3, np.array([True, False, True])).layer.parts
    assert (len(bodies.poses), len(rims.poses)) == (3, 1)
    assert rims.is_rim and (np.abs(rims.vertices_m).max(axis=0) > np.abs(bodies.vertices_m).max(axis=0)).all()
    saturation = np.ptp(bodies.paint.colors(LIGHT)[:, :3], axis=1)
    assert saturation[1] < 0.1 < saturation[[0, 2]].min()


def test_where_nothing_is_lost_there_are_no_rims():
    assert len(candies(3).layer.parts) == 1


def test_candies_are_where_they_are_put():
    made = candies()
    outline = made.layer.outline_m()
    assert outline.min(axis=0) == pytest.approx((0, 1, 2), abs=0.011)
    assert outline.max(axis=0) == pytest.approx((9, 10, 11), abs=0.011)


def test_candies_lie_as_they_were_recorded():
    made = candies(2, np.array([True, False]))
    made.move(np.zeros((2, 3)), [(0, 0, 0, 2), (0.5, 0, 0, 0.5)])
    turned = np.array([(0, 0, 0, 1), (0.5**0.5, 0, 0, 0.5**0.5)])
    assert made.layer.parts[0].poses[:, 3:] == pytest.approx(turned)
    assert made.layer.parts[1].poses[:, 3:] == pytest.approx(turned[1:])


def test_a_candy_without_a_place_is_neither_seen_nor_picked():
    made = candies()
    made.move(
        np.array([[0, 0, 0], [np.nan] * 3, [0, 0, 1], [np.nan] * 3], dtype=float), np.tile(FLAT, (4, 1))
    )
    assert made.layer.parts[0].poses.any(axis=1).sum() == 2
    ray = Camera(center_m=(0, 0, 1)).ray((450, 300), SIZE)
    assert made.layer.target.hit(ray)[1] == 2


def test_moving_candies_makes_no_new_faces():
    made = candies()
    part = made.layer.parts[0]
    indices, revision = part.indices, part.revision
    made.move(np.zeros((4, 3)), np.tile(FLAT, (4, 1)))
    assert part.indices is indices
    assert part.revision > revision


def test_there_may_be_no_candies():
    made = candies(0)
    assert len(made.layer.outline_m()) == 0
    assert made.layer.target.hit(Camera().ray((450, 300), SIZE)) is None


def frusta(*states, selected=None):
    return [
        Frustum(f"frame-{k}", look_at((0.5, 0.1 * k, 0.4), (0.5, 0.1 * k, 0)), state, k == selected)
        for k, state in enumerate(states)
    ]


def looks(*states, selected=None):
    layer = frusta_layer(frusta(*states, selected=selected))
    lines = [part for part in layer.parts if part.kind == "lines"]
    surfaces = [part for part in layer.parts if part.kind == "surface"]
    return sum(len(part.vertices_m) for part in lines), sum(part.n_triangles for part in surfaces)


def test_the_state_of_a_view_is_shown_by_its_shape():
    assert len({looks(state) for state in STATES}) == len(STATES)


def test_the_state_of_a_view_is_shown_by_its_colour():
    colors = [tuple(frusta_layer(frusta(state)).parts[0].paint.colors(LIGHT)[0]) for state in STATES]
    assert len(set(colors)) == len(STATES)


def test_a_selected_view_has_thicker_lines():
    layer = frusta_layer(frusta("taken", "taken", selected=1))
    widths = [part.size_px for part in layer.parts if part.kind == "lines"]
    assert widths == sorted(widths) and widths[0] < widths[1]


def test_a_click_picks_a_view():
    layer = frusta_layer(frusta(*STATES))
    camera = Camera(center_m=(0.5, 0.2, 0.35), distance_m=1).looking_from("top")
    assert layer.target.hit(camera.ray((450, 300), SIZE))[1] == 2


def test_no_views_no_parts():
    assert frusta_layer([]).parts == ()


GRIPPER_TOOL = Capsule("gripper", 6, (0, 0, 0), (0, 0, 0.12), 0.04)
CAMERA_TOOL = Capsule("camera", 6, (-0.08, -0.06, 0.03), (0.08, -0.06, 0.03), 0.025)
JOINTS = np.array([0.3, -1.6, 1.6, -1.5, -1.57, 0.2])


def test_an_arm_ends_where_its_tool_is():
    arm = Arm(UR5, [GRIPPER_TOOL], "solid")
    arm.move(JOINTS)
    tip = flange_pose(UR5, JOINTS) @ (0, 0, 0.16, 1)
    gaps = np.linalg.norm(arm.layer.outline_m() - tip[:3], axis=1)
    assert gaps.min() < 0.035


@pytest.mark.parametrize("model", [UR5, UR5E], ids=["UR5", "UR5e"])
def test_what_is_shown_of_an_arm_lies_within_its_collision_shape(model):
    """But for some millimetres: lids protrude, and capsules have no edges."""
    tools = [GRIPPER_TOOL, CAMERA_TOOL]
    poses = link_poses(model, JOINTS)
    capsules = arm_shape(model, tools).capsules
    for link, color, (vertices, _) in arm_pieces(model, tools):
        points = transform_points(poses[link], vertices)
        gaps = [
            distances_to_segment(points, transform_points(poses[c.link], [c.start_m, c.end_m])) - c.radius_m
            for c in capsules
        ]
        assert np.min(gaps, axis=0).max() < 0.026, (link, color)


def distances_to_segment(points, ends):
    along = ends[1] - ends[0]
    share = np.clip((points - ends[0]) @ along / max(along @ along, 1e-12), 0, 1)
    return np.linalg.norm(points - ends[0] - share[:, None] * along, axis=1)


def test_a_ghost_is_see_through_and_of_another_colour():
    colors = [Arm(UR5, [], looks).layer.parts[0].paint.colors(LIGHT) for looks in ("solid", "ghost")]
    assert colors[0][0, 3] == 1 and colors[1][3] < 0.6
    assert (colors[0][:, :3] != colors[1][:3]).any()


def test_the_collision_shape_is_as_large_as_its_capsules():
    arm = Arm(UR5, [GRIPPER_TOOL], "collision")
    arm.move(np.zeros(6))
    low = arm.layer.outline_m()[:, 2].min()
    assert low == pytest.approx(-0.08, abs=0.02)
    assert all(part.paint.opacity < 0.5 for part in arm.layer.parts)


def box():
    return CropBox((-0.1, -0.2, 0), (0.1, 0.2, 0.3), has_handles=True)


@pytest.mark.parametrize("handle", range(6))
def test_a_dragged_handle_moves_its_side_and_no_other(handle):
    made, camera = box(), Camera(center_m=(0, 0, 0.15), distance_m=1.5, azimuth_deg=-50, elevation_deg=25)
    before = np.concatenate([made.min_m, made.max_m])
    axis = handle % 3
    goal = np.array([0, 0, 0.15])
    goal[axis] = before[handle] + 0.05
    made.drag(handle, camera.ray(tuple(camera.project(goal[None], SIZE)[0]), SIZE))
    after = np.concatenate([made.min_m, made.max_m])
    expected = before.copy()
    expected[handle] += 0.05
    assert after == pytest.approx(expected)
    assert made.layer.outline_m()[:, axis].max() == pytest.approx(after[3 + axis])


def test_handles_are_found_under_their_pixels():
    made, camera = box(), Camera(center_m=(0, 0, 0.15), distance_m=1.5)
    top = camera.project(np.array([[0, 0, 0.3]]), SIZE)[0]
    assert made.handle_at(tuple(top), camera, SIZE) == 5
    assert made.handle_at((5, 5), camera, SIZE) is None


def test_a_box_never_turns_over():
    made, camera = box(), Camera(center_m=(0, 0, 0.15), distance_m=1.5)
    below = camera.project(np.array([[0, 0, -0.2]]), SIZE)[0]
    made.drag(5, camera.ray(tuple(below), SIZE))
    assert made.max_m[2] > made.min_m[2]


def test_a_box_without_handles_has_none():
    made = CropBox((0, 0, 0), (1, 1, 1), has_handles=False)
    camera = Camera(center_m=(0.5, 0.5, 0.5), distance_m=3)
    at = camera.project(np.array([[0.5, 0.5, 1.0]]), SIZE)[0]
    assert made.handle_at(tuple(at), camera, SIZE) is None
    assert len(made.layer.parts) == 1


@pytest.mark.parametrize("n", [0, 1, 2, 5])
def test_a_line_has_one_segment_less_than_points(n):
    layer = line_layer(np.zeros((n, 3)), "accent", 2)
    assert len(layer.parts[0].indices) == 2 * max(n - 1, 0)


def test_poses_move_labels_and_points():
    for layer in (label_layer((1, 2, 3), "pivot"), points_layer([(1, 2, 3)], "accent", 5)):
        layer.T_world_layer = make_pose(np.eye(3), (10, 0, 0))
        assert layer.outline_m().tolist() == [[11, 2, 3]]
