"""What each choice of the default preset is worth: objects scanned once, judged in several ways.

Usage: python -m tests.benchmarks.choices [--seed N] [--pick NAME ...]
Accuracy is that of the usual threshold and of the one that the calibration objects give. The pours are
those that the paper's rule chooses from the plain 24, each made three times in the ground-truth
simulation: choosing by risk would hide what a choice does to them. Choices that
concern the drop alone have no pours of their own.
Seconds are those of one core, so that other work on the machine hardly counts.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from math import radians
from pathlib import Path
from statistics import fmean
from time import process_time
from typing import Any

from app.operations.evaluation.ground_truth import ideal_path, pour_into
from app.operations.evaluation.placed_object import PlacedObject, cell_for, place_object
from core.collision import CollisionModel, build_collision_model
from core.errors import PoursightError
from core.evaluation.fitting.scores import best_threshold
from core.evaluation.labels import LabelledObject, read_labels
from core.evaluation.statistics import Figures
from core.evaluation.trials import Trial
from core.imagination.choice import choose_pour
from core.imagination.context import ImaginationContext
from core.imagination.cup_runs import CupRuns
from core.imagination.drop import imagine_drop
from core.imagination.imagination import WORKER_MODULE
from core.imagination.judgement import capacity_share
from core.imagination.pours import imagine_pours
from core.imagination.results import Footprint
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.workers import RunHere, Task, WorkerPool
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.pour_outcome.settings import OutcomeSettings

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"

N_POURS = 3
_MINI = {
    "particle.shape": "cylinder",
    "particle.diameter_m": 0.007,
    "particle.height_m": 0.0028,
    "particle.mass_kg": 0.0003,
}
_CONTACT = "containability.contact."
CHOICES: dict[str, dict[str, Any]] = {
    "default": {},
    "the released code's drop": {
        **_MINI,
        "containability.rotation_rad": radians(3),
        "containability.counted": "centre",
        f"{_CONTACT}lateral_friction": 0.005,
        f"{_CONTACT}spinning_friction": 0.5,
        f"{_CONTACT}rolling_friction": 0.5,
    },
    "its candy": _MINI,
    "tilt 3 degrees": {"containability.rotation_rad": radians(3)},
    "tilt 20 degrees": {"containability.rotation_rad": radians(20)},
    "friction 0.05": {f"{_CONTACT}lateral_friction": 0.05},
    "friction 0.35": {f"{_CONTACT}lateral_friction": 0.35},
    "centre counts": {"containability.counted": "centre"},
    "no perturbation": {"containability.rotation_rad": 0.0, "containability.translation_m_s2": 0.0},
    "convex parts (V-HACD)": {"collision.method": "vhacd"},
    "at most 1000 faces": {"collision.max_faces": 1000},
    "no substeps": {"solver.substeps": 1},
    "10 iterations": {"solver.iterations": 10},
    "voxels of 3 mm": {"reconstruction.voxel_m": 0.003},
    "unseen is free": {"reconstruction.unseen": "free"},
}


def judge(one: LabelledObject, seed: int, names: tuple[str, ...]) -> dict[str, Trial]:
    """Scan an object once and judge it by each choice, in a worker."""
    mesh = read_mesh(one.mesh, Reporter())
    placed = place_object(mesh, "scan", seed)
    scan = simulate_scan(mesh, seed, Reporter(), cell=cell_for(mesh))
    surfaces: dict[object, TriangleMesh] = {}
    trials = {}
    for name in names:
        parameters = apply_settings(Parameters(), {"seed": seed, **CHOICES[name]})
        began_s = process_time()
        trial = Trial(one.name, one.label, seed, name, parameters.containability.capacity_threshold)
        try:
            key = parameters.reconstruction
            if key not in surfaces:
                surfaces[key] = reconstruct(scan, key, Reporter()).mesh
            model = build_collision_model(surfaces[key], parameters.collision, Reporter())
            context = ImaginationContext(parameters, RunHere(), Reporter())
            drop = imagine_drop(context, model)
            dropped_s = process_time()
            share = capacity_share(context, model, drop)
            seconds = {"drop": dropped_s - began_s, "filling": process_time() - dropped_s}
            trial = replace(trial, n_drop=drop.n_drop, n_in=drop.n_in, capacity_share=share, seconds=seconds)
            if one.label == "container" and drop.footprint is not None and changes_pours(name):
                trial = pour(trial, context, model, drop.footprint, placed)
        except PoursightError as error:
            trial = replace(trial, problem=str(error))
        trials[name] = trial
    return trials


def changes_pours(name: str) -> bool:
    """Whether a choice concerns more than the drop."""
    return name == "default" or any(not key.startswith("containability.") for key in CHOICES[name])


def pour(
    trial: Trial,
    context: ImaginationContext,
    model: CollisionModel,
    footprint: Footprint,
    placed: PlacedObject,
) -> Trial:
    """Imagine the plain 24, choose by the paper's rule, and pour in the ground-truth simulation."""
    began_s, parameters = process_time(), context.parameters
    grid = imagine_pours(context, model, footprint, CupRuns())
    seconds = trial.seconds | {"pouring": process_time() - began_s}
    choice = choose_pour(grid, parameters.pouring.cup)
    if choice is None:
        raise AssertionError("without an arm every pour is feasible")
    outcome = OutcomeSettings(seed=parameters.seed)
    path = ideal_path(parameters.pouring, choice.pivot_m, choice.theta_rad)
    poured = pour_into(placed, path, parameters.pouring, [outcome], N_POURS, RunHere(), Reporter())
    return replace(trial, seconds=seconds, spilled=tuple(one.n_spilled for one in poured))


