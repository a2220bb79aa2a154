"""All objects in ../shared/data/objects through `imagine`, mesh input: accuracy and AUC (make judgement).

Usage: python -m tests.benchmarks.judgement OUT [name=value ...]
OUT keeps a session for every object; those that are misjudged get a report with pictures.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import rankdata

from core.imagination.imagine import WORKER_MODULE
from core.parameters import Parameters, apply_settings
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool

OBJECTS = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "objects"


@dataclass(frozen=True)
class Verdict:
    """One object's row."""

    name: str
    label: str
    omega: float
    is_open_container: bool
    p_chosen: float
    seconds: float

    @property
    def is_wrong(self) -> bool:
        """Whether a labelled object is misjudged; ambiguous ones never are."""
        return self.label != "ambiguous" and self.is_open_container != (self.label == "container")


def main(out: Path, settings: dict[str, str]) -> None:
    """Judge all objects and print the table."""
    parameters = apply_settings(Parameters(), settings)
    with (OBJECTS / "manifest.csv").open(encoding="utf-8") as file:
        labels = {row["id"]: row["label"] for row in csv.DictReader(file)}
    verdicts = []
    with WorkerPool() as pool:
        pool.start(WORKER_MODULE)
        for name, label in labels.items():
            verdicts.append(judge(name, label, out / name, parameters, pool))
            print_row(verdicts[-1])
    print_summary(verdicts)


def judge(name: str, label: str, folder: Path, parameters: Parameters, pool: WorkerPool) -> Verdict:
    """Imagine one object; write its report if the verdict is wrong."""
    with Session.create_or_open(folder) as session:
        pipeline = Pipeline(session, parameters, pool, Reporter())
        pipeline.import_mesh(OBJECTS / "meshes" / f"{name}.obj")
        result = pipeline.imagination()
        grid, choice, found = result.grid, result.choice, result.containability
        verdict = Verdict(
            name,
            label,
            found.omega,
            found.is_open_container,
            float(grid.p[choice.i, choice.j]) if grid is not None and choice is not None else float("nan"),
            result.containability_s + result.pouring_s,
        )
        if verdict.is_wrong:
            pipeline.report()
    return verdict


def area_under_curve(scores: np.ndarray, positive: np.ndarray) -> float:
    """Area under the ROC curve by the rank sum (Mann-Whitney), ties counted half."""
    ranks = rankdata(scores)
    n_positive, n_negative = positive.sum(), (~positive).sum()
    return float((ranks[positive].sum() - n_positive * (n_positive + 1) / 2) / (n_positive * n_negative))


def print_row(verdict: Verdict) -> None:
    """Print one object."""
    mark = "WRONG" if verdict.is_wrong else ""
    print(
        f"{verdict.name:<26}{verdict.label:<15}{verdict.omega:6.3f}{verdict.p_chosen:7.3f}"
        f"{verdict.seconds:7.1f} s  {mark}",
        flush=True,
    )


def print_summary(verdicts: list[Verdict]) -> None:
    """Print accuracy, AUC, the margin and the time."""
    labelled = [verdict for verdict in verdicts if verdict.label != "ambiguous"]
    omegas = np.array([verdict.omega for verdict in labelled])
    positive = np.array([verdict.label == "container" for verdict in labelled])
    right = sum(not verdict.is_wrong for verdict in labelled)
    print(
        f"\naccuracy {right}/{len(labelled)} = {100 * right / len(labelled):.1f} %, "
        f"AUC {100 * area_under_curve(omegas, positive):.2f} %, "
        f"smallest container {omegas[positive].min():.3f}, largest other {omegas[~positive].max():.3f}, "
        f"mean {np.mean([verdict.seconds for verdict in verdicts]):.1f} s an object"
    )


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: python -m tests.benchmarks.judgement OUT [name=value ...]")
    main(Path(sys.argv[1]), dict(word.split("=", 1) for word in sys.argv[2:]))
