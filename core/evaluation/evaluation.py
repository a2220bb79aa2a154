"""An evaluation's folder: the request, every trial, and their pictures. Light: no physics here.

evaluation.json              the request, and its objects
trials/NAME.SEED.VARIANT.json  one trial each, written as soon as it is done
pictures/NAME.SEED.VARIANT.png
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from core.errors import SessionError
from core.evaluation.best_view import from_best_views
from core.evaluation.labels import Label, LabelledObject
from core.evaluation.trials import FIRST_WORLD, Trial
from core.files import read_json, write_json
from core.formats.evaluations import Evaluation as EvaluationTable
from core.formats.evaluations import TrialFile

EVALUATION_FILE, TRIALS_FOLDER, PICTURES_FOLDER = "evaluation.json", "trials", "pictures"
_REMEDY = "evaluate into the same folder again, which makes it anew."


@dataclass(frozen=True)
class EvaluatedObject:
    """An object as far as tables and pages need it.

    Attributes:
        name: unique.
        label: what a person calls it.
        category: what it is; may be empty.
        is_restricted: whether it belongs to the restricted set (Sec. IV-B).
        is_calibration: whether parameters were allowed to be fitted to it.
        sha256: of its mesh's file; empty if there is none.
        n_container: people who called it a container, where raw answers are known.
        n_asked: people asked; 0 where only labels are known.
        capacity_ml: to its lowest rim; none where it is not known.
    """

    name: str
    label: Label
    category: str = ""
    is_restricted: bool = False
    is_calibration: bool = False
    sha256: str = ""
    n_container: int = 0
    n_asked: int = 0
    capacity_ml: float | None = None

    @classmethod
    def of(cls, one: LabelledObject, content: bytes | None) -> EvaluatedObject:
        """Take over a labelled object and the content of its mesh's file, none if it cannot be read."""
        agreement = one.agreement
        return cls(
            one.name,
            one.label,
            one.category,
            one.is_restricted,
            one.is_calibration,
            "" if content is None else hashlib.sha256(content).hexdigest(),
            0 if agreement is None else agreement.n_container,
            0 if agreement is None else agreement.n_asked,
            one.capacity_ml,
        )


@dataclass(frozen=True)
class Evaluation:
    """Everything of one evaluation; trials that are not done yet are not there.

    Attributes:
        objects: all of them, in the order of the labels.
        source: "mesh" or "scan".
        seeds: each object is tried once with each.
        variants: names, in the tables' order.
        n_pours: pours for each object that is judged a container, in all ground-truth worlds.
        preset: what the parameters started from.
        parameters: all of them by dotted name, as plain JSON.
        versions: of the program and of what it computes with.
        seconds: wall-clock time of all runs together.
        workers: how many computed in the last run.
        trials: in the order of variants, objects, seeds; what is judged by looks, from its best view.
        truth: settings of the ground-truth worlds that are not the usual ones, by name.
        worlds: the ground-truth worlds, into which pours go in turn.
    """

    objects: tuple[EvaluatedObject, ...]
    source: str
    seeds: tuple[int, ...]
    variants: tuple[str, ...]
    n_pours: int
    preset: str
    parameters: Mapping[str, Any]
    versions: Mapping[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    workers: int = 1
    trials: tuple[Trial, ...] = ()
    truth: Mapping[str, Any] = field(default_factory=dict)
    worlds: tuple[str, ...] = (FIRST_WORLD,)

    def of_variant(self, variant: str) -> tuple[Trial, ...]:
        """Return the trials of one variant."""
        return tuple(trial for trial in self.trials if trial.variant == variant)

    def save(self, folder: Path) -> None:
        """Write everything but the trials, which are written one by one."""
        table = asdict(self)
        del table["trials"]
        write_json(folder / EVALUATION_FILE, table)

    @classmethod
    def load(cls, folder: Path) -> Evaluation:
        """Read an evaluation with all trials that are done.

        Raises:
            SessionError: there is none, or it or a trial is damaged.
        """
        table = _read(folder / EVALUATION_FILE, EvaluationTable)
        table["objects"] = tuple(EvaluatedObject(**one) for one in table["objects"])
        for name in ("seeds", "variants", "worlds"):
            table[name] = tuple(table.get(name, (FIRST_WORLD,)))
        known = cls(**table)
        places = (
            trial_file(folder, one.name, seed, variant)
            for variant in known.variants
            for one in known.objects
            for seed in known.seeds
        )
        trials = tuple(read_trial(path)[0] for path in places if path.exists())
        return replace(known, trials=from_best_views(trials))


def trial_file(folder: Path, name: str, seed: int, variant: str) -> Path:
    """Return the file of a trial."""
    return folder / TRIALS_FOLDER / f"{name}.{seed}.{variant}.json"


def write_trial(folder: Path, trial: Trial, key: str) -> None:
    """Write a trial, whole or not at all, with the key of what it depends on."""
    path = trial_file(folder, trial.name, trial.seed, trial.variant)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_json(path, {"key": key, "trial": trial.to_table()})


def read_trial(path: Path) -> tuple[Trial, str]:
    """Read a trial, and the key of what it depended on.

    Raises:
        SessionError: the file is missing or damaged.
    """
    table = _read(path, TrialFile)
    trial = Trial.from_table(table["trial"])
    if path.name != trial_file(path, trial.name, trial.seed, trial.variant).name:
        raise SessionError(f"{path} is damaged (it holds another trial); {_REMEDY}")
    return trial, table["key"]


def kept_trial(path: Path, key: str) -> Trial | None:
    """Read a trial; none if it is not there, cannot be used, or has another key: then it is made anew."""
    try:
        trial, found = read_trial(path)
    except SessionError:
        return None
    return trial if found == key else None


def _read(path: Path, kind: type) -> dict[str, Any]:
    try:
        return read_json(path, kind)
    except SessionError as error:
        raise SessionError(f"{str(error).rstrip('.')}; {_REMEDY}") from error


def digest_of(facts: Mapping[str, Any]) -> str:
    """Return a digest of what a result depends on, given as plain JSON."""
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:16]
