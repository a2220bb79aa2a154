"""What was found of one object, and what it depends on. Light: no physics here."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from core.errors import SessionError
from core.files import read_json, write_json
from core.parameters import Parameters


@dataclass(frozen=True)
class ObjectVerdict:
    """What the imagination says of one object.

    Attributes:
        name: the object's.
        mesh: size and time of the mesh's file, by which a changed one is noticed.
        n_drop: candies dropped; 0 if it could not be judged.
        n_in: candies that stayed.
        seconds: it took.
        problem: why it could not be judged, in a sentence; empty if it could.
    """

    name: str
    mesh: str
    n_drop: int
    n_in: int
    seconds: float
    problem: str = ""

    @property
    def omega(self) -> float | None:
        """Omega (Eq. 1); none if it could not be judged."""
        return self.n_in / self.n_drop if self.n_drop else None

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


def judging_key(parameters: Parameters) -> str:
    """Return a digest of the parameters that decide Omega: not its threshold, nothing of the pours."""
    groups = parameters.model_dump(include={"seed", "collision", "particle", "solver", "containability"})
    del groups["containability"]["omega_threshold"]
    text = json.dumps(groups, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def mesh_mark(path: Path) -> str:
    """Return what tells one state of a mesh's file from another."""
    try:
        found = path.stat()
    except OSError:
        return "missing"
    return f"{found.st_size} {found.st_mtime_ns}"
