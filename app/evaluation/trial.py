"""One trial: an object is scanned, judged, and poured into in the truth world, all in one process."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from time import perf_counter
from typing import Any, TypeVar

from app.evaluation.standing import Input, StandingObject, known_surface, mesh_of_content, stand
from app.evaluation.truth import pour_into
from core.collision import CollisionModel, build_collision_model
from core.errors import Cancelled, PoursightError
from core.evaluation.labels import Label
from core.evaluation.trials import Trial
from core.evaluation.variants import Variant
from core.imagination.choice import choose_pour
from core.imagination.cup_runs import CupRuns
from core.imagination.imagine import imagine_containability, imagine_grid, imagine_grid_risk
from core.imagination.judging import judge
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.results import PourRisk
from core.imagination.verdict import Verdict
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.parameters.imagination import ContainabilityParameters
from core.workers import RunHere, WorkerReporter
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_T = TypeVar("_T")
_PICTURE_PX = (320, 240)


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
        outcome: settings of the truth world.
        n_pours: pours in the truth world; 0: the object is judged and no pour is imagined.
    """

    name: str
    label: Label
    is_restricted: bool
    content: bytes
    ending: str
    source: Input
    parameters: Parameters
    variants: tuple[Variant, ...]
    outcome: OutcomeSettings
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


def _try(work: _Work, variant: Variant) -> tuple[Trial, bytes | None]:
    task = work.task
    parameters = variant.of(task.parameters)
    work.seconds = {}
    facts: dict[str, Any] = {
        "name": task.name,
        "label": task.label,
        "seed": parameters.seed,
        "variant": variant.name,
        "threshold": parameters.containability.deciding_threshold,
        "n_pour": parameters.pouring.n_pour,
        "is_restricted": task.is_restricted,
    }
    picture = None
    try:
        found = work.judged(parameters)
        facts |= {"n_drop": found.n_drop, "n_in": found.n_in} | _of_verdict(found.verdict)
        facts["picture"] = f"{task.name}.{parameters.seed}.{variant.name}.png"
        picture = work.picture(parameters, found)
        if task.n_pours > 0 and found.is_open_container:
            facts |= work.poured(parameters, found)
    except Cancelled:
        raise
    except PoursightError as error:
        facts["problem"] = str(error)
    except Exception as error:  # one object must not end the run of all others
        facts["problem"] = f"A fault of the program ended this ({type(error).__name__}: {error})."
    return Trial(**facts, seconds=work.seconds), picture


def _of_verdict(verdict: Verdict | None) -> dict[str, Any]:
    """What a trial tells of a verdict by what the object holds."""
    if verdict is None:
        return {}
    return {
        "capacity_share": verdict.capacity_share,
        "capacity_candies": verdict.n_candies,
        "capacity_ml": verdict.volume_ml,
        "holds_rad": verdict.holds_rad,
    }


