"""What an evaluation asks, its objects with what their files hold, and the trials that follow from both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.evaluation.standing import Input
from app.evaluation.trial import TrialTask
from core.errors import InputError
from core.evaluation.evaluation import EvaluatedObject, trial_key
from core.evaluation.labels import LabelledObject, read_labels
from core.evaluation.variants import Variant
from core.parameters import Parameters, flatten
from core.session.record import plain, program_versions
from hardware.simulation.pour_outcome.settings import OutcomeSettings

RESULT_VERSION = 3
"""Raise it when the same input gives another result: trials that were kept are then done again."""
_DECISIVE = ("numpy", "pybullet", "open3d")


@dataclass(frozen=True)
class EvaluationRequest:
    """What is to be evaluated, and how.

    Attributes:
        objects: folder with meshes.
        labels: the CSV with their labels; none: the one in the folder.
        source: whether each object is scanned first or its mesh is known.
        seeds: each object is tried once with each.
        variants: in the tables' order.
        n_pours: pours in the truth world for each object that is judged a container.
        preset: what the parameters started from.
        parameters: of the method; each trial has its own seed instead of theirs.
        outcome: settings of the truth world.
    """

    objects: Path
    labels: Path | None
    source: Input
    seeds: tuple[int, ...]
    variants: tuple[Variant, ...]
    n_pours: int
    preset: str
    parameters: Parameters
    outcome: OutcomeSettings = field(default_factory=OutcomeSettings)

    @property
    def truth(self) -> dict[str, Any]:
        """The settings of the truth world that are not the usual ones."""
        usual = OutcomeSettings().model_dump(mode="json")
        chosen = self.outcome.model_dump(mode="json")
        return {name: value for name, value in chosen.items() if value != usual[name]}

    def seeded(self, seed: int) -> Parameters:
        """Return the parameters of the trials with one seed."""
        return self.parameters.model_copy(update={"seed": seed})

    def key(self, sha256: str, seed: int, variant: Variant) -> str:
        """Return the digest of all that one trial depends on."""
        versions = program_versions()
        return trial_key(
            {
                "mesh": sha256,
                "source": self.source,
                "parameters": plain(flatten(variant.of(self.seeded(seed)))),
                "outcome": self.outcome.model_dump(mode="json"),
                "n_pours": self.n_pours,
                "result": RESULT_VERSION,
                "versions": {name: versions[name] for name in _DECISIVE},
            }
        )


@dataclass(frozen=True)
class PreparedObject:
    """An object of which it is known whether there is a file.

    Attributes:
        labelled: as the labels say.
        evaluated: as tables and pages need it, with its file's digest.
        problem: why there is no file that can be read, in a sentence; empty if there is one.
    """

    labelled: LabelledObject
    evaluated: EvaluatedObject
    problem: str

    def task(self, request: EvaluationRequest, seed: int, variants: tuple[Variant, ...]) -> TrialTask:
        """Return the task for a worker, with the content of the mesh's file, which is read again.

        Where there is no file there is no content.

        Raises:
            InputError: the file is not what it was when the evaluation began.
        """
        one = self.labelled
        return TrialTask(
            one.name,
            one.label,
            one.is_restricted,
            self._content(),
            one.mesh.suffix,
            request.source,
            request.seeded(seed),
            variants,
            request.outcome,
            request.n_pours,
        )

    def _content(self) -> bytes:
        if self.problem:
            return b""
        one = self.labelled
        content, _ = _content(one.mesh)
        if content is None or EvaluatedObject.of(one, content) != self.evaluated:
            raise InputError(
                f"{one.mesh} has changed since the evaluation began; run the same command again."
            )
        return content


def prepared_objects(request: EvaluationRequest) -> tuple[PreparedObject, ...]:
    """Read the labels and every mesh's digest, in the order of the labels.

    Raises:
        InputError: the labels cannot be used, or a name cannot be that of a file.
    """
    objects = read_labels(request.objects, request.labels)
    return tuple(_prepared(one) for one in objects)


def interleaved(objects: Sequence[PreparedObject]) -> tuple[PreparedObject, ...]:
    """Spread each kind of label evenly: containers cost most, and the time left is told by what is done."""
    kinds: dict[str, list[PreparedObject]] = {}
    for one in objects:
        kinds.setdefault(one.labelled.label, []).append(one)
    ranked = [((place + 0.5) / len(kind), one) for kind in kinds.values() for place, one in enumerate(kind)]
    return tuple(one for _, one in sorted(ranked, key=lambda pair: pair[0]))


def _prepared(one: LabelledObject) -> PreparedObject:
    if Path(one.name).name != one.name:
        raise InputError(
            f"The labels name an object '{one.name}', which cannot be a file's name; call it otherwise."
        )
    content, problem = _content(one.mesh)
    return PreparedObject(one, EvaluatedObject.of(one, content), problem)


def _content(mesh: Path) -> tuple[bytes | None, str]:
    try:
        return mesh.read_bytes(), ""
    except OSError as error:
        return None, f"{mesh} cannot be read ({error.strerror}); put the object's mesh there."
