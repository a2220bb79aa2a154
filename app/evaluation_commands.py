"""What the commands about evaluations do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from app.commands import Choices, named_values
from app.evaluation.engines.dask_cluster import DaskEngine
from app.evaluation.engines.engine import Engine
from app.evaluation.engines.local import LocalEngine
from app.evaluation.preparing import EvaluationRequest
from app.evaluation.run import evaluate as run_evaluation
from app.evaluation.standing import Input
from app.terminal import TerminalReporter
from core.errors import InputError
from core.evaluation.comparing import write_comparison
from core.evaluation.evaluation import Evaluation
from core.evaluation.outputs import text_tables, write_outputs
from core.evaluation.variants import METHOD, variants_of
from core.parameters import apply_settings
from core.session import explained
from hardware.simulation.pour_outcome.settings import OutcomeSettings

REPORT_FILE = "comparison.html"
_FROM_ELSEWHERE = {"seed": "--seed", "n_candies": "--set pouring.n_pour=NUMBER"}


@dataclass(frozen=True)
class EvaluationWishes:
    """What was asked on the command line.

    Attributes:
        objects: folder with meshes.
        labels: the CSV; none: the one in the folder.
        source: "mesh" or "scan".
        variants: names; none: the method alone.
        n_seeds: from the parameters' seed on.
        n_pours: pours for each object that is judged a container.
        truth: `NAME=VALUE` of settings of the truth world.
    """

    objects: Path
    labels: Path | None
    source: Input
    variants: tuple[str, ...]
    n_seeds: int
    n_pours: int
    truth: tuple[str, ...]


def evaluate(
    wishes: EvaluationWishes, out: Path, choices: Choices, workers: int | None, scheduler: str | None
) -> None:
    """Evaluate, write the tables and the report, and print the tables."""
    preset, parameters = choices.parameters(out)
    request = EvaluationRequest(
        wishes.objects,
        wishes.labels,
        wishes.source,
        tuple(range(parameters.seed, parameters.seed + wishes.n_seeds)),
        variants_of(list(wishes.variants) or [METHOD]),
        wishes.n_pours,
        preset,
        parameters,
        _outcome(wishes.truth),
    )
    engine: Engine = LocalEngine(workers) if scheduler is None else DaskEngine(scheduler)
    with TerminalReporter() as reporter:
        evaluation = run_evaluation(request, engine, out, reporter)
    with explained(out):
        report = write_outputs(evaluation, out)
    print(text_tables(evaluation))
    print(f"Report: {report}")


def _outcome(texts: Sequence[str]) -> OutcomeSettings:
    """The settings of the truth world.

    Raises:
        InputError: there is no such setting, its value is not possible, or it follows from others.
    """
    settings = named_values("--truth", texts)
    taken = next((name for name in settings if name in _FROM_ELSEWHERE), None)
    if taken is not None:
        raise InputError(f"--truth {taken} cannot be chosen here: use {_FROM_ELSEWHERE[taken]}.")
    return apply_settings(OutcomeSettings(), settings)


def compare(before: Path, after: Path, html: Path | None) -> None:
    """Compare two evaluations and print what changed."""
    html = html or after / REPORT_FILE
    found = [Evaluation.load(folder) for folder in (before, after)]
    try:
        text = write_comparison(found[0], found[1], html)
    except OSError as error:
        raise InputError(f"{html} cannot be written ({error.strerror}); name another file.") from error
    print(text)
    print(f"Report: {html}")
