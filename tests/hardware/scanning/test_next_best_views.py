"""The paper's future work: views that see the inside of an opening that the scan did not."""

from dataclasses import replace

import numpy as np
import open3d as o3d
import pytest

from core.errors import Cancelled
from core.mesh import TriangleMesh
from core.motion.clearance import MotionScene
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.reconstruction.unseen import find_unseen_inside
from core.scan import Scan
from hardware.cell import CellSettings, open_cell, read_cell
from hardware.scanning.next_best_views import (
    MOST_VIEWS,
    STAGE,
    look_inside,
    object_volume,
    propose,
    take_next_best_views,
)
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import name_views
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import world_with
from tests.core.imagination.capacity.conftest import turned
from tests.core.quality.studio import tube

pytestmark = pytest.mark.system

DEPTH_M = 0.2
SEED = 2
CELL = read_cell()


def scanning(mesh: TriangleMesh, seed: int, settings: CellSettings = CELL):
    return open_cell(settings, world_with(mesh, settings.place, seed), seed)


def depth_m(scan: Scan) -> float:
    """Median depth below the rim, of the reconstruction, within 8 mm of its opening's middle."""
    mesh = reconstruct(scan, ReconstructionParameters(), Reporter()).mesh
    top = float(mesh.aabb_max_m[2])
    rim = mesh.vertices_m[mesh.vertices_m[:, 2] > top - 0.004, :2]
    x, y = np.meshgrid(np.linspace(-0.008, 0.008, 9), np.linspace(-0.008, 0.008, 9))
    middle = (rim.min(axis=0) + rim.max(axis=0)) / 2
    rays = np.stack([middle[0] + x, middle[1] + y, 0 * x + top, 0 * x, 0 * x, 0 * x - 1], axis=-1)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(mesh.vertices_m.astype(np.float32)), o3d.core.Tensor(mesh.faces.astype(np.uint32))
    )
    return float(np.median(scene.cast_rays(o3d.core.Tensor(rays.astype(np.float32)))["t_hit"].numpy()))


def proposed(cell, scan: Scan) -> list:
    volume = object_volume(scan, Reporter())
    return propose(cell, scan, volume, find_unseen_inside(volume, CELL.place.platform_height_m))


def test_a_narrow_vase_goes_from_a_dent_to_its_true_depth():
    with scanning(tube(0.04, DEPTH_M), SEED) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad))
        before_m = depth_m(procedure.scan())
        n_views = take_next_best_views(cell, procedure, Reporter())
        after_m = depth_m(procedure.scan())
        joints = np.array([record.view.joints_rad for record in procedure.records])
    assert before_m < DEPTH_M / 2
    assert after_m == pytest.approx(DEPTH_M, abs=0.01)
    assert 1 <= n_views <= MOST_VIEWS
    assert len(joints) == 24 + n_views
    scene: MotionScene = cell.scene
    assert scene.clearance(joints).distance_m.min() >= CELL.scan.min_clearance_m - 1e-6


def test_nothing_is_proposed_where_everything_was_seen():
    with scanning(builtin_object("bowl"), 0) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad[::2]))
        assert proposed(cell, procedure.scan()) == []


def test_a_scan_looks_into_a_narrow_vase_by_itself_and_not_for_ever():
    with scanning(tube(0.04, DEPTH_M), SEED) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad))
        n_views = look_inside(cell, procedure, Reporter(), len(cell.views_rad))
        n_more = look_inside(cell, procedure, Reporter(), len(cell.views_rad))
        assert depth_m(procedure.scan()) > DEPTH_M / 2
    assert n_views >= 1
    assert n_views + n_more <= MOST_VIEWS


class Heard(Reporter):
    """Remembers the stages that it was told of."""

    def __init__(self) -> None:
        super().__init__()
        self.stages: set[str] = set()

    def progress(self, stage: str, done: float, total: float) -> None:
        self.stages.add(stage)


def shouldered_jar() -> TriangleMesh:
    """Of 4 litres, its floor 30 mm wider on each side than its mouth."""
    floor_m, belly_m, mouth_m, high_m, wall_m = 0.086, 0.1, 0.05, 0.16, 0.003
    outside = [(0, 0), (floor_m, 0), (belly_m, 0.056), (belly_m, 0.088), (mouth_m, 0.144), (mouth_m, high_m)]
    inside = [(x - wall_m, max(z, wall_m)) for x, z in outside[:0:-1]]
    return turned([*outside, *inside, (0, wall_m)])


def test_what_the_reconstruction_takes_for_unseen_is_looked_at():
    """In coarse voxels a foot of the wall is seen that the reconstruction is not sure of."""

    def may_have_a_hole(scan: Scan) -> bool:
        volume = object_volume(scan, Reporter())
        return find_unseen_inside(volume, CELL.place.platform_height_m).way_through(volume) is not None

    with scanning(shouldered_jar(), 1) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad))
        assert may_have_a_hole(procedure.scan())
        reporter = Heard()
        assert look_inside(cell, procedure, reporter, len(cell.views_rad)) <= MOST_VIEWS
        assert not may_have_a_hole(procedure.scan())
        assert reporter.stages == {STAGE}, "the reconstruction's own stages are for later"
        reporter.cancel()
        with pytest.raises(Cancelled):
            object_volume(procedure.scan(), reporter)


def test_no_view_is_proposed_that_the_scan_has_already():
    with scanning(tube(0.04, DEPTH_M), SEED) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad))
        before = procedure.scan()
        (first, _), *_ = proposed(cell, before)
        procedure.take(name_views([first], first=len(before.frames)))
        taken = procedure.scan().frames[-1]
        in_vain = replace(
            before, frames=(*before.frames, replace(taken, depth_m=np.zeros_like(taken.depth_m)))
        )
        again = [joints for joints, _ in proposed(cell, in_vain)]
    assert first not in again and len(again) > 0


def test_a_bottom_that_was_not_seen_is_looked_at_however_little_it_is():
    with scanning(tube(0.04, DEPTH_M), SEED) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad))
        assert take_next_best_views(cell, procedure, Reporter(), least_share=1.0) >= 1


def test_a_scan_does_not_look_inside_where_it_is_told_not_to_or_has_seen_all():
    scan = CELL.scan.model_copy(update={"look_inside": False})
    with scanning(tube(0.04, DEPTH_M), SEED, CELL.model_copy(update={"scan": scan})) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad[::3]))
        assert look_inside(cell, procedure, Reporter(), len(procedure.records)) == 0
    with scanning(builtin_object("bowl"), 0) as cell:
        procedure = ScanProcedure(cell, None, Reporter())
        procedure.take(name_views(cell.views_rad[::2]))
        assert look_inside(cell, procedure, Reporter(), len(procedure.records)) == 0