class _Work:
    """The stages of one trial; what several variants share is computed once."""

    def __init__(self, task: TrialTask) -> None:
        self.task = task
        self.seconds: dict[str, float] = {}
        self._reporter = WorkerReporter()
        self._runner = RunHere()
        self._known: dict[object, Any] = {}

    def judged(self, parameters: Parameters) -> Containability:
        """Let candies drop (Sec. III-A), and judge by Omega or by what the object holds."""
        model, settings = self._model(parameters), parameters.containability
        drop = _drop_of(settings)
        found = self._once(
            "containability",
            ("containability", parameters.collision, drop),
            lambda: imagine_containability(model, parameters),
        )
        found = replace(found, omega_threshold=settings.omega_threshold)
        if settings.verdict == "omega":
            return found
        key = "verdict", parameters.collision, drop, settings.capacity_threshold
        judged = self._once(
            "verdict", key, lambda: judge(model, found, parameters, self._runner, self._reporter)
        )
        return judged.containability

    def poured(self, parameters: Parameters, found: Containability) -> dict[str, Any]:
        """Imagine the pours, choose, and pour in the truth world; returns facts of the trial."""
        grid, risk, choice = self._chosen(parameters, found)
        outcomes = self._once(
            "outcome",
            ("outcome", parameters.pouring, choice.i, choice.j, choice.theta_rad, *choice.pivot_m.tolist()),
            lambda: pour_into(
                self._standing(),
                choice,
                parameters.pouring,
                self.task.outcome.model_copy(update={"seed": parameters.seed}),
                self.task.n_pours,
                self._runner,
                self._reporter,
            ),
        )
        return {
            "p_chosen": float(grid.p[choice.i, choice.j]),
            "clean_at_least": None if risk is None else float(risk.clean_at_least[choice.i, choice.j]),
            "n_tries": 0 if risk is None else int(risk.n_tries.sum()),
            "choice": (choice.i, choice.j),
            "theta_rad": choice.theta_rad,
            "spilled": tuple(outcome.n_spilled for outcome in outcomes),
            "in_cup": tuple(outcome.n_in_cup for outcome in outcomes),
        }

    def picture(self, parameters: Parameters, found: Containability) -> bytes:
        """Draw the object as it is known, with the candies that stayed."""
        from app.library.shading import shaded_picture

        at_end = found.recording.positions_m[-1][found.retained]
        radius_m = parameters.particle.diameter_m / 2
        surface = self._model(parameters).surface
        drawn = shaded_picture(surface, _PICTURE_PX, at_end.astype(float), radius_m)
        out = io.BytesIO()
        drawn.save(out, "PNG")
        return out.getvalue()

    def _chosen(
        self, parameters: Parameters, found: Containability
    ) -> tuple[PourGrid, PourRisk | None, PourChoice]:
        """Imagine the pours and their risk, and choose."""
        model = self._model(parameters)
        # What the cup does is the same for every body of the object.
        runs = _cup_runs(parameters.model_copy(update={"collision": Parameters().collision}))
        where = self._runner, self._reporter
        key = parameters.collision, _drop_of(parameters.containability), parameters.pouring
        grid = self._once(
            "pouring", ("pouring", *key), lambda: imagine_grid(model, found, runs, parameters, *where)
        )
        risk = self._once(
            "risk",
            ("risk", *key, parameters.risk),
            lambda: imagine_grid_risk(model, grid, runs, parameters, *where),
        )
        choice = choose_pour(grid, parameters.pouring.cup, risk=risk)
        if choice is None:
            raise AssertionError("without an arm every pour is feasible")
        return grid, risk, choice

    def _model(self, parameters: Parameters) -> CollisionModel:
        surface = self._surface(parameters)
        return self._once(
            "collision",
            ("collision", parameters.collision),
            lambda: build_collision_model(surface, parameters.collision, self._reporter),
        )

    def _surface(self, parameters: Parameters) -> TriangleMesh:
        standing, task = self._standing(), self.task
        return self._once(
            "scan",
            "surface",
            lambda: known_surface(self._mesh(), standing, task.source, parameters, self._reporter),
        )

    def _standing(self) -> StandingObject:
        mesh = self._mesh()
        return self._once(
            "scan", "standing", lambda: stand(mesh, self.task.source, self.task.parameters.seed)
        )

    def _mesh(self) -> TriangleMesh:
        return self._once("mesh", "mesh", lambda: mesh_of_content(self.task.content, self.task.ending))

    def _once(self, stage: str, key: object, make: Callable[[], _T]) -> _T:
        if key not in self._known:
            began_s = perf_counter()
            self._known[key] = make()
            self.seconds[stage] = self.seconds.get(stage, 0.0) + perf_counter() - began_s
        found: _T = self._known[key]
        return found


def _drop_of(settings: ContainabilityParameters) -> ContainabilityParameters:
    """The settings of the drop alone: what is concluded from it is left out."""
    same = {"omega_threshold": 0.0, "verdict": "omega", "capacity_threshold": 0.0}
    return settings.model_copy(update=same)


@lru_cache(maxsize=8)
def _cup_runs(parameters: Parameters) -> CupRuns:
    """The cup alone knows no object: objects with the same seed share its runs."""
    return CupRuns(parameters)
