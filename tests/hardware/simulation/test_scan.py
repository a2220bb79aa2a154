import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import Cancelled, InputError
from core.geometry import invert_pose, rotation_error, transform_points
from core.mesh import TriangleMesh
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.scan import crop_box_of
from core.scan.model import Scan
from hardware.simulation.depth_camera import HEIGHT, WIDTH
from hardware.simulation.objects import BUILTIN_OBJECTS, builtin_object
from hardware.simulation.scan import place_on_platform, simulate_scan, transform_mesh
from hardware.simulation.scan_views import scan_views

PARAMETERS = ReconstructionParameters()
BOX = crop_box_of(None, PARAMETERS)
TARGET = np.array([-0.06, -0.35, 0.14])


@pytest.fixture(scope="module")
def mug_scan() -> Scan:
    return simulate_scan(builtin_object("mug"), 3, Reporter())


def test_the_views_are_24_different_poses_that_look_at_the_target() -> None:
    views = scan_views(TARGET)
    assert len(views) == 24
    for T in views:
        assert rotation_error(T[:3, :3]) < 1e-9
        seen = invert_pose(T) @ [*TARGET, 1]
        np.testing.assert_allclose(seen[:2], 0, atol=1e-9)
        assert seen[2] > 0.6
    eyes = np.array([T[:3, 3] for T in views])
    apart = np.linalg.norm(eyes[:, None] - eyes[None], axis=-1) + np.eye(24)
    assert apart.min() > 0.1
    elevation = np.degrees(np.arcsin((eyes - TARGET)[:, 2] / np.linalg.norm(eyes - TARGET, axis=1)))
    assert 25 <= elevation.min() <= 30
    assert elevation.max() > 89


def test_a_scan_carries_24_frames_in_the_base_frame(mug_scan: Scan) -> None:
    assert len(mug_scan.frames) == 24
    assert len({frame.name for frame in mug_scan.frames}) == 24
    assert mug_scan.platform_height_m == pytest.approx(0.08)
    for frame in mug_scan.frames:
        assert frame.color.shape == (HEIGHT, WIDTH, 3)
        assert frame.depth_m.shape == (HEIGHT, WIDTH)
        assert frame.depth_m[frame.depth_m > 0].min() >= 0.35


def test_what_is_measured_inside_the_box_is_the_object(mug_scan: Scan) -> None:
    mesh = builtin_object("mug")
    T_object_base = invert_pose(place_on_platform(mesh, 3, PARAMETERS))
    inside = []
    for frame in mug_scan.frames:
        points = frame.points_m(mug_scan.intrinsics, max_depth_m=6.0, stride=3)
        keep = (points > BOX.min_m).all(axis=1) & (points < BOX.max_m).all(axis=1)
        inside.append(transform_points(T_object_base, points[keep]))
    points = np.concatenate(inside)
    assert len(points) > 2000
    # Pose error of 0.25 degrees at 0.62 m shifts a view by 2.7 mm.
    assert (points > mesh.aabb_min_m - 0.012).all()
    assert (points < mesh.aabb_max_m + 0.012).all()


def test_one_seed_one_scan(mug_scan: Scan) -> None:
    again = simulate_scan(builtin_object("mug"), 3, Reporter())
    for a, b in zip(mug_scan.frames, again.frames, strict=True):
        np.testing.assert_array_equal(a.depth_m, b.depth_m)
        np.testing.assert_array_equal(a.color, b.color)
        np.testing.assert_array_equal(a.T_base_camera, b.T_base_camera)


def test_a_cancelled_scan_stops() -> None:
    reporter = Reporter()
    reporter.cancel()
    with pytest.raises(Cancelled):
        simulate_scan(builtin_object("mug"), 0, reporter)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(list(BUILTIN_OBJECTS)), st.integers(0, 2**31 - 1))
def test_every_object_stands_inside_the_box_on_the_platform(name: str, seed: int) -> None:
    mesh = builtin_object(name)
    placed = transform_mesh(mesh, place_on_platform(mesh, seed, PARAMETERS))
    assert placed.aabb_min_m[2] == pytest.approx(0.08)
    assert (placed.aabb_min_m > np.array(BOX.min_m) + 0.0099).all()
    assert (placed.aabb_max_m < np.array(BOX.max_m) - 0.0099).all()
    eyes = [T[:3, 3] for T in scan_views(TARGET)]
    nearest = min(np.linalg.norm(placed.vertices_m - eye, axis=1).min() for eye in eyes)
    assert nearest > 0.36


def test_an_object_too_large_for_the_cell_is_a_sentence() -> None:
    block = builtin_object("block")
    with pytest.raises(InputError, match=r"600 x 400 x 300 mm does not fit"):
        simulate_scan(TriangleMesh(block.vertices_m * 5, block.faces), 0, Reporter())