def summary(name: str, trials: Sequence[Trial], calibration: frozenset[str]) -> str:
    """Return a row of the table in docs/decisions/0013."""
    settings = Parameters().containability
    by_omega = [replace(trial, capacity_share=None) for trial in trials]
    seconds = [fmean(trial.seconds.get(stage, 0.0) for trial in trials) for stage in ("drop", "filling")]
    cells = [
        name,
        *measure_cells(trials, settings.capacity_threshold, calibration),
        *measure_cells(by_omega, settings.omega_threshold, calibration),
        *(f"{one:.1f}" for one in seconds),
        *pour_cells(trials),
    ]
    return f"| {' | '.join(cells)} |"


def pour_cells(trials: Sequence[Trial]) -> list[str]:
    """Return how many pours spilled nothing, and seconds for the plain 24."""
    poured = [trial for trial in trials if trial.spilled]
    if not poured:
        return ["-", "-"]
    clean = sum(n == 0 for trial in poured for n in trial.spilled)
    seconds = fmean(trial.seconds["pouring"] for trial in poured)
    return [f"{clean} of {N_POURS * len(poured)}", f"{seconds:.1f}"]


def measure_cells(trials: Sequence[Trial], usual: float, calibration: frozenset[str]) -> list[str]:
    """Return right with the usual threshold, with the calibrated one, AUC, least container, most other."""
    fitted = Figures.of((trial for trial in trials if trial.name in calibration), 0).margin
    least, most = fitted.smallest_container, fitted.largest_other
    calibrated = best_threshold([least[0]], [most[0]]) if least is not None and most is not None else usual
    others = [trial for trial in trials if trial.name not in calibration]
    figures = Figures.of(trials, 0)
    ends = (figures.margin.smallest_container, figures.margin.largest_other)
    return [
        f"{right(usual, trials)} / {right(usual, others)}",
        f"{right(calibrated, trials)} / {right(calibrated, others)} ({calibrated:.3f})",
        "-" if figures.auc is None else f"{100 * figures.auc:.2f}",
        *(f"{end[0]:.3f} {end[1]}" if end else "-" for end in ends),
    ]


def right(threshold: float, trials: Sequence[Trial]) -> str:
    """Return the share judged rightly, in per cent; what failed is not right."""
    held = Figures.of((replace(one, threshold=threshold) for one in trials), 0)
    return f"{100 * (held.accuracy.value or 0):.1f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--pick", nargs="*", default=list(CHOICES))
    chosen = parser.parse_args()
    objects = [one for one in read_labels(OBJECTS) if one.label != "ambiguous"]
    calibration = frozenset(one.name for one in objects if one.is_calibration)
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE)
        tasks = [Task(judge, (one, chosen.seed, tuple(chosen.pick))) for one in objects]
        results = pool.run(tasks, "judging", Reporter())
    heads = ("all / other 30", "calibrated on 11", "AUC", "least container", "most other")
    both = [f"{measure}: {head}" for measure in ("share", "Omega") for head in heads]
    print(f"| choice | {' | '.join(both)} | drop s | filling s | clean pours | 24 pours s |")
    print(f"|{(len(both) + 5) * '---|'}")
    for name in chosen.pick:
        print(summary(name, [result[name] for result in results], calibration), flush=True)


if __name__ == "__main__":
    main()
