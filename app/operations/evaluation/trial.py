"""One trial: an object is scanned, judged, and poured into in the ground-truth simulation, in one process."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import cycle, islice
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from app.operations.evaluation.by_looks import LookedAt, touches
from app.operations.evaluation.ground_truth import ideal_path, planned_path, pour_into
from app.operations.evaluation.placed_object import (
    Input,
    PlacedObject,
    cell_for,
    mesh_of_content,
    place_object,
    take_scan,
)
from core.appearance.looking import CONTAINS
from core.appearance.pouring import THETA_RAD, above_box, at_offset
from core.errors import Cancelled, InputError, PoursightError
from core.evaluation.labels import Label
from core.evaluation.trials import Trial
from core.evaluation.variants import Variant
from core.geometry import FloatArray
from core.imagination.cup_runs import CupRuns
from core.imagination.judgement import Judgement
from core.imagination.results import Containability, Drop, PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.imagination.risk.tries import Tries
from core.imagination.verdict import Verdict
from core.mesh import TriangleMesh
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourMotions
from core.parameters import Parameters, apply_settings
from core.parameters.imagination import PouringParameters
from core.pipeline.given_mesh import GivenMesh
from core.pipeline.in_memory import StageMemory
from core.pipeline.running import Tools, with_n_pour
from core.reconstruction.result import Reconstruction
from core.reconstruction.stage import reconstruct
from core.scan.model import Scan
from core.workers import RunHere, WorkerReporter
from hardware.cell.scene import pour_cell
from hardware.simulation.pour_outcome.driven_path import DrivenPath
from hardware.simulation.pour_outcome.outcome import TableOutcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_T = TypeVar("_T")
_PICTURE_PX = (320, 240)
_TIMED = ("collision", "containability", "judgement", "pouring", "risk", "retention", "motion")
_BY_OMEGA = {
    "containability.verdict": "omega",
    "containability.omega_threshold": 0.0,
    "containability.capacity_threshold": Parameters().containability.capacity_threshold,
    "pouring.amount": "number",
}
"""Pours of N_pour into an object that is known to be a container: variants that differ only in the Omega that
they ask for share them."""


@dataclass(frozen=True)
class TrialTask:
    """What a worker needs to know, wherever it runs: no path, no file of this machine.

    Attributes:
        name: the object's.
        label: what a person calls it.
        is_restricted: whether it belongs to the restricted set.
        content: of the mesh's file.
        ending: of the mesh's file, such as ".obj".
        source: whether the object is scanned or its mesh is known.
        parameters: of the method; their seed is the trial's.
        variants: to be tried, the first one first.
        worlds: settings of the ground-truth worlds by name, which pours go to in turn.
        n_pours: pours in all of them; 0: the object is judged and no pour is imagined.
    """

    name: str
    label: Label
    is_restricted: bool
    content: bytes
    ending: str
    source: Input
    parameters: Parameters
    variants: tuple[Variant, ...]
    worlds: Mapping[str, OutcomeSettings]
    n_pours: int


@dataclass(frozen=True)
class TrialResult:
    """What a worker hands back: a trial for each variant, and their pictures (PNG) by file name."""

    trials: tuple[Trial, ...]
    pictures: dict[str, bytes] = field(default_factory=dict)


def run_trial(task: TrialTask) -> TrialResult:
    """Do one trial; what goes wrong becomes the trial's problem.

    The same task gives the same result but for the seconds, in any process and after any other task.

    Raises:
        Cancelled: somebody asked to stop.
    """
    trials, pictures = [], {}
    work = _Work(task)
    for variant in task.variants:
        trial, picture = _try(work, variant)
        trials.append(trial)
        if picture is not None:
            pictures[trial.picture] = picture
    return TrialResult(tuple(trials), pictures)


def fault_sentence(error: BaseException) -> str:
    """Return the problem of a trial that raised what it should not have."""
    return f"A fault of the program ended this ({type(error).__name__}: {error})."


def given_up(task: TrialTask, problem: str) -> TrialResult:
    """Return a result that has nothing but its problem, a sentence, for each variant."""
    return TrialResult(tuple(Trial(**_facts(task, one), problem=problem) for one in task.variants))


def _facts(task: TrialTask, variant: Variant) -> dict[str, Any]:
    """What is known of a trial before it is made."""
    parameters = variant.of(task.parameters)
    by_physics = parameters.containability.deciding_threshold
    return {
        "name": task.name,
        "label": task.label,
        "seed": parameters.seed,
        "variant": variant.name,
        "threshold": CONTAINS if variant.by_looks else by_physics,
        "n_pour": parameters.pouring.n_pour,
        "is_restricted": task.is_restricted,
    }


def _try(work: _Work, variant: Variant) -> tuple[Trial, bytes | None]:
    task = work.task
    work.begin_variant()
    parameters = variant.of(task.parameters)
    facts = _facts(task, variant)
    picture = None
    try:
        picture = (_look if variant.by_looks else _imagine)(work, variant, parameters, facts)
        facts["picture"] = f"{task.name}.{parameters.seed}.{variant.name}.png"
    except Cancelled:
        raise
    except PoursightError as error:
        facts["problem"] = str(error)
    except Exception as error:  # one object must not end the run of all others
        facts["problem"] = fault_sentence(error)
    return Trial(**facts, seconds=work.seconds), picture


def _imagine(work: _Work, variant: Variant, parameters: Parameters, facts: dict[str, Any]) -> bytes:
    """Judge and pour by imagination, adding to the facts; returns the picture."""
    found = work.judged(parameters)
    facts |= {"n_drop": found.n_drop, "n_in": found.n_in} | _of_verdict(found.verdict)
    picture = work.picture(parameters, found)
    if work.task.n_pours > 0 and found.is_open_container:
        facts |= work.poured(parameters, variant.has_arm)
        facts["holds_rad"] = work.holds_rad(parameters)
    return picture


def _look(work: _Work, variant: Variant, parameters: Parameters, facts: dict[str, Any]) -> bytes:
    """Judge and pour by looks, adding to the facts; returns the picture.

    It is poured wherever something contains, whatever the object was judged (Sec. V-B).
    """
    found = work.looked_at(parameters)
    facts |= found.facts
    if work.task.n_pours > 0 and found.point_m is not None:
        if variant.by_looks == "offset":
            pivot_m = at_offset(found.point_m)
        else:
            pivot_m = above_box(found.point_m, work.scanned_aabb_m(), parameters.pouring.pivot_height_m)
        facts |= work.poured_by_looks(parameters, pivot_m)
    return found.picture()


def _of_verdict(verdict: Verdict | None) -> dict[str, Any]:
    """The facts of a verdict by capacity."""
    if verdict is None:
        return {}
    return {
        "capacity_share": verdict.capacity_share,
        "capacity_candies": verdict.level_candies,
        "capacity_ml": verdict.level_ml,
        "capacity_least_ml": verdict.least_ml,
        "capacity_most_ml": verdict.most_ml,
        "unseen_ml": verdict.unseen_ml if verdict.is_undecided else None,
    }


class _Work:
    """The stages of one trial; what several variants share is computed once."""

    def __init__(self, task: TrialTask) -> None:
        self.task = task
        self._reporter = WorkerReporter()
        self._runner = RunHere()
        self._seconds: dict[str, float] = {}
        self._known: dict[object, Any] = {}
        self._memory: StageMemory | None = None

    def begin_variant(self) -> None:
        """Forget the seconds of the variant before."""
        self._seconds = {}
        if self._memory is not None:
            self._memory.seconds.clear()

    @property
    def seconds(self) -> dict[str, float]:
        """What this variant took, by stage; what it shares with one before took nothing."""
        imagined = {} if self._memory is None else self._memory.seconds
        return self._seconds | {name: imagined[name] for name in _TIMED if name in imagined}

    def judged(self, parameters: Parameters) -> Containability:
        """Let candies drop (Sec. III-A), and judge by Omega or by what the object holds."""
        memory = self._stages()
        drop: Drop = memory.result("containability", parameters)
        judgement: Judgement = memory.result("judgement", parameters)
        return judgement.of(drop)

    def holds_rad(self, parameters: Parameters) -> float | None:
        """Tilt the object; returns the tilt up to which nothing leaves, none if that was not imagined."""
        found: Retention | None = self._stages().result("retention", parameters)
        return None if found is None else found.holds_rad

    def poured(self, parameters: Parameters, has_arm: bool) -> dict[str, Any]:
        """Imagine the pours, choose, and pour in the ground-truth simulation; returns facts of the trial.

        An arm that can make none of the pours makes none.
        """
        by_omega = parameters.containability.verdict == "omega"
        pours = apply_settings(parameters, _BY_OMEGA) if by_omega else parameters
        grid: PourGrid = self._stages().result("pouring", pours)
        tries: Tries = self._stages().result("risk", pours)
        risk, choice = tries.risk, tries.choice
        facts: dict[str, Any] = {"n_pour": grid.n_pour}
        if has_arm:
            motions: PourMotions = self._stages().result("motion", pours)
            risk, choice = motions.risk or risk, motions.choice
            facts["n_feasible"] = motions.n_feasible
        if choice is None:
            return facts
        chosen, pouring = choice, with_n_pour(parameters, grid.n_pour).pouring
        outcomes = self._outcomes(
            ("imagined", has_arm, pouring, choice.i, choice.j, choice.theta_rad, *choice.pivot_m.tolist()),
            lambda: self._path(pours, chosen, has_arm),
            parameters.seed,
            pouring,
        )
        return facts | {
            "p_chosen": float(grid.p[choice.i, choice.j]),
            "clean_at_least": None if risk is None else float(risk.clean_at_least[choice.i, choice.j]),
            "wanted_clean": None if risk is None else parameters.risk.wanted_clean,
            "n_tries": 0 if risk is None else int(risk.n_tries.sum()),
            "choice": (choice.i, choice.j),
            "theta_rad": choice.theta_rad,
            **self._of_outcomes(outcomes),
        }

    def _outcomes(
        self, key: object, path: Callable[[], DrivenPath], seed: int, pouring: PouringParameters
    ) -> list[TableOutcome]:
        """Pour along a path into all worlds in turn, once for all variants whose pours are the same."""
        worlds = [one.model_copy(update={"seed": seed}) for one in self.task.worlds.values()]
        return self._once(
            "outcome",
            key,
            lambda: pour_into(
                self._placed(), path(), pouring, worlds, self.task.n_pours, self._runner, self._reporter
            ),
        )

    def _of_outcomes(self, outcomes: Sequence[TableOutcome]) -> dict[str, Any]:
        return {
            "worlds": tuple(islice(cycle(self.task.worlds), len(outcomes))),
            "spilled": tuple(outcome.n_spilled for outcome in outcomes),
            "in_cup": tuple(outcome.n_in_cup for outcome in outcomes),
        }

    def looked_at(self, parameters: Parameters) -> LookedAt:
        """Look at the scan's colour images.

        Raises:
            InputError: there are none.
        """
        if self.task.source == "mesh":
            raise InputError("Looks need images; evaluate with '--input scan'.")
        scan = self._scan()
        return self._once("appearance", "looked at", lambda: LookedAt.of(scan, parameters.reconstruction))

    def scanned_aabb_m(self) -> FloatArray:
        """Lower and upper corner (2, 3) of the reconstructed object."""
        mesh = self._surface().mesh
        return np.array([mesh.aabb_min_m, mesh.aabb_max_m])

    def poured_by_looks(self, parameters: Parameters, pivot_m: FloatArray) -> dict[str, Any]:
        """Pour N_pour candies in the ground-truth simulation, unless the cup would touch the object."""
        pouring = parameters.pouring
        path = ideal_path(pouring, pivot_m, THETA_RAD)
        facts: dict[str, Any] = {"theta_rad": THETA_RAD, "n_feasible": 0}
        if touches(path, pouring.cup, self._placed().true):
            return facts
        outcomes = self._outcomes(
            ("looks", pouring, *pivot_m.tolist()), lambda: path, parameters.seed, pouring
        )
        return facts | {"n_feasible": 1} | self._of_outcomes(outcomes)

    def _path(self, pours: Parameters, choice: PourChoice, has_arm: bool) -> DrivenPath:
        """The cup's: as this object's cell drives it, or as imagined."""
        if not has_arm:
            return ideal_path(pours.pouring, choice.pivot_m, choice.theta_rad)
        drop: Drop = self._stages().result("containability", pours)
        return planned_path(self._cell(), drop.aabb_m, choice, pours.pouring)

    def picture(self, parameters: Parameters, found: Containability) -> bytes:
        """Draw the object as it is known, with the candies that stayed."""
        from core.mesh_picture import shaded_picture

        at_end = found.recording.positions_m[-1][found.retained]
        radius_m = parameters.particle.diameter_m / 2
        surface = self._stages().result("collision", parameters).surface
        drawn = shaded_picture(surface, _PICTURE_PX, at_end.astype(float), radius_m)
        out = io.BytesIO()
        drawn.save(out, "PNG")
        return out.getvalue()

    def _stages(self) -> StageMemory:
        """The stages from the object's surface on; no variant changes how that is known."""
        if self._memory is None:
            cup_runs = _cup_runs(self.task.parameters.seed)
            tools = Tools(self._runner, self._reporter, cup_runs=cup_runs, cell=self._cell())
            self._memory = StageMemory(self._surface(), tools)
        return self._memory

    def _surface(self) -> Reconstruction | GivenMesh:
        """What is known of the object's surface."""
        if self.task.source == "mesh":
            placed = self._placed()
            return self._once("scan", "surface", lambda: GivenMesh(placed.true))
        scan, parameters = self._scan(), self.task.parameters.reconstruction
        return self._once("scan", "surface", lambda: reconstruct(scan, parameters, self._reporter))

    def _scan(self) -> Scan:
        mesh, seed = self._mesh(), self.task.parameters.seed
        is_seen = any(variant.by_looks for variant in self.task.variants)
        return self._once("scan", "images", lambda: take_scan(mesh, seed, self._reporter, is_lit=is_seen))

    def _placed(self) -> PlacedObject:
        mesh = self._mesh()
        return self._once(
            "scan", "placed", lambda: place_object(mesh, self.task.source, self.task.parameters.seed)
        )

    def _cell(self) -> PourCell:
        """The simulated cell in which it is scanned and poured into."""
        return pour_cell(cell_for(self._mesh()))

    def _mesh(self) -> TriangleMesh:
        return self._once("mesh", "mesh", lambda: mesh_of_content(self.task.content, self.task.ending))

    def _once(self, stage: str, key: object, make: Callable[[], _T]) -> _T:
        if key not in self._known:
            began_s = perf_counter()
            self._known[key] = make()
            self._seconds[stage] = self._seconds.get(stage, 0.0) + perf_counter() - began_s
        found: _T = self._known[key]
        return found


@lru_cache(maxsize=8)
def _cup_runs(seed: int) -> CupRuns:  # noqa: ARG001
    """The cup alone knows no object: objects with the same seed share its runs."""
    return CupRuns()
