"""Which finished stages of a session still belong together."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from core.pipeline.needs import STAGES
from core.session import StageRecord


def current_records(session: Path) -> dict[str, StageRecord]:
    """Return the records of the finished stages that were made from what the session holds now.

    Unlike `core.pipeline.needs.freshness` it does not ask which parameters somebody would use today: what was
    found with other ones is still what was found.
    """
    current: dict[str, StageRecord] = {}
    for stage in STAGES:
        record = StageRecord.load(session / stage)
        if record is not None and _is_made_from(record.inputs, current):
            current[stage] = record
    return current


def _is_made_from(inputs: Mapping[str, str], current: Mapping[str, StageRecord]) -> bool:
    return all(name in current and current[name].digest == digest for name, digest in inputs.items())
