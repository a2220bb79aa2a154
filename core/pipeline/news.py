"""What a pipeline tells while it works: light, for a window imports it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class StageDone:
    """A stage's result is in the session's folder, whole; the stages after it still run."""

    session: Path
    stage: str
