"""How each stage runs and where its result is kept: the other half of the table in `core.stages`.

A run gets what it was promised and nothing else: the results of its inputs, and its part of the parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from core.collision import CollisionModel, simplify, simplify_finely
from core.imagination.amount.reasoning import plan_amount
from core.imagination.amount.result import PlannedAmount
from core.imagination.choice import choose_pour
from core.imagination.context import Ahead, BodyFiles, ImaginationContext, SpareTask
from core.imagination.cup_runs import CupRuns
from core.imagination.drop import imagine_drop
from core.imagination.judgement import Judgement, judge, judge_ahead
from core.imagination.pours import imagine_pours
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.render import render_evidence
from core.imagination.rendering.shapes import cup_surface
from core.imagination.results import POURS_FILE, Drop, PourGrid
from core.imagination.retention.imagine import imagine_retention
from core.imagination.retention.result import RETENTION_FILE, Retention
from core.imagination.risk.drawing import with_camera_error, with_scan_error
from core.imagination.risk.tries import Tries, imagine_risk, try_pours
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourMotions, feasible_pours
from core.motion.pour.planning import judge_pours
from core.parameters import Parameters
from core.pipeline.given_mesh import GivenMesh
from core.pipeline.jobs import collision_job, colors_job, quality_job, reconstruction_job
from core.progress import Reporter
from core.quality.measures import ScanQuality
from core.reconstruction.colors import ModelColors
from core.reconstruction.result import Reconstruction
from core.stages import CAMERA_ERRORS, MESH, SCAN
from core.unseen_readings import UnseenReadings
from core.workers import Task, TaskRunner

_LARGEST_CAMERA_ERROR = 0.1
"""In metres and radians: what is larger comes from no calibration."""


@dataclass
class Tools:
    """What all stages of a run share.

    Attributes:
        runner: where to compute.
        reporter: receives progress and warnings.
        bodies: files of the bodies, each written once.
        cup_runs: runs of the cup alone.
        early: takes each still as soon as it is drawn; none: nobody waits for one.
        cell: whose arm shall pour; none: nobody asks about an arm.
        spare: what idle processors may compute already.
        ahead: what they found out.
    """

    runner: TaskRunner
    reporter: Reporter
    bodies: BodyFiles = field(default_factory=BodyFiles)
    cup_runs: CupRuns = field(default_factory=CupRuns)
    early: Path | None = None
    cell: PourCell | None = None
    spare: list[SpareTask] = field(default_factory=list)
    ahead: Ahead = field(default_factory=Ahead)

    def context(self, parameters: Parameters) -> ImaginationContext:
        """Return the context of an imagination that reads these parameters."""
        return ImaginationContext(parameters, self.runner, self.reporter, self.bodies, self.spare, self.ahead)


@dataclass(frozen=True)
class Given:
    """What one run is handed.

    Attributes:
        parameters: the part that the stage reads.
        result: returns the result of one of its inputs, by name.
        source: which input is the surface.
        folder: of the session, for stages that read the scan; none without a session.
        scan_facts: what is known of the scan besides its views.
        tools: shared by all stages.
        context: of the imaginations, with the stage's part of the parameters.
    """

    parameters: Parameters
    result: Callable[[str], Any]
    source: str
    folder: Path | None
    scan_facts: dict[str, Any]
    tools: Tools
    context: ImaginationContext

    @property
    def surface(self) -> Reconstruction | GivenMesh:
        """The object's surface, reconstructed or given."""
        found: Reconstruction | GivenMesh = self.result(self.source)
        return found

    def heard(self, result: Any, warnings: list[str]) -> Any:
        """Pass a task's warnings on, and return its result."""
        for sentence in warnings:
            self.tools.reporter.warn(sentence)
        return result


class Result(Protocol):
    """What a stage hands on, as far as the pipeline is concerned."""

    def save(self, folder: Path) -> None:
        """Write it into an empty folder."""


def _nothing_ahead(_: Given) -> None:
    """Most stages cannot begin before all their inputs are there."""


@dataclass(frozen=True)
class InWorkers:
    """A stage that is nothing but tasks: with others of its kind it can share the workers.

    Attributes:
        tasks: what is to be computed; nothing if the result is there already.
        result: makes the stage's result of theirs, in their order.
    """

    tasks: Callable[[Given], Sequence[Task]]
    result: Callable[[Given, Sequence[Any]], Result]


@dataclass(frozen=True)
class StageRun:
    """How one stage runs.

    Attributes:
        run: makes the result; none is a result, too: there was nothing to do.
        load: reads what the result's `save` wrote.
        ahead: lets processors that the stage's last input leaves idle begin with it.
    """

    run: Callable[[Given], Result | None] | InWorkers
    load: Callable[[Path], Any]
    ahead: Callable[[Given], None] = _nothing_ahead


