"""What the commands about evaluation and tuning say, on the terminal."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from types import FrameType

from rich.console import Console
from rich.table import Table

from app.cli.options import given_path, written_file
from app.cli.parameters import named_values, short
from app.cli.terminal import TerminalReporter
from app.library.places import preset_file
from app.operations.evaluating import EvaluationRequest
from app.operations.evaluating import evaluate as run_evaluation
from app.operations.evaluation.dask_engine import DaskEngine, local_cluster
from app.operations.evaluation.engine import LocalEngine
from app.operations.tuning import Tuning, TuningRequest, with_measured_spills
from app.operations.tuning import tune as run_tuning
from core.errors import InputError
from core.evaluation.evaluation import Evaluation
from core.evaluation.fitting.containability import ContainabilityStep
from core.evaluation.fitting.fitted import threshold_name
from core.evaluation.fitting.pours import PourScore, PourStep
from core.evaluation.fitting.provenance import write_fitted_preset
from core.evaluation.outputs import write_outputs
from core.evaluation.pages.comparison import write_comparison
from core.evaluation.tables import text_tables
from core.evaluation.trials import measure_word
from core.evaluation.verdicts import measure_by
from core.formats import excerpt
from core.imagination.imagination import WORKER_MODULE
from core.parameters import flatten
from core.session import explained
from core.workers import WorkerPool
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.worlds import WORLDS, worlds_with

COMPARISON_FILE = "comparison.html"
_FROM_ELSEWHERE = {
    "seed": "--seed",
    "n_candies": "--set pouring.n_pour=NUMBER",
    "engine": "--world NAME",
}


def ground_truth(names: Sequence[str] | None, texts: Sequence[str] | None) -> dict[str, OutcomeSettings]:
    """Return the ground-truth worlds of these names (none: all), changed as `NAME=VALUE` say.

    Raises:
        InputError: there is no such world or setting, its value is not possible, or it follows from others.
    """
    settings = named_values("--truth", texts or [])
    taken = next((name for name in settings if name in _FROM_ELSEWHERE), None)
    if taken is not None:
        raise InputError(f"--truth {taken} cannot be chosen here: use {_FROM_ELSEWHERE[taken]}.")
    return worlds_with(names or tuple(WORLDS), settings)


def evaluate(request: EvaluationRequest, out: Path, workers: int | None, scheduler: str | None) -> None:
    """Evaluate here or on a cluster, write the tables and the report, and print the tables."""
    engine = LocalEngine(workers) if scheduler is None else DaskEngine(scheduler)
    with TerminalReporter() as reporter:
        evaluation = run_evaluation(request, engine, out, reporter)
        with explained(out):
            report = write_outputs(evaluation, out)
    print(text_tables(evaluation))
    print(f"Report: {report}")


def compare(before: Path, after: Path, html: Path | None) -> None:
    """Compare two evaluations and print what changed."""
    html = html or after / COMPARISON_FILE
    try:
        text = write_comparison(Evaluation.load(before), Evaluation.load(after), html)
    except OSError as error:
        raise InputError(f"{html} cannot be written ({error.strerror}); name another file.") from error
    print(text)
    print(f"Report: {html}")


def cluster(workers: int | None, port: int) -> None:
    """Run a scheduler with workers until Ctrl-C or SIGTERM."""
    stopped = threading.Event()

    def stop(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    with local_cluster(workers, port) as (address, n_workers):
        print(
            f"A scheduler with {n_workers} {'worker' if n_workers == 1 else 'workers'} listens at "
            f"{address}. Ctrl-C ends it.\n"
            f"poursight evaluate OBJECTS --out DIR --scheduler {address}",
            flush=True,
        )
        stopped.wait()


def tune(request: TuningRequest, path: Path, truth_spills: Path | None, workers: int | None) -> None:
    """Fit, print the best so far on the way, and write the preset.

    Raises:
        PoursightError: something given cannot be used, or nothing was found before it was stopped.
    """
    with WorkerPool(workers) as pool, TerminalReporter() as reporter:
        pool.start(WORKER_MODULE)
        if truth_spills is not None:
            request = with_measured_spills(request, truth_spills, pool, reporter)
            n = len(request.spills)
            print(f"{n} spills measured in the ground-truth simulation: {truth_spills}", file=sys.stderr)
        report = partial(_print_step, measure_word(measure_by(request.parameters)))
        found = run_tuning(request, pool, reporter, report, report)
        if found.is_cut_short:
            reporter.forget_cancel()
        write_fitted_preset(path, found.parameters, found.named, found.provenance)
    if found.is_cut_short:
        print("Stopped on request; the best so far is kept.", file=sys.stderr)
    _print_result(request, found)
    print(f"Preset: {path}")


def preset_path(out: str) -> Path:
    """Return where a preset goes: a bare name is one of the user's presets, anything else a file.

    Raises:
        InputError: the name is not possible, or no file of that name can be written.
        SessionError: the folder of the user's presets cannot be made.
    """
    path = Path(out)
    if path.name == out and path.suffix != ".json":
        return written_file(str(preset_file(out)))
    if not given_path(out).parent.is_dir():
        raise InputError(
            f"There is no folder {excerpt(path.parent)} to write the preset to; make it, or name another."
        )
    is_whole = path.suffix == ".json" or not path.name.strip(".")  # a folder's name, which is refused
    return written_file(out if is_whole else f"{path}.json")


def _print_step(measure: str, step: ContainabilityStep | PourStep) -> None:
    """Print the start and whatever is better; margins are of the measure."""
    if not step.is_best:
        return
    score = step.trial.score
    if isinstance(score, PourScore):
        worth = f"spills {score.rms:.2f} candies off"
    else:
        share = f"{100 * score.accuracy():.1f} % right"
        worth = f"{measure} margin {score.margin:+.4f}, threshold {score.threshold:.4g}, {share}"
    name = "start" if step.trial.number == 0 else "best so far"
    print(f"trial {step.trial.number + 1} of {step.n_trials}, {name}: {worth}", file=sys.stderr, flush=True)


def _print_result(request: TuningRequest, found: Tuning) -> None:
    before, after = flatten(request.parameters), flatten(found.parameters)
    spills = found.provenance.spills
    table = Table("parameter", "before", "after", "importance", box=None, pad_edge=False)
    for row in (*spills.get("fitted", ()), *found.provenance.fitted):
        importance = "-" if row["importance"] is None else f"{100 * row['importance']:.0f} %"
        table.add_row(row["name"], short(row["before"]), short(row["after"]), importance)
        for name in row["tied"]:
            table.add_row(name, short(before[name]), short(after[name]), "tied")
    if found.labels is not None:
        name = threshold_name(found.parameters)
        table.add_row(name, short(before[name]), short(after[name]), "chosen")
    console = Console()
    (console if console.is_terminal else Console(width=120)).print(table)
    if spills:
        print(f"Spills: {spills['before']:.2f} candies off before, {spills['after']:.2f} after.")
    if found.labels is not None:
        _print_scores(found, found.labels.best.score.is_separating)


def _print_scores(found: Tuning, is_separating: bool) -> None:
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
    if not is_separating:
        print(
            f"Containers and others overlap: the threshold {after['threshold']:.4g} is the one that judges "
            "most cases rightly."
        )
