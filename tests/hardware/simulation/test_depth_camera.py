from math import radians
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from core.geometry import FloatArray, look_at
from core.progress import Reporter
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.depth_camera import CARMINE_INTRINSICS, HEIGHT, WIDTH, SimulatedDepthCamera
from hardware.simulation.depth_noise import DepthNoise, axial_sd_m, disturb, disturb_pose
from hardware.simulation.objects import builtin_object
from hardware.simulation.world import World

TABLE = np.array([0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def world() -> World:
    """A block floating 65 mm above the table, as if on the platform."""
    return World(builtin_object("block").translated(np.array([0, 0, 0.065])), TABLE)


def random() -> np.random.Generator:
    return np.random.default_rng(0)


def slanted_view() -> FloatArray:
    return look_at([0.5, -0.2, 0.6], [0, 0, 0.05])


def plane_depth_m(T_base_camera: FloatArray, height_m: float) -> FloatArray:
    """Depth along the optical axis of a horizontal plane, by hand."""
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    k = CARMINE_INTRINSICS
    rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones_like(u)], axis=-1)
    depth: FloatArray = (height_m - T_base_camera[2, 3]) / (rays @ T_base_camera[2, :3])
    return depth


def test_a_perfect_camera_sees_the_plane_where_it_is(world: World) -> None:
    T = slanted_view()
    _, depth = SimulatedDepthCamera(world, None).capture(T, random())
    truth = plane_depth_m(T, 0.0)
    table = depth[400:, :200]
    assert depth.shape == (480, 640)
    assert depth.dtype == np.float32
    np.testing.assert_allclose(table, truth[400:, :200], atol=1e-4)


def test_the_object_hides_the_table(world: World) -> None:
    T = look_at([0, 0, 0.7], [0, 0, 0])
    _, depth = SimulatedDepthCamera(world, None).capture(T, random())
    assert depth[236, 316] == pytest.approx(0.7 - 0.125, abs=1e-4)
    assert depth[10, 10] == pytest.approx(0.7, abs=1e-4)


def test_in_the_dark_only_the_colour_image_is_missing(world: World) -> None:
    block = builtin_object("block").translated(np.array([0, 0, 0.065]))
    dark = World(block, TABLE, is_lit=False)
    color, depth = SimulatedDepthCamera(dark, DepthNoise()).capture(slanted_view(), random())
    lit_color, lit_depth = SimulatedDepthCamera(world, DepthNoise()).capture(slanted_view(), random())
    np.testing.assert_array_equal(depth, lit_depth)
    assert lit_color.any()
    assert not color.any()
    assert color.shape == lit_color.shape


def test_noise_at_seven_tenths_of_a_metre() -> None:
    # Slightly slanted: what a level plane loses to the steps depends on where it lies between two of them.
    depth = np.broadcast_to(np.linspace(0.66, 0.74, WIDTH), (HEIGHT, WIDTH))
    noisy = disturb(depth, np.zeros_like(depth), DepthNoise(), random())
    assert np.median(patch_noise_m(noisy)[1]) == pytest.approx(0.0006, abs=0.0001)
    assert noisy.mean() == pytest.approx(0.7, abs=2e-4)