def _given(_: Given) -> Result | None:
    """What comes from outside is imported, not run."""
    raise ValueError("a given stage is not run")


def run_in_workers(given: Mapping[str, Given], runner: TaskRunner, reporter: Reporter) -> list[list[Any]]:
    """Run the tasks of stages that are `InWorkers`, all at once; return what each one's tasks returned."""
    tasks = [_in_workers(name).tasks(one) for name, one in given.items()]
    together = [*chain(*tasks)]
    *_, last = given
    done = iter(runner.run(together, last, reporter) if together else ())
    return [list(islice(done, len(of_one))) for of_one in tasks]


def run_stage(name: str, given: Given) -> Result | None:
    """Make the result of one stage."""
    run = RUNS[name].run
    if not isinstance(run, InWorkers):
        return run(given)
    [done] = run_in_workers({name: given}, given.tools.runner, given.tools.reporter)
    return run.result(given, done)


def result_of(name: str, given: Given, done: Sequence[Any]) -> Result:
    """Make the result of a stage of what its tasks returned."""
    return _in_workers(name).result(given, done)


def _in_workers(name: str) -> InWorkers:
    run = RUNS[name].run
    if not isinstance(run, InWorkers):
        raise TypeError(f"the stage '{name}' is more than tasks")
    return run


def _heard(given: Given, done: Sequence[tuple[Any, list[str]]]) -> Any:
    """The result of one task that returns its warnings, too."""
    return given.heard(*done[0])


def _reconstruction_tasks(given: Given) -> list[Task]:
    assert given.folder is not None, "a scan is read from its session"
    return [Task(reconstruction_job, (given.folder / SCAN, given.parameters.reconstruction))]


def _quality_tasks(given: Given) -> list[Task]:
    assert given.folder is not None, "a scan is read from its session"
    folders = given.folder / SCAN, given.folder / "reconstruction"
    table_height_m = given.scan_facts.get("table_height_m")
    return [Task(quality_job, (*folders, given.parameters.reconstruction, table_height_m))]


def _color_tasks(given: Given) -> list[Task]:
    assert given.folder is not None, "a scan is read from its session"
    return [Task(colors_job, (given.folder / SCAN, given.folder / "reconstruction"))]


def _collision_tasks(given: Given) -> list[Task]:
    """Make the body, and simplify what a scan allows as well: the hollow one finely, to find its volume."""
    surface, settings = given.surface, given.parameters.collision
    if _given_parts(given) is not None:
        return []
    unseen = surface.unseen if isinstance(surface, Reconstruction) else None
    tasks = [Task(collision_job, (surface.mesh, settings))]
    if unseen is not None and unseen.leaky is not None:
        tasks.append(Task(simplify, (unseen.leaky, settings.max_faces)))
    if unseen is not None:
        tasks.append(Task(simplify_finely, (unseen.roomy, settings.max_faces)))
    return tasks


def _given_parts(given: Given) -> CollisionModel | None:
    """The convex parts that came with a mesh, where they are wanted."""
    surface = given.surface
    is_wanted = given.parameters.collision.method != "exact"
    return surface.parts if isinstance(surface, GivenMesh) and is_wanted else None


def _collision_model(given: Given, done: Sequence[Any]) -> CollisionModel:
    surface, parts = given.surface, _given_parts(given)
    if parts is not None:
        return parts
    model: CollisionModel = given.heard(*done[0])
    if not isinstance(surface, Reconstruction):
        return model
    if surface.unseen is not None:
        *leaky, roomy = done[1:]
        model = replace(model, unseen=UnseenReadings(surface.unseen.unseen_ml, roomy, *leaky))
    return replace(model, surface_error_m=surface.surface_error_m)


def _drop(given: Given) -> Drop:
    return imagine_drop(given.context, given.result("collision"))


def _judge(given: Given) -> Judgement:
    return judge(given.context, _with_details(given), given.result("containability"))


def _judge_ahead(given: Given) -> None:
    judge_ahead(given.context, _with_details(given))


def _with_details(given: Given) -> CollisionModel:
    model: CollisionModel = given.result("collision")
    return replace(model, detailed=given.surface.mesh)


def _tilt(given: Given) -> Retention | None:
    drop: Drop = given.result("containability")
    if given.parameters.containability.verdict == "omega" or drop.footprint is None:
        return None
    return imagine_retention(given.context, given.result("collision"), drop)


def _plan_amount(given: Given) -> PlannedAmount:
    return plan_amount(given.result("judgement").capacity, given.parameters)


