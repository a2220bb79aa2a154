from __future__ import annotations

from dataclasses import replace

import numpy as np
import open3d as o3d
import pytest
import trimesh

from core.errors import Cancelled, StageError
from core.mesh import TriangleMesh
from core.reconstruction.fusion import voxel_of
from core.reconstruction.stage import reconstruct
from core.scan.model import crop_box

PLATFORM_M = 0.08
TABLE_M = 0.02


def changed(parameters, **settings):
    return type(parameters).model_validate(parameters.model_dump() | settings)


def assert_closed(mesh: TriangleMesh) -> None:
    body = trimesh.Trimesh(mesh.vertices_m, mesh.faces, process=False)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert mesh.volume_m3 > 0


def height_above(mesh: TriangleMesh, x_m: float, y_m: float) -> float:
    """Height of the highest surface over a place."""
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh.vertices_m.astype(np.float32), mesh.faces.astype(np.uint32))
    hit = scene.cast_rays(np.array([[x_m, y_m, 1.0, 0.0, 0.0, -1.0]], dtype=np.float32))["t_hit"].numpy()
    return 1.0 - float(hit[0])


def radii_m(mesh: TriangleMesh, angle_rad: float, heights_m):
    """Where horizontal rays through the axis (N heights) meet the wall from outside and from inside."""
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh.vertices_m.astype(np.float32), mesh.faces.astype(np.uint32))
    way = np.array([np.cos(angle_rad), np.sin(angle_rad), 0.0])
    axis = np.column_stack([np.full_like(heights_m, 0.4), np.full_like(heights_m, 0.1), heights_m])
    rays = np.concatenate(
        [
            np.column_stack([axis + 0.2 * way, np.tile(-way, (len(axis), 1))]),
            np.column_stack([axis, np.tile(way, (len(axis), 1))]),
        ]
    ).astype(np.float32)
    hits = scene.cast_rays(rays)["t_hit"].numpy()
    return 0.2 - hits[: len(axis)], hits[len(axis) :]


def test_a_solid_block_has_its_volume(block_scan, parameters, listener):
    result = reconstruct(block_scan, parameters, listener)
    assert result.mesh.volume_m3 == pytest.approx(0.08 * 0.06 * 0.05, rel=0.05)
    assert result.mesh.extents_m == pytest.approx([0.08, 0.06, 0.05], abs=0.004)
    assert result.mesh.aabb_min_m[2] == pytest.approx(PLATFORM_M, abs=1e-4)
    assert result.platform_height_m == PLATFORM_M
    assert_closed(result.mesh)
    assert listener.warnings == []


def test_left_free_the_block_is_a_crust_that_grows_downwards(block_scan, parameters, listener):
    free = reconstruct(block_scan, changed(parameters, unseen="free", truncation_m=0.009), listener)
    assert free.mesh.volume_m3 < 0.6 * 0.08 * 0.06 * 0.05
    assert_closed(free.mesh)


def test_a_bowl_is_open_at_the_top_and_has_its_floor(bowl_scan, parameters, listener):
    mesh = reconstruct(bowl_scan, parameters, listener).mesh
    assert_closed(mesh)
    assert height_above(mesh, 0.4, 0.1) == pytest.approx(PLATFORM_M + 0.008, abs=0.003)
    assert height_above(mesh, 0.4 + 0.046, 0.1) == pytest.approx(PLATFORM_M + 0.05, abs=0.003)
    assert mesh.extents_m == pytest.approx([0.1, 0.1, 0.05], abs=0.004)


def test_a_wall_of_two_millimetres_keeps_its_two_sides(simulated, parameters, listener):
    scan = simulated("thin_cup", translation_error_m=0.0005)
    mesh = reconstruct(scan, parameters, listener).mesh
    assert_closed(mesh)
    heights_m = np.linspace(PLATFORM_M + 0.01, PLATFORM_M + 0.04, 7)
    for angle in np.linspace(0, 2 * np.pi, 36, endpoint=False):
        outer, inner = radii_m(mesh, angle, heights_m)
        assert outer == pytest.approx(0.045, abs=0.0015)
        assert inner == pytest.approx(0.043, abs=0.0025)


def test_finer_voxels_leave_a_thin_walled_cup_more_room(simulated, parameters, listener):
    scan = simulated("thin_cup", translation_error_m=0.0005)
    heights_m = np.linspace(PLATFORM_M + 0.01, PLATFORM_M + 0.04, 7)
    short_m = []
    for voxel_m in (parameters.fine_voxel_m, parameters.voxel_m):
        mesh = reconstruct(scan, changed(parameters, fine_voxel_m=voxel_m), listener).mesh
        around = np.linspace(0, 2 * np.pi, 36, endpoint=False)
        short_m.append(0.043 - np.mean([radii_m(mesh, angle, heights_m)[1] for angle in around]))
    assert abs(short_m[0]) < 0.75 * abs(short_m[1])


