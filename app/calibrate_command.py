"""`poursight calibrate`: parameters fitted to labelled objects, kept as a preset."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.table import Table

from app.commands import Choices
from app.evaluation.fitting.calibrating import Calibration, CalibrationWish, calibrate, chosen_parameters
from app.evaluation.fitting.preparing import prepare_targets
from app.evaluation.fitting.truth_spills import measure_spills
from app.evaluation.standing import Input
from app.listing import short
from app.presets import preset_file
from app.terminal import TerminalReporter
from core.errors import InputError
from core.evaluation.fitting.chosen import chosen_objects
from core.evaluation.fitting.containability import ContainabilityStep
from core.evaluation.fitting.fitted import threshold_name
from core.evaluation.fitting.pours import PourScore, PourStep
from core.evaluation.fitting.provenance import write_fitted_preset
from core.evaluation.fitting.spills import SpillMeasurement, read_spills, write_spills
from core.evaluation.labels import LabelledObject, read_labels
from core.evaluation.trials import measure_word
from core.evaluation.verdicts import measure_by
from core.imagination.imagine import WORKER_MODULE
from core.parameters import flatten
from core.workers import WorkerPool
from hardware.simulation.pour_outcome.settings import OutcomeSettings


@dataclass(frozen=True)
class FitChoices:
    """What to fit to what, as chosen on the command line.

    Attributes:
        source: whether objects are scanned or their meshes are known.
        n_seeds: seeds in all.
        n_trials: sets of values to try.
        parameters: `NAME` or `NAME=LOW:HIGH` of what is fitted; none: the usual ones.
        spills: a CSV of measured spills, or none.
        truth_spills: where to write spills measured in the truth world, or none.
        is_all: whether all labelled objects are taken, marked for calibration or not.
    """

    source: Input
    n_seeds: int
    n_trials: int
    parameters: list[str]
    spills: Path | None
    truth_spills: Path | None
    is_all: bool


def run(
    folder: Path,
    labels: Path | None,
    out: str,
    choices: Choices,
    fit_choices: FitChoices,
    workers: int | None,
) -> None:
    """Fit, tell the best so far on the way, and write the preset.

    Raises:
        PoursightError: something given cannot be used, or nothing was found before it was stopped.
    """
    path = _preset_path(out)
    wish = _wish(folder, labels, choices, fit_choices)
    with WorkerPool(workers) as pool, TerminalReporter() as reporter:
        pool.start(WORKER_MODULE)
        if fit_choices.truth_spills is not None:
            wish = replace(wish, spills=_measure(wish, fit_choices.truth_spills, pool, reporter))
        tell = partial(_tell, measure_word(measure_by(wish.parameters)))
        found = calibrate(wish, pool, reporter, tell, tell)
        if found.is_cut_short:
            reporter.forget_cancel()
        write_fitted_preset(path, found.parameters, found.named, found.provenance)
    if found.is_cut_short:
        print("Stopped on request; the best so far is kept.", file=sys.stderr)
    _print_result(wish, found)
    print(f"Preset: {path}")


def _preset_path(out: str) -> Path:
    """Where the preset goes: a bare name is one of the user's presets, anything else a file.

    Raises:
        InputError: the name is not possible, or there is no such folder.
    """
    path = Path(out)
    if path.name == out and path.suffix != ".json":
        return preset_file(out)
    path = path if path.suffix == ".json" else path.with_name(f"{path.name}.json")
    if not path.parent.is_dir():
        raise InputError(
            f"There is no folder {path.parent} to write the preset to; make it, or name another."
        )
    return path


def _wish(folder: Path, labels: Path | None, choices: Choices, wanted: FitChoices) -> CalibrationWish:
    preset, parameters = choices.parameters(folder)
    objects = read_labels(folder, labels)
    chosen = chosen_objects(objects, wanted.is_all)
    spills = () if wanted.spills is None else read_spills(wanted.spills)
    has_spills = bool(spills) or wanted.truth_spills is not None
    for_labels, for_spills = chosen_parameters(wanted.parameters, has_spills)
    return CalibrationWish(
        chosen,
        wanted.source,
        tuple(range(parameters.seed, parameters.seed + wanted.n_seeds)),
        parameters,
        preset,
        for_labels,
        wanted.n_trials,
        spills=spills,
        spilled_objects=_spilled_objects(objects, chosen, spills) if has_spills else (),
        fitted_to_spills=for_spills,
    )


def _spilled_objects(
    objects: tuple[LabelledObject, ...],
    chosen: tuple[LabelledObject, ...],
    spills: tuple[SpillMeasurement, ...],
) -> tuple[LabelledObject, ...]:
    """The objects that were poured into, or that will be in the truth world."""
    if not spills:
        return tuple(one for one in chosen if one.label == "container")
    known = {one.name: one for one in objects}
    unknown = next((one.name for one in spills if one.name not in known), None)
    if unknown is not None:
        raise InputError(f"Spills of '{unknown}' are given, but the labels name no such object.")
    names = dict.fromkeys(one.name for one in spills)
    return tuple(known[name] for name in names)


def _measure(
    wish: CalibrationWish, path: Path, pool: WorkerPool, reporter: TerminalReporter
) -> tuple[SpillMeasurement, ...]:
    """Measure spills in the truth world and write them down.

    Raises:
        InputError: the file is there already, or cannot be written.
    """
    if path.exists():
        raise InputError(f"{path} is there already: fit to it by --spills, or name another file.")
    write_spills(path, ())  # refused now, not after the pours
    path.unlink()
    targets = prepare_targets(wish.spilled_objects, wish.parameters, pool, reporter)
    found = measure_spills(wish.spilled_objects, targets, wish.parameters, OutcomeSettings(), pool, reporter)
    write_spills(path, found)
    print(f"{len(found)} spills measured in the truth world: {path}", file=sys.stderr)
    return found


def _tell(measure: str, step: ContainabilityStep | PourStep) -> None:
    """Tell of the start and of whatever is better; margins are of the measure."""
    if not step.is_best:
        return
    score = step.trial.score
    if isinstance(score, PourScore):
        said = f"spills {score.rms:.2f} candies off"
    else:
        share = f"{100 * score.accuracy():.1f} % right"
        said = f"{measure} margin {score.margin:+.4f}, threshold {score.threshold:.4g}, {share}"
    name = "start" if step.trial.number == 0 else "best so far"
    print(f"trial {step.trial.number + 1} of {step.n_trials}, {name}: {said}", file=sys.stderr, flush=True)


def _print_result(wish: CalibrationWish, found: Calibration) -> None:
    before, after = flatten(wish.parameters), flatten(found.parameters)
    provenance = found.provenance
    rows = [*provenance.spills.get("fitted", ()), *provenance.fitted]
    table = Table("parameter", "before", "after", "importance", box=None, pad_edge=False)
    for row in rows:
        importance = "-" if row["importance"] is None else f"{100 * row['importance']:.0f} %"
        table.add_row(row["name"], short(row["before"]), short(row["after"]), importance)
        for name in row["tied"]:
            table.add_row(name, short(before[name]), short(after[name]), "tied")
    if found.labels is not None:
        name = threshold_name(found.parameters)
        table.add_row(name, short(before[name]), short(after[name]), "chosen")
    console = Console()
    (console if console.is_terminal else Console(width=120)).print(table)
    if provenance.spills:
        spills = provenance.spills
        print(f"Spills: {spills['before']:.2f} candies off before, {spills['after']:.2f} after.")
    if found.labels is not None:
        _print_scores(found)


def _print_scores(found: Calibration) -> None:
    before, after = found.provenance.before, found.provenance.after
    print(
        f"{found.provenance.measure}: margin {before['margin']:+.4f} before, {after['margin']:+.4f} after; "
        f"right {100 * before['accuracy']:.1f} % before, {100 * after['accuracy']:.1f} % after."
    )
    for one in after["by_seed"]:
        (least, container), (most, other) = one["smallest_container"], one["largest_other"]
        print(
            f"  seed {one['seed']}: margin {one['margin']:+.4f}, smallest container {least:.4f} "
            f"({container}), largest other {most:.4f} ({other})"
        )
    if found.labels is not None and not found.labels.best.score.is_separating:
        print(
            f"Containers and others overlap: the threshold {after['threshold']:.4g} is the one that judges "
            "most cases rightly."
        )
