import numpy as np
import pytest
import trimesh

from core.errors import InputError
from core.mesh import TriangleMesh
from hardware.simulation.objects import BUILTIN_OBJECTS, builtin_object

CONTAINERS = {"mug": 0.080, "bowl": 0.050, "glass": 0.105, "vase": 0.18, "box": 0.08, "tray": 0.03}
"""Least depth in metres from rim to floor."""


def as_trimesh(mesh: TriangleMesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices_m, mesh.faces, process=False)


def depth_at_axis(mesh: TriangleMesh) -> float:
    """From the top of the object down to what a candy falling along the z-axis meets; NaN if nothing."""
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(mesh.vertices_m.astype(np.float32)), o3d.core.Tensor(mesh.faces.astype(np.uint32))
    )
    top = float(mesh.aabb_max_m[2])
    hit = scene.cast_rays(o3d.core.Tensor(np.array([[1e-4, 2e-4, top, 0, 0, -1]], dtype=np.float32)))
    distance = float(hit["t_hit"].numpy()[0])
    return distance if np.isfinite(distance) else np.nan


def thinnest_wall_m(mesh: TriangleMesh) -> float:
    """Least way from a face's middle straight inwards to the other side, rims and edges left out (5 %)."""
    import open3d as o3d

    body = as_trimesh(mesh)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(mesh.vertices_m.astype(np.float32)), o3d.core.Tensor(mesh.faces.astype(np.uint32))
    )
    inwards = -body.face_normals
    origins = body.triangles_center + 1e-5 * inwards
    rays = np.hstack([origins, inwards]).astype(np.float32)
    thickness = scene.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy()
    order = np.argsort(thickness)
    share = np.cumsum(body.area_faces[order]) / body.area
    return float(thickness[order][np.searchsorted(share, 0.05)])


@pytest.mark.parametrize("name", BUILTIN_OBJECTS)
def test_objects_are_closed_and_rest_on_the_ground(name: str) -> None:
    mesh = builtin_object(name)
    body = as_trimesh(mesh)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert all(part.volume > 0 for part in body.split())
    assert mesh.aabb_min_m[2] == pytest.approx(0, abs=1e-9)
    assert mesh.extents_m.min() > 0.02
    assert mesh.extents_m.max() < 0.3
    assert len(mesh.faces) < 30_000


@pytest.mark.parametrize(("name", "depth_m"), CONTAINERS.items())
def test_containers_have_a_cavity_with_a_floor(name: str, depth_m: float) -> None:
    mesh = builtin_object(name)
    depth = depth_at_axis(mesh)
    assert depth > depth_m
    assert depth < mesh.aabb_max_m[2] - 0.0029


def test_the_plate_is_shallow() -> None:
    assert 0.015 < depth_at_axis(builtin_object("plate")) < 0.022


@pytest.mark.parametrize("name", [*CONTAINERS, "plate"])
def test_walls_are_at_least_three_millimetres(name: str) -> None:
    assert thinnest_wall_m(builtin_object(name)) > 0.0028


def test_the_others_hold_nothing() -> None:
    assert depth_at_axis(builtin_object("bottle")) < 0.001
    assert depth_at_axis(builtin_object("block")) < 0.001
    assert np.isnan(depth_at_axis(builtin_object("ring")))


def test_those_that_look_otherwise_hold_nothing() -> None:
    """A plumb line meets the knob, the foot, or only the table; no edge is as high as half a candy."""
    assert depth_at_axis(builtin_object("lid")) < 0.001
    assert 0.002 < depth_at_axis(builtin_object("upturned-cup")) < 0.0035
    assert np.isnan(depth_at_axis(builtin_object("holed-cup")))


def test_the_vase_is_narrow_and_deep() -> None:
    mesh = builtin_object("vase")
    rim = mesh.vertices_m[mesh.vertices_m[:, 2] > mesh.aabb_max_m[2] - 0.002]
    opening = 2 * np.linalg.norm(rim[:, :2], axis=1).min()
    assert 0.036 < opening < 0.044


def test_an_unknown_object_offers_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean 'bottle'"):
        builtin_object("botle")
