"""The whole scan in the simulated cell, in memory."""

from __future__ import annotations

from core.mesh import TriangleMesh
from core.progress import Reporter
from core.scan.model import Scan
from hardware.cell import open_cell, read_cell
from hardware.cell.scene import object_space
from hardware.cell.settings import CellSettings, SimulationSettings
from hardware.scanning.next_best_views import look_inside
from hardware.scanning.planning import cell_for_plan, plan_scan
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import name_views
from hardware.simulation.depth_noise import DepthNoise
from hardware.simulation.placing import world_with


def simulate_scan(
    mesh: TriangleMesh,
    seed: int,
    reporter: Reporter,
    noise: DepthNoise | None = None,
    cell: CellSettings | None = None,
    *,
    is_lit: bool = True,
) -> Scan:
    """Put an object on the simulated cell's platform at random, plan its views and take them.

    The images are taken from disturbed poses, the frames carry the undisturbed ones: that is the pose error.

    Args:
        mesh: the object in metres, z up; the origin of its frame does not matter.
        seed: of the placing, the pose errors and the images.
        reporter: called after each view.
        noise: the camera's; none: the cell's.
        cell: a simulated one, with its own noise; none: the shipped one.
        is_lit: whether there is light for the colour images, which take a quarter of the time.

    Raises:
        InputError: the object does not fit on the platform.
        MotionError: the arm reaches too few views of it.
        Cancelled: on request.
    """
    settings = simulated_cell(noise) if cell is None else cell
    world = world_with(mesh, settings.place, seed, object_space(settings), is_lit=is_lit)
    with open_cell(settings, world, seed) as opened:
        plan = plan_scan(opened, reporter)
        planned = cell_for_plan(opened, plan)
        procedure = ScanProcedure(planned, None, reporter)
        procedure.take(name_views(plan.views_rad))
        look_inside(planned, procedure, reporter, len(plan.views_rad))
        return procedure.scan()


def simulated_cell(noise: DepthNoise | None = None, is_perfect: bool = False) -> CellSettings:
    """Return the shipped simulated cell, with another noise if one is given."""
    settings = read_cell()
    simulation = SimulationSettings(is_perfect=is_perfect, noise=noise or settings.simulation.noise)
    return settings.model_copy(update={"simulation": simulation})