@pytest.mark.parametrize(
    ("size_m", "settings", "voxel_m"),
    [
        ((0.10, 0.10, 0.10), {}, 0.0015),
        ((0.25, 0.25, 0.30), {}, 0.002),
        ((0.10, 0.10, 0.10), {"voxel_m": 0.001}, 0.001),
        ((0.10, 0.10, 0.10), {"fine_voxel_m": 0.003}, 0.002),
    ],
)
def test_small_objects_have_fine_voxels_and_none_has_coarser_ones_than_asked_for(
    parameters, size_m, settings, voxel_m
):
    assert voxel_of(crop_box(np.zeros(3), np.array(size_m)), changed(parameters, **settings)) == voxel_m


@pytest.mark.parametrize("height_m", [0.08, 0.0801, 0.083, 0.0815])
def test_closed_wherever_the_platform_cuts_the_grid(bowl_scan, parameters, listener, height_m):
    result = reconstruct(bowl_scan, changed(parameters, platform_height_m=height_m), listener)
    assert result.platform_height_m == height_m
    assert result.mesh.aabb_min_m[2] == pytest.approx(height_m, abs=2e-4)
    assert_closed(result.mesh)


def test_an_unknown_platform_is_estimated_and_told(block_scan, parameters, listener):
    result = reconstruct(replace(block_scan, platform_height_m=None), parameters, listener)
    assert result.platform_height_m == pytest.approx(PLATFORM_M, abs=0.004)
    assert "platform's height is not known" in listener.warnings[0]


@pytest.mark.parametrize("unseen", ["solid", "free"])
def test_plane_segmentation_finds_the_table_and_keeps_a_low_floor(simulated, parameters, listener, unseen):
    scan = simulated("plate", base_m=TABLE_M)
    on_table = changed(parameters, segmentation="plane", crop_min_m=(0.28, -0.02, -0.01), unseen=unseen)
    result = reconstruct(scan, on_table, listener)
    assert result.platform_height_m == pytest.approx(TABLE_M, abs=0.001)
    assert result.mesh.extents_m == pytest.approx([0.12, 0.12, 0.02], abs=0.004)
    assert height_above(result.mesh, 0.4, 0.1) == pytest.approx(TABLE_M + 0.004, abs=0.003)
    assert_closed(result.mesh)
    assert listener.warnings == []


def test_an_object_that_leaves_the_box_is_closed_and_told(block_scan, parameters, listener):
    small = changed(parameters, crop_max_m=(0.42, 0.22, 0.2))
    mesh = reconstruct(block_scan, small, listener).mesh
    assert_closed(mesh)
    assert "+x" in listener.warnings[0]
    assert "enlarge" in listener.warnings[0]


def test_only_the_largest_piece_is_kept(simulated, parameters, listener):
    scan = simulated("block_and_crumb")
    mesh = reconstruct(scan, parameters, listener).mesh
    assert mesh.extents_m[0] == pytest.approx(0.08, abs=0.004)
    assert_closed(mesh)


def test_an_empty_box_tells_where_the_points_are(block_scan, parameters, listener):
    elsewhere = changed(parameters, crop_min_m=(1.5, 1.5, 1.5), crop_max_m=(1.6, 1.6, 1.6))
    with pytest.raises(StageError, match=r"around \(0\.\d\d, 0\.\d\d, 0\.0\d\) m.*crop_min_m"):
        reconstruct(block_scan, elsewhere, listener)


def test_a_platform_above_the_object_is_refused(block_scan, parameters, listener):
    with pytest.raises(StageError, match=r"above the platform at 190 mm.*platform_height_m"):
        reconstruct(block_scan, changed(parameters, platform_height_m=0.19), listener)


def test_plane_segmentation_without_a_table_is_refused(simulated, parameters, listener):
    scan = simulated("block", table=False)
    # The block's own top is a plane, so the box ends below it.
    low = changed(parameters, segmentation="plane", crop_max_m=(0.52, 0.22, 0.12))
    with pytest.raises(StageError, match=r"crop_min_m"):
        reconstruct(scan, low, listener)


def test_depth_limit_that_leaves_nothing(block_scan, parameters, listener):
    with pytest.raises(StageError, match="max_depth_m"):
        reconstruct(block_scan, changed(parameters, max_depth_m=0.1), listener)


def test_progress_and_cancel_at_each_view(block_scan, parameters, listener):
    reconstruct(block_scan, parameters, listener)
    assert listener.steps == [("reconstruction", done, 48) for done in range(1, 49)]
    listener.cancel()
    with pytest.raises(Cancelled):
        reconstruct(block_scan, parameters, listener)


def test_twice_the_same(bowl_scan, parameters, listener):
    first, second = (reconstruct(bowl_scan, parameters, listener) for _ in range(2))
    assert np.array_equal(first.mesh.vertices_m, second.mesh.vertices_m)
    assert np.array_equal(first.mesh.faces, second.mesh.faces)