def patch_noise_m(depth_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean depth and SD about a plane of all full patches of 8 x 8 pixels."""
    patches = depth_m.reshape(60, 8, 80, 8).swapaxes(1, 2).reshape(-1, 64)
    patches = patches[(patches > 0).all(axis=1)]
    v, u = np.mgrid[0:8, 0:8]
    design = np.column_stack([u.ravel(), v.ravel(), np.ones(64)])
    residuals = patches.T - design @ np.linalg.lstsq(design, patches.T, rcond=None)[0]
    flat = np.abs(residuals).max(axis=0) < 0.008
    return patches.mean(axis=1)[flat], residuals.std(axis=0)[flat]


def test_noise_is_that_of_the_real_camera(shared_data: Path) -> None:
    files = sorted((shared_data / "real_scan/amazon_tray/rgbd").glob("*.depth.png"))
    real = [np.asarray(Image.open(file), dtype=float) / 1000 for file in files[::2]]
    scan = simulate_scan(builtin_object("bowl"), 0, Reporter())
    simulated = [frame.depth_m.astype(float) for frame in scan.frames[::2]]
    for low, high in ((0.55, 0.65), (0.65, 0.75), (0.75, 0.85)):
        medians = []
        for images in (real, simulated):
            depth, sd = np.hstack([patch_noise_m(image) for image in images])
            medians.append(np.median(sd[(depth > low) & (depth < high)]))
        assert medians[1] == pytest.approx(medians[0], rel=0.25)


def test_axial_noise_grows_with_distance_and_slant() -> None:
    assert axial_sd_m(np.array([0.4]), np.zeros(1))[0] == pytest.approx(0.0012)
    assert axial_sd_m(np.array([1.4]), np.zeros(1))[0] == pytest.approx(0.0031)
    flat, slanted = axial_sd_m(np.array([1.0, 1.0]), np.radians([50.0, 75.0]))
    assert slanted - flat == pytest.approx(0.0001 * 5**2)


@pytest.mark.parametrize(("depth_m", "step_m"), [(0.5, 0.00075), (1.0, 0.003), (2.0, 0.012)])
def test_disparity_comes_in_steps(depth_m: float, step_m: float) -> None:
    ramp = np.linspace(0.95 * depth_m, 1.05 * depth_m, 100_000)[None]
    quiet = DepthNoise(axial_scale=0.0, depth_step_m=0.0)
    steps = np.diff(np.unique(disturb(ramp, np.zeros_like(ramp), quiet, random())))
    assert np.median(steps) == pytest.approx(step_m, rel=0.05)


def test_depth_comes_in_whole_millimetres(world: World) -> None:
    _, depth = SimulatedDepthCamera(world, DepthNoise()).capture(slanted_view(), random())
    millimetres = depth.astype(float) * 1000
    np.testing.assert_allclose(millimetres, np.round(millimetres), atol=1e-3)


def test_minimum_range_and_grazing_surfaces() -> None:
    depth = np.array([[0.34, 0.36, 0.5, 0.5, 0.0]])
    incidence = np.radians([[0.0, 0.0, 77.0, 79.0, 0.0]])
    seen = disturb(depth, incidence, DepthNoise(axial_scale=0.0), random()) > 0
    assert seen.tolist() == [[False, True, True, False, False]]


def test_the_projector_leaves_a_shadow_on_the_left(world: World) -> None:
    T = look_at([0, 0, 0.7], [0, 0, 0])
    quiet = DepthNoise(axial_scale=0.0)
    _, depth = SimulatedDepthCamera(world, quiet).capture(T, random())
    _, without = SimulatedDepthCamera(world, DepthNoise(axial_scale=0.0, baseline_m=0.0)).capture(T, random())
    shadow = (depth == 0) & (without > 0)
    columns = np.nonzero(shadow[236])[0]
    # Similar triangles: the block's left edge, 125 mm above the table, shifted by a baseline of 75 mm.
    expected = CARMINE_INTRINSICS.fx * 0.075 * (1 / 0.575 - 1 / 0.7)
    assert len(columns) == pytest.approx(expected, abs=3)
    assert columns.max() < 316 - 0.06 * CARMINE_INTRINSICS.fx / 0.7
    assert not shadow[:, 400:].any()


def test_one_seed_one_image(world: World) -> None:
    camera = SimulatedDepthCamera(world, DepthNoise())
    color_a, depth_a = camera.capture(slanted_view(), np.random.default_rng(7))
    color_b, depth_b = camera.capture(slanted_view(), np.random.default_rng(7))
    _, depth_c = camera.capture(slanted_view(), np.random.default_rng(8))
    np.testing.assert_array_equal(color_a, color_b)
    np.testing.assert_array_equal(depth_a, depth_b)
    assert not np.array_equal(depth_a, depth_c)


def test_object_table_and_background_differ_in_colour(world: World) -> None:
    color, _ = SimulatedDepthCamera(world, None).capture(look_at([0.9, 0, 0.3], [0, 0, 0.15]), random())
    assert color.shape == (480, 640, 3)
    assert color.dtype == np.uint8
    block, table, sky = (color[v, u].astype(int) for v, u in ((250, 316), (470, 100), (5, 5)))
    assert block[2] > block[0] + 40
    assert table[0] > table[2] + 20
    assert (sky > 200).all()


def test_pose_error_has_the_size_asked_for() -> None:
    generator = random()
    T = slanted_view()
    errors = [np.linalg.inv(T) @ disturb_pose(T, DepthNoise(), generator) for _ in range(2000)]
    shifts = np.array([np.linalg.norm(error[:3, 3]) for error in errors])
    turns = np.array([np.arccos(np.clip((np.trace(error[:3, :3]) - 1) / 2, -1, 1)) for error in errors])
    assert np.sqrt((shifts**2).mean()) == pytest.approx(0.001, rel=0.05)
    assert np.sqrt((turns**2).mean()) == pytest.approx(radians(0.25), rel=0.05)
