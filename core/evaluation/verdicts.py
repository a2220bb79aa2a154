"""Verdicts on labelled objects, what they depend on, and what parameters are worth. No physics here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from core.errors import SessionError
from core.evaluation.evaluation import digest_of
from core.evaluation.labels import LabelledObject
from core.evaluation.statistics import Margin
from core.evaluation.trials import Measure, Scored
from core.files import read_json, write_json
from core.parameters import Parameters
from core.session.record import plain
from core.stages import MESH, stage, stages_before

_NOT_DECISIVE = (
    "holding.",
    "containability.verdict",
    "containability.omega_threshold",
    "containability.capacity_threshold",
)
"""Read by the judgement, but not for the score; which of the two measures it is the digest says by itself."""


@dataclass(frozen=True)
class ObjectVerdict(Scored):
    """What the imagination says of one object.

    Attributes:
        name: the object's.
        mesh: size and time of the mesh's file, by which a changed one is noticed.
        n_drop: candies dropped; 0 if it could not be judged.
        n_in: candies that stayed.
        seconds: it took.
        problem: why it could not be judged, in a sentence; empty if it could.
        capacity_share: volume it holds as a share of its convex hull's; none if it was judged by Omega.
    """

    name: str
    mesh: str
    n_drop: int
    n_in: int
    seconds: float
    problem: str = ""
    capacity_share: float | None = None

    def save(self, path: Path) -> None:
        """Write it as JSON, whole or not at all."""
        write_json(path, asdict(self))

    @classmethod
    def load(cls, path: Path) -> ObjectVerdict | None:
        """Read what `save` wrote; none if there is nothing of use: then the object is judged again."""
        try:
            return cls(**read_json(path))
        except (SessionError, TypeError):
            return None


@dataclass(frozen=True)
class Score:
    """The judged ones of labelled objects; ambiguous ones do not count.

    Attributes:
        n_judged: objects with a verdict.
        n_right: those judged right.
        n_failed: labelled objects that could not be judged; they are not among the judged.
        ends: the container and the other object that decide the margin.
    """

    n_judged: int
    n_right: int
    n_failed: int
    ends: Margin

    @property
    def accuracy(self) -> float | None:
        """Share judged right; none if nothing was judged."""
        return self.n_right / self.n_judged if self.n_judged else None


def is_right(label: str, found: float, threshold: float) -> bool | None:
    """Whether a score, held against its threshold, agrees with a label; none for an ambiguous object."""
    return None if label == "ambiguous" else (found > threshold) == (label == "container")


def score(
    objects: Iterable[LabelledObject], verdicts: Mapping[str, ObjectVerdict], threshold: float
) -> Score:
    """Sum up the verdicts of one set of parameters.

    Args:
        objects: all of them.
        verdicts: by the objects' names; what was not judged yet is not there.
        threshold: of what judges: a capacity share, or Omega_thr.
    """
    labelled = [one for one in objects if one.label != "ambiguous" and one.name in verdicts]
    scores = ((one, verdicts[one.name].score) for one in labelled)
    judged = [(one, found) for one, found in scores if found is not None]
    return Score(
        len(judged),
        sum(bool(is_right(one.label, found, threshold)) for one, found in judged),
        len(labelled) - len(judged),
        Margin.of((found, one.name, one.label == "container") for one, found in judged),
    )


def measure_by(parameters: Parameters) -> Measure:
    """Return what judges with these parameters."""
    return "Omega" if parameters.containability.verdict == "omega" else "Capacity share"


def judging_key(parameters: Parameters) -> str:
    """Return a digest of the parameters that decide the score: no threshold, no retention, no pours."""
    last = "containability" if measure_by(parameters) == "Omega" else "judgement"
    settings: dict[str, Any] = {"measure": measure_by(parameters)}
    for name in stages_before(last, MESH):
        if name != MESH:
            settings |= stage(name).settings(parameters)
    decisive = {key: value for key, value in settings.items() if not key.startswith(_NOT_DECISIVE)}
    return digest_of(plain(decisive))


def mesh_mark(path: Path) -> str:
    """Return what distinguishes one state of a mesh's file from another."""
    try:
        found = path.stat()
    except OSError:
        return "missing"
    return f"{found.st_size} {found.st_mtime_ns}"
