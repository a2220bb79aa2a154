"""An evaluation's folder, of which one file is damaged, and what reads it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

from core.evaluation.evaluation import EVALUATION_FILE, Evaluation, kept_trial, write_trial
from core.evaluation.outputs import write_outputs
from core.evaluation.pages.comparison import write_comparison
from tests.core.evaluation.evaluations import two_measures
from tests.fuzz.mutation import damaged_json, replaced

_KEY = "key"
_PAGE_SHARE = 0.1
"""The pages take a tenth of a second."""


def prepare_evaluation(base: Path) -> None:
    """Write one of eight trials into a folder."""
    evaluation = two_measures()
    evaluation.save(base)
    for one in evaluation.trials:
        write_trial(base, one, _KEY)


def damaged_evaluation(base: Path, folder: Path, pick: Random) -> Iterator[Callable[[], object]]:
    """Damage the evaluation or one of its trials, and yield what reads them."""
    copy = Path(shutil.copytree(base, folder / "evaluated", copy_function=os.link))
    trials = sorted(path.relative_to(copy) for path in copy.rglob("*/*.json"))
    path = copy / pick.choice((Path(EVALUATION_FILE), pick.choice(trials)))
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(damaged_json(content, pick))
    replaced(path, pick)
    yield lambda: Evaluation.load(copy)
    yield lambda: write_comparison(Evaluation.load(copy), Evaluation.load(base), folder / "comparison.html")
    yield lambda: write_comparison(Evaluation.load(base), Evaluation.load(copy), folder / "comparison.html")
    yield lambda: [kept_trial(copy / name, _KEY) for name in trials]
    if pick.random() < _PAGE_SHARE:
        yield lambda: write_outputs(Evaluation.load(copy), folder)
