"""What was found of one object, and what it depends on. Light: no physics here."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from core.errors import SessionError
from core.evaluation.trials import Measure, Scored
from core.files import read_json, write_json
from core.parameters import Parameters


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


def measure_by(parameters: Parameters) -> Measure:
    """Return what judges with these parameters."""
    return "Omega" if parameters.containability.verdict == "omega" else "Capacity share"


def judging_key(parameters: Parameters) -> str:
    """Return a digest of the parameters that decide the score: no threshold, nothing of the pours."""
    names = {"seed", "collision", "particle", "solver", "containability"}
    if measure_by(parameters) == "Capacity share":
        names.add("capacity")
    groups = parameters.model_dump(include=names)
    # Which of the two measures it is, the group of the capacity tells.
    for name in ("verdict", "capacity_threshold", "omega_threshold"):
        del groups["containability"][name]
    text = json.dumps(groups, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def mesh_mark(path: Path) -> str:
    """Return what tells one state of a mesh's file from another."""
    try:
        found = path.stat()
    except OSError:
        return "missing"
    return f"{found.st_size} {found.st_mtime_ns}"
