"""Surfaces that the same views allow as well: what they did not see is neither solid nor free."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.files import read_json, write_json
from core.mesh import TriangleMesh
from core.mesh_file import read_ply, write_ply

FACTS_FILE = "unseen.json"
_ROOMY_FILE, _LEAKY_FILE = "unseen_roomy.ply", "unseen_leaky.ply"


@dataclass(frozen=True)
class UnseenReadings:
    """The other readings of a scan whose own surface takes the unseen for solid.

    Attributes:
        unseen_ml: volume behind the openings that no view saw, without the thinnest walls there can be.
        roomy: the surface if all of it is hollow, in the robot's base frame.
        leaky: the surface if the unseen goes on through the bottom; none where the bottom was seen.
    """

    unseen_ml: float
    roomy: TriangleMesh
    leaky: TriangleMesh | None = None

    def save(self, folder: Path) -> None:
        """Write the surfaces and `unseen.json` into an existing folder."""
        write_json(folder / FACTS_FILE, {"unseen_ml": self.unseen_ml})
        write_ply(folder / _ROOMY_FILE, self.roomy)
        if self.leaky is not None:
            write_ply(folder / _LEAKY_FILE, self.leaky)

    @staticmethod
    def load(folder: Path) -> UnseenReadings | None:
        """Read what `save` wrote; none if nothing was hidden, or an earlier version did not ask.

        Raises:
            SessionError: a file is damaged.
        """
        if not (folder / FACTS_FILE).is_file():
            return None
        facts = read_json(folder / FACTS_FILE)
        unseen_ml = float(facts["unseen_ml"])
        leaky = folder / _LEAKY_FILE
        return UnseenReadings(
            unseen_ml, read_ply(folder / _ROOMY_FILE), read_ply(leaky) if leaky.is_file() else None
        )
