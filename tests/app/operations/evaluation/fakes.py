"""Trials that cost nothing: what a worker should do is in the mesh's file, as JSON."""

import json
import os
import signal
import time
from collections import Counter
from pathlib import Path

from app.operations.evaluating import EvaluationRequest
from app.operations.evaluation.trial import TrialResult, TrialTask
from core.evaluation.trials import Trial
from core.evaluation.variants import variants_of
from core.parameters import Parameters
from hardware.simulation.pour_outcome.settings import OutcomeSettings


def fake_trial(task: TrialTask) -> TrialResult:
    """Note it in a log; die, raise or sleep as requested; then return what only depends on the task."""
    request = json.loads(task.content)
    log = Path(request["log"])
    with log.open("a") as file:
        file.write(f"{task.name} {task.parameters.seed} {os.getpid()}\n")
    if done(log)[task.name] <= request.get("deaths", 0):
        os.kill(os.getpid(), signal.SIGKILL)
    if request.get("raises"):
        raise ValueError("as requested")
    time.sleep(request.get("sleep_s", 0))
    trials, pictures = [], {}
    for variant in task.variants:
        parameters = variant.of(task.parameters)
        name = f"{task.name}.{parameters.seed}.{variant.name}.png"
        pictures[name] = f"picture of {name}".encode()
        n_in = 60 if task.label == "container" else 0
        trials.append(
            Trial(
                task.name,
                task.label,
                parameters.seed,
                variant.name,
                0.1,
                100,
                n_in,
                is_restricted=task.is_restricted,
                seconds={"scan": 0.5},
                picture=name,
                problem=request.get("problem", ""),
            )
        )
    return TrialResult(tuple(trials), pictures)


class Here:
    """An engine without processes, which counts what it did."""

    workers = 1

    def __init__(self, stop_after: int | None = None) -> None:
        self.done: list[tuple[str, int, tuple[str, ...]]] = []
        self._stop_after = stop_after

    def run(self, tasks, reporter):
        for index, task in enumerate(tasks):
            if len(self.done) == self._stop_after:
                reporter.cancel()
            reporter.raise_if_cancelled()
            variants = tuple(variant.name for variant in task.variants)
            self.done.append((task.name, task.parameters.seed, variants))
            yield index, fake_trial(task)


def done(log: Path) -> Counter[str]:
    """How often each object was begun."""
    return Counter(line.split()[0] for line in log.read_text().splitlines())


def pids(log: Path) -> dict[str, int]:
    """The process in which each object was begun last."""
    return {line.split()[0]: int(line.split()[2]) for line in log.read_text().splitlines()}


def write_fake(folder: Path, name: str, **request) -> None:
    """Write a mesh's file that is none."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.obj").write_text(json.dumps({"log": str(folder / "log.txt")} | request))


def write_labels(folder: Path, **labels: str) -> None:
    """Write the labels."""
    rows = "".join(f"{name},{label}\n" for name, label in labels.items())
    (folder / "labels.csv").write_text("id,label\n" + rows)


def fake_task(folder: Path, name: str, **request) -> TrialTask:
    """A task without an evaluation around it."""
    write_fake(folder, name, **request)
    content = (folder / f"{name}.obj").read_bytes()
    variants = variants_of(["imagination", "fixed-theta"])
    return TrialTask(
        name,
        "container",
        False,
        content,
        ".obj",
        "mesh",
        Parameters(),
        variants,
        {"bullet": OutcomeSettings()},
        1,
    )


def request_for(folder: Path, **changes) -> EvaluationRequest:
    """Ask for an evaluation of a folder, one seed, the method alone."""
    values = {
        "objects": folder,
        "labels": None,
        "source": "mesh",
        "seeds": (0,),
        "variants": variants_of(["imagination"]),
        "n_pours": 1,
        "preset": "default",
        "parameters": Parameters(),
    }
    return EvaluationRequest(**values | changes)
