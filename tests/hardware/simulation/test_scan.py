import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.geometry import invert_pose, transform_points
from core.mesh import TriangleMesh
from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from core.scan.model import RgbdFrame, Scan
from hardware.cell import read_cell
from hardware.scanning import simulated
from hardware.scanning.simulated import simulate_scan, simulated_cell
from hardware.simulation.depth_camera import HEIGHT, WIDTH
from hardware.simulation.depth_noise import DepthNoise
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import place_on_platform

CELL = read_cell()
PLACE = CELL.place


class FirstViews(Reporter):
    """Ends the scan after some views."""

    def __init__(self, views: int) -> None:
        super().__init__()
        self.views = views
        self.seen = 0

    def progress(self, stage: str, done: float, total: float) -> None:
        assert (stage, total) == ("scan", 24)
        self.seen += 1
        if done == self.views:
            self.cancel()


@pytest.fixture(scope="module")
def mug_scan() -> Scan:
    return simulate_scan(builtin_object("mug"), 3, Reporter())


def points_in_box(frame: RgbdFrame, scan: Scan) -> np.ndarray:
    points = frame.points_m(scan.intrinsics, max_depth_m=6.0, stride=3)
    inside = (points > PLACE.crop_min_m).all(axis=1) & (points < PLACE.crop_max_m).all(axis=1)
    return points[inside]


def test_a_scan_carries_24_frames_in_the_base_frame(mug_scan: Scan) -> None:
    assert len(mug_scan.frames) == 24
    assert len({frame.name for frame in mug_scan.frames}) == 24
    assert mug_scan.platform_height_m == PLACE.platform_height_m
    assert mug_scan.crop_box == PLACE.crop_box
    for frame, joints in zip(mug_scan.frames, CELL.scan.views_rad, strict=True):
        assert frame.color.shape == (HEIGHT, WIDTH, 3)
        assert frame.depth_m.shape == (HEIGHT, WIDTH)
        assert frame.depth_m[frame.depth_m > 0].min() >= 0.35
        np.testing.assert_allclose(frame.T_base_camera, flange_pose(UR5, joints) @ CELL.camera.pose)


def test_what_is_measured_inside_the_box_is_the_object(mug_scan: Scan) -> None:
    mesh = builtin_object("mug")
    T_object_base = invert_pose(place_on_platform(mesh, 3, PLACE))
    for frame in mug_scan.frames:
        points = transform_points(T_object_base, points_in_box(frame, mug_scan))
        assert len(points) > 200
        # A pose error of 0.25 degrees at 0.7 m shifts a view by 3 mm.
        assert (points > mesh.aabb_min_m - 0.015).all()
        assert (points < mesh.aabb_max_m + 0.015).all()


def test_one_seed_one_scan_whatever_other_views_it_has(
    mug_scan: Scan, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = (11, 4, 20)
    views = tuple(CELL.scan.views_rad[k] for k in chosen)
    only_these = {"views_rad": views, "look_inside": False}
    few = CELL.model_copy(update={"scan": CELL.scan.model_copy(update=only_these)})
    monkeypatch.setattr(simulated, "read_cell", lambda: few)
    again = simulate_scan(builtin_object("mug"), 3, Reporter())
    for k, frame in zip(chosen, again.frames, strict=True):
        np.testing.assert_array_equal(frame.depth_m, mug_scan.frames[k].depth_m)
        np.testing.assert_array_equal(frame.color, mug_scan.frames[k].color)
        np.testing.assert_array_equal(frame.T_base_camera, mug_scan.frames[k].T_base_camera)


def test_a_cancelled_scan_stops() -> None:
    reporter = Reporter()
    reporter.cancel()
    with pytest.raises(Cancelled):
        simulate_scan(builtin_object("mug"), 0, reporter)
    halfway = FirstViews(3)
    with pytest.raises(Cancelled):
        simulate_scan(builtin_object("mug"), 0, halfway)
    assert halfway.seen == 3


def test_an_object_too_large_for_the_cell_is_a_sentence() -> None:
    block = builtin_object("block")
    with pytest.raises(InputError, match=r"600 x 400 x 300 mm does not fit"):
        simulate_scan(TriangleMesh(block.vertices_m * 5, block.faces), 0, Reporter())


def test_one_switch_and_another_noise() -> None:
    assert not simulated_cell().simulation.is_perfect
    assert simulated_cell(is_perfect=True).simulation.is_perfect
    noise = DepthNoise(pose_position_m=0.005)
    assert simulated_cell(noise).simulation.noise == noise
    assert simulated_cell().simulation.noise == CELL.simulation.noise
    assert simulated_cell(noise).scan == CELL.scan
