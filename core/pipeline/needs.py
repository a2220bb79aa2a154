"""What each stage of a session is made from: the one place that freshness is computed from."""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import Enum
from typing import Any

from core.parameters import Parameters
from core.session import Session

GIVEN = ("scan", "mesh")
"""What comes from outside; a session holds one of the two."""
STAGES = (
    *GIVEN,
    "reconstruction",
    "quality",
    "collision",
    "containability",
    "pouring",
    "motion",
    "evidence",
)
"""In the order of the work: none is made from a later one."""


@dataclass(frozen=True)
class StageNeeds:
    """What a stage's record must name for the stage to be fresh.

    Attributes:
        inputs: the stages it is made from.
        settings: its parameters, as plain JSON.
    """

    inputs: tuple[str, ...]
    settings: dict[str, Any]


class Freshness(Enum):
    """How a stage of a session stands."""

    EMPTY = "empty"
    STALE = "stale"
    FRESH = "fresh"


def source_of(session: Session) -> str:
    """Return the stage that gives the surface: `mesh` if one was imported, else `reconstruction`."""
    return "mesh" if session.record("mesh") is not None else "reconstruction"


def stage_needs(parameters: Parameters, source: str) -> dict[str, StageNeeds]:
    """Return what each computed stage needs, in their order.

    Args:
        parameters: that the stages would be run with.
        source: see `source_of`.
    """
    imagined = _imagination_settings(parameters)
    particle = parameters.particle.model_dump()
    needs = {
        "collision": StageNeeds((source,), parameters.collision.model_dump()),
        "containability": StageNeeds(("collision",), imagined),
        "pouring": StageNeeds(("collision",), imagined),
        "evidence": StageNeeds(
            (source, "containability", "pouring"), parameters.evidence.model_dump() | {"particle": particle}
        ),
    }
    if source == "mesh":
        return needs
    scanned = {
        "reconstruction": StageNeeds(("scan",), parameters.reconstruction.model_dump()),
        "quality": StageNeeds(("scan", "reconstruction"), {}),
    }
    return scanned | needs


def freshness(session: Session, parameters: Parameters) -> dict[str, Freshness]:
    """Tell how each stage stands; what is made from something stale is stale."""
    found = {stage: _given(session, stage) for stage in GIVEN}
    for stage, needs in stage_needs(parameters, source_of(session)).items():
        found[stage] = _computed(session, stage, needs, found)
    return found


def _given(session: Session, stage: str) -> Freshness:
    return Freshness.EMPTY if session.record(stage) is None else Freshness.FRESH


def _computed(session: Session, stage: str, needs: StageNeeds, found: dict[str, Freshness]) -> Freshness:
    if session.record(stage) is None:
        return Freshness.EMPTY
    if any(found[name] is not Freshness.FRESH for name in needs.inputs):
        return Freshness.STALE
    records = {name: session.record(name) for name in needs.inputs}
    digests = {name: record.digest for name, record in records.items() if record is not None}
    is_fresh = session.is_fresh(stage, digests, needs.settings)
    return Freshness.FRESH if is_fresh else Freshness.STALE


_IMAGINING = {"seed", "particle", "solver", "containability", "capacity", "holding", "pouring", "risk"}


def _imagination_settings(parameters: Parameters) -> dict[str, Any]:
    groups = parameters.model_dump(
        include={"seed", "particle", "solver", "containability", "pouring", "risk"}
    )
    settings: dict[str, Any] = json.loads(json.dumps(groups))
    settings["aabb_margin_m"] = parameters.collision.aabb_margin_m
    settings["record_interval_s"] = parameters.evidence.record_interval_s
    return settings
