"""The outcome of a pour: by physics in the simulated cell, by counting at the real table."""

from __future__ import annotations

from pathlib import Path

from app.operations.scanning import object_mesh
from core.errors import InputError
from core.files import reading
from core.mesh import TriangleMesh
from core.motion.pour.plan import PourPlan
from core.pipeline.pipeline import Pipeline
from core.session import explained
from core.session.cups import cup_of_run
from core.session.pour_runs import STATES_FILE, Outcome, pour_runs, write_outcome
from hardware.cell import CellSettings
from hardware.cell.scene import object_space
from hardware.pouring.pouring import PLAN_FOLDER
from hardware.pouring.run_log import read_states
from hardware.simulation.placing import place_on_platform, transform_mesh
from hardware.simulation.pour_outcome.bodies import PlatformBox
from hardware.simulation.pour_outcome.candies import NO_CANDIES
from hardware.simulation.pour_outcome.driven_path import driven_path
from hardware.simulation.pour_outcome.outcome import TableOutcome, simulate_outcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings

TABLE_FOLDER = "table"


def simulated_outcome(pipeline: Pipeline, settings: CellSettings, folder: Path) -> Outcome:
    """Drive the cup along the path that the controller reported, over the true object, and count the candies.

    Of several cups, those poured before lie in the object.
    """
    plan = PourPlan.load(folder / PLAN_FOLDER)
    with reading(folder / STATES_FILE):
        states = read_states(folder, {move.name for move in plan.moves if move.holds_cup})
    T_flange_cup = settings.gripper.grasp_pose @ plan.T_grasp_cup
    path = driven_path(settings.robot.arm, states.times_s, states.joints_rad, T_flange_cup)
    parameters, place = pipeline.poured_parameters(), settings.place
    mesh, remark = _true_mesh(pipeline, settings)
    session = pipeline.session.path
    cup = cup_of_run(session, folder, pipeline.imagination().n_per_cup)
    lying = NO_CANDIES if cup.before is None else TableOutcome.load(cup.before / TABLE_FOLDER).lying
    found = simulate_outcome(
        mesh,
        path,
        parameters.pouring.cup,
        place.table_height_m,
        PlatformBox(place.platform_min_m, place.platform_max_m, place.platform_height_m),
        # Every cup has a packing and errors of its own.
        OutcomeSettings(n_candies=cup.n_candies, seed=parameters.seed + len(lying.scales)),
        pipeline.pool,
        pipeline.reporter,
        lying,
    )
    with explained(folder):
        (folder / TABLE_FOLDER).mkdir(exist_ok=True)
        found.save(folder / TABLE_FOLDER)
    facts = {"n_in_object": found.n_in_object, "n_in_cup": found.n_in_cup, "n_before": len(lying.scales)}
    return Outcome(cup.n_candies, found.n_spilled, remark, is_simulated=True, facts=facts)


def enter_outcome(session: Path, spilled: int | None, remarks: str) -> Outcome:
    """Record what somebody counted after the newest pour.

    Raises:
        InputError: no pour was made yet.
    """
    runs = [run for run in pour_runs(session) if not run.is_back_off]
    if not runs:
        raise InputError(f"No pour was made in {session} yet; pour first.")
    before = runs[-1].outcome
    n_candies = before.n_candies if before is not None else None
    outcome = Outcome(n_candies, spilled, remarks, is_simulated=False, facts={})
    write_outcome(runs[-1].folder, outcome)
    return outcome


def _true_mesh(pipeline: Pipeline, settings: CellSettings) -> tuple[TriangleMesh, str]:
    """The object as it really is in the base frame; of a recorded scan the best that is known."""
    record = pipeline.session.record("scan")
    if record is None:
        return pipeline.surface(), ""
    if "object" not in record.parameters:
        return pipeline.surface(), "The true object is not known; its reconstruction took its place."
    mesh = object_mesh(record.parameters["object"], pipeline.reporter)
    T_base_object = place_on_platform(mesh, record.parameters["seed"], settings.place, object_space(settings))
    return transform_mesh(mesh, T_base_object), ""
