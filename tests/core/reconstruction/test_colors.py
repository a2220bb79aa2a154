from __future__ import annotations

import numpy as np
import pytest

from core.errors import SessionError
from core.geometry import look_at
from core.mesh import TriangleMesh
from core.mesh_file import colored_mesh_content, read_mesh
from core.progress import Reporter
from core.reconstruction.colors import ModelColors, photographed
from core.scan.model import Intrinsics, RgbdFrame, Scan

CAMERA = Intrinsics(200.0, 200.0, 80.0, 60.0)
RED, BLUE = np.array([0.8, 0.3, 0.2]), np.array([0.2, 0.3, 0.8])


@pytest.fixture(scope="module")
def ball():
    """Red where x is negative, blue elsewhere."""
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=4, radius=0.05)
    return TriangleMesh(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))


def view(azimuth_rad, gain=1.0):
    """The ball's picture from that side, from a little above, exposed by a gain."""
    eye = 0.4 * np.array([np.cos(azimuth_rad), np.sin(azimuth_rad), 0.4])
    T_base_camera = look_at(eye, (0, 0, 0))
    rows, columns = np.mgrid[0:120, 0:160]
    rays = np.stack(
        [(columns - CAMERA.cx) / CAMERA.fx, (rows - CAMERA.cy) / CAMERA.fy, np.ones((120, 160))], -1
    )
    rays = rays @ T_base_camera[:3, :3].T
    a, b, c = (rays**2).sum(-1), rays @ eye, eye @ eye - 0.05**2
    under = b * b - a * c
    depth = np.where(under > 0, (-b - np.sqrt(np.maximum(under, 0))) / a, 0.0)
    x = eye[0] + depth * rays[..., 0]
    color = np.where((x < 0)[..., None], RED, BLUE) * gain
    color[depth == 0] = 1.0
    return RgbdFrame("view", np.uint8(np.clip(255 * color, 0, 255)), depth.astype(np.float32), T_base_camera)


def scan(*frames):
    return Scan(frames, CAMERA)


def ring(gains):
    return scan(*(view(2 * np.pi * k / len(gains), gain) for k, gain in enumerate(gains)))


def test_each_place_gets_the_colour_it_is_photographed_in(ball):
    rgb = photographed(ball, ring([1.0] * 8)).rgb / 255
    x, z = ball.vertices_m[:, 0], ball.vertices_m[:, 2]
    assert np.abs(rgb[(x < -0.01) & (z > -0.02)] - RED).max() < 0.06
    assert np.abs(rgb[(x > 0.01) & (z > -0.02)] - BLUE).max() < 0.06


def test_views_of_other_exposure_leave_no_seams(ball):
    gains = [0.8, 1.2, 0.9, 1.1, 0.8, 1.2, 0.9, 1.1]
    rgb = photographed(ball, ring(gains)).rgb / 255
    is_blue = (ball.vertices_m[:, 0] > 0.012) & (np.abs(ball.vertices_m[:, 2]) < 0.02)
    assert rgb[is_blue].std(axis=0).max() < 0.025


def test_what_no_view_saw_is_coloured_as_its_surroundings_are(ball):
    rgb = photographed(ball, scan(view(0.0))).rgb / 255
    unseen = ball.vertices_m[:, 0] < -0.03
    assert np.abs(rgb[unseen, 1] - BLUE[1]).max() < 0.12  # between red and blue, neither black nor white
    assert rgb[unseen][:, [0, 2]].sum(axis=1) == pytest.approx(np.ones(unseen.sum()), abs=0.2)


def test_what_something_hides_does_not_take_its_colour(ball):
    """The measured depth is of another thing, nearer than the surface."""
    good, covered = view(0.0), view(0.3)
    covered.color[:], covered.depth_m[:] = 0, 0.2
    rgb = photographed(ball, scan(good, covered)).rgb / 255
    facing = ball.vertices_m[:, 0] > 0.04
    assert np.abs(rgb[facing] - BLUE).max() < 0.06


def test_where_a_view_measured_no_depth_it_may_see_what_is_behind(ball):
    good, blind = view(0.0), view(0.3)
    blind.color[:], blind.depth_m[:] = 255, 0.0
    alone, with_it = photographed(ball, scan(good)).rgb, photographed(ball, scan(good, blind)).rgb
    assert np.array_equal(with_it, alone)


def test_colours_leave_the_surface_as_it_is_and_are_kept_with_it(ball, tmp_path):
    before = ball.vertices_m.copy()
    made = photographed(ball, ring([1.0] * 3))
    assert (ball.vertices_m == before).all()
    made.save(tmp_path)
    assert (ModelColors.load(tmp_path).rgb == made.rgb).all()
    (tmp_path / "colors.npz").write_bytes((tmp_path / "colors.npz").read_bytes()[:-5])
    with pytest.raises(SessionError, match=r"colors\.npz"):
        ModelColors.load(tmp_path)


def test_glb_and_ply_are_read_by_others(ball, tmp_path):
    import trimesh

    rgb = np.tile(np.uint8([200, 100, 50]), (len(ball.vertices_m), 1))
    for ending in (".ply", ".glb"):
        (tmp_path / f"model{ending}").write_bytes(colored_mesh_content(ball, rgb, ending))
    seen = trimesh.load(tmp_path / "model.ply", process=False)
    assert seen.visual.vertex_colors[0, :3].tolist() == [200, 100, 50]
    again = read_mesh(tmp_path / "model.glb", Reporter())
    assert again.aabb_max_m == pytest.approx(ball.aabb_max_m, abs=1e-6)
    assert again.volume_m3 == pytest.approx(ball.volume_m3, rel=1e-4)