def _pour(given: Given) -> PourGrid | None:
    drop: Drop = given.result("containability")
    found = given.result("judgement").of(drop)
    if not found.is_open_container or drop.footprint is None:
        return None
    planned: PlannedAmount = given.result("amount")
    context = given.context.reading(with_n_pour(given.parameters, planned.n_pour))
    n_cups = len(planned.n_per_cup)
    return imagine_pours(context, given.result("collision"), drop.footprint, given.tools.cup_runs, n_cups)


def _try_pours(given: Given) -> Tries:
    grid: PourGrid | None = given.result("pouring")
    if grid is None:
        return Tries(None, None)
    context = given.context.reading(parameters_of_tries(given, grid))
    return try_pours(context, given.result("collision"), grid, given.tools.cup_runs)


def _judge_motions(given: Given) -> PourMotions | None:
    grid: PourGrid | None = given.result("pouring")
    tries: Tries = given.result("risk")
    if grid is None or tries.choice is None:
        return None
    cell = given.tools.cell
    assert cell is not None, "motions are those of a cell's arm"
    parameters = parameters_of_tries(given, grid)
    free_choice, pouring = tries.choice, parameters.pouring
    pours = judge_pours(
        cell,
        given.result("containability").aabb_m,
        grid.theta_rad,
        grid.pivot_m,
        pouring,
        np.array(cell.home_rad),
        given.tools.runner,
        given.tools.reporter,
    )
    feasible = feasible_pours(pours, grid)
    if feasible[free_choice.i, free_choice.j]:
        return PourMotions(pours, free_choice, free_choice, None)
    # Further tries of pours that the arm can make, until one is sure.
    context, model = given.context.reading(parameters), given.result("collision")
    risk = imagine_risk(context, model, grid, given.tools.cup_runs, tries.risk, feasible)
    return PourMotions(pours, choose_pour(grid, pouring.cup, feasible, risk), free_choice, risk)


def _render(given: Given) -> Evidence:
    drop, grid = given.result("containability"), given.result("pouring")
    parameters = given.parameters if grid is None else with_n_pour(given.parameters, grid.n_pour)
    return render_evidence(
        given.surface.mesh,
        cup_surface(parameters.pouring.cup),
        parameters,
        given.result("judgement").of(drop),
        grid,
        given.result("risk").choice,
        given.tools.runner,
        given.tools.reporter,
        given.tools.early,
    )


def parameters_of_tries(given: Given, grid: PourGrid) -> Parameters:
    """Return what pours are tried with: the imagined N_pour, and errors that this scan's poses leave."""
    parameters, surface = with_n_pour(given.parameters, grid.n_pour), given.surface
    if not isinstance(surface, Reconstruction):
        return parameters
    health = surface.pose_health
    parameters = with_scan_error(parameters, health.sd_height_m, len(health.views))
    return with_camera_error(parameters, *(_known_error(given.scan_facts, name) for name in CAMERA_ERRORS))


def _known_error(facts: dict[str, Any], name: str) -> float:
    """An error in a scan's record; none where it is not known: a scan from elsewhere, or an older one."""
    value = facts.get(name, 0.0)
    is_error = isinstance(value, int | float) and 0 <= value <= _LARGEST_CAMERA_ERROR
    return float(value) if is_error else 0.0


def with_n_pour(parameters: Parameters, n_pour: int) -> Parameters:
    """Return the parameters with an N_pour."""
    pouring = parameters.pouring.model_copy(update={"n_pour": n_pour})
    return parameters.model_copy(update={"pouring": pouring})


def _load_retention(folder: Path) -> Retention | None:
    return Retention.load(folder) if (folder / RETENTION_FILE).is_file() else None


def _load_pours(folder: Path) -> PourGrid | None:
    return PourGrid.load(folder) if (folder / POURS_FILE).is_file() else None


RUNS: dict[str, StageRun] = {
    MESH: StageRun(_given, GivenMesh.load),
    "reconstruction": StageRun(InWorkers(_reconstruction_tasks, _heard), Reconstruction.load),
    "quality": StageRun(InWorkers(_quality_tasks, _heard), ScanQuality.load),
    "colors": StageRun(InWorkers(_color_tasks, _heard), ModelColors.load),
    "collision": StageRun(InWorkers(_collision_tasks, _collision_model), CollisionModel.load),
    "containability": StageRun(_drop, Drop.load),
    "judgement": StageRun(_judge, Judgement.load, _judge_ahead),
    "amount": StageRun(_plan_amount, PlannedAmount.load),
    "pouring": StageRun(_pour, _load_pours),
    "risk": StageRun(_try_pours, Tries.load),
    "retention": StageRun(_tilt, _load_retention),
    "motion": StageRun(_judge_motions, PourMotions.load),
    "evidence": StageRun(_render, Evidence.load),
}
"""By the stages' names; a test asserts that these are those of the table."""
