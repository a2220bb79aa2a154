"""Stale or fresh: computed from the records of a session and the table of stages, remembered nowhere."""

from __future__ import annotations

import json
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any

from core.parameters import Parameters
from core.session import Session, StageRecord
from core.session.record import plain
from core.stages import GIVEN, MESH, STAGE_NAMES, recorded_settings, stage, stages_of


class Freshness(Enum):
    """Whether a stage of a session is up to date."""

    EMPTY = "empty"
    STALE = "stale"
    FRESH = "fresh"


def source_of(session: Session) -> str:
    """Return the stage that gives the surface: `mesh` if one was imported, else `reconstruction`."""
    return MESH if session.record(MESH) is not None else "reconstruction"


def finished_records(session: Path) -> dict[str, StageRecord]:
    """Return the records of all finished stages of a session's folder, whatever they were made from."""
    records = {name: StageRecord.load(session / name) for name in STAGE_NAMES}
    return {name: record for name, record in records.items() if record is not None}


def freshness(
    session: Session, parameters: Parameters, records: Mapping[str, StageRecord] | None = None
) -> dict[str, Freshness]:
    """Return how fresh each stage is; what is made from something stale is stale.

    Whether a stage that depends on a cell is fresh only the cell's owner can tell: it is left out.

    Args:
        session: that holds the stages.
        parameters: of the next run.
        records: `finished_records(session.path)` if they are at hand.
    """
    records = finished_records(session.path) if records is None else records
    found = {name: Freshness.FRESH if name in records else Freshness.EMPTY for name in GIVEN}
    source = MESH if MESH in records else "reconstruction"
    for one in stages_of(source):
        if one.needs_cell:
            continue
        inputs = one.inputs_of(source)
        record = records.get(one.name)
        if record is None:
            found[one.name] = Freshness.EMPTY
        elif any(found[name] is not Freshness.FRESH for name in inputs):
            found[one.name] = Freshness.STALE
        else:
            digests = {name: records[name].digest for name in inputs}
            is_current = is_fresh(session, record, digests, one.settings(parameters))
            found[one.name] = Freshness.FRESH if is_current else Freshness.STALE
    return found


def is_fresh(
    session: Session, record: StageRecord, digests: Mapping[str, str], settings: Mapping[str, Any]
) -> bool:
    """Return whether a stage is what these inputs and settings would give.

    A record of an earlier version may hold more settings than the stage reads today: they do not matter.

    Args:
        session: that holds the stage.
        record: the stage's.
        digests: of the stages it is made from, by their names.
        settings: `{dotted name: value}` of what it reads.
    """
    if record.inputs != dict(digests) or not record.is_whole(session.path / record.stage):
        return False
    recorded = recorded_settings(record.stage, record.parameters)
    return all(key in recorded and recorded[key] == value for key, value in plain(settings).items())


def motion_settings(described: Mapping[str, Any], parameters: Parameters) -> dict[str, Any]:
    """Return what the motions' record keeps: the cell, and the parameters that they read."""
    return stage("motion").settings(parameters) | {"cell": cell_text(described)}


def cell_text(described: Mapping[str, Any]) -> str:
    """Return a cell as the motions' record holds it."""
    return json.dumps(described, sort_keys=True)
