"""What goes into a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from core.imagination.amount.result import Amount
from core.imagination.capacity.result import Capacity
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.imagination.risk.result import PourRisk
from core.mesh import TriangleMesh
from core.motion.pour.feasibility import PourMotions
from core.parameters import Parameters
from core.session.operator_choice import OperatorChoice
from core.session.pour_runs import PourRun

if TYPE_CHECKING:  # only its numbers are needed here, not the fusion
    from core.quality.measures import ScanQuality
    from core.reconstruction.result import Reconstruction

Media: TypeAlias = bytes | Path
"""A picture (PNG or JPEG) or a film (MP4): its content, or the file that holds it."""


@dataclass(frozen=True)
class ReportContent:
    """All that goes into a report; the report says of what is None or empty that it is missing, and why.

    Attributes:
        name: of the session.
        created: ISO 8601 time of the session.
        preset_name: the preset the parameters started from.
        preset: that preset's parameters.
        parameters: the parameters used.
        containability: the verdict and its evidence.
        surface: the object's mesh, reconstructed or given.
        reconstruction: None when the mesh was given.
        quality: of the scan; None when the mesh was given.
        pours: None when none were imagined.
        capacity: what the object holds; None when Omega decided, or nothing stayed.
        retention: how far it can be tilted before candies leave it; as `capacity`.
        amount: how many candies shall go in; as `capacity`.
        choice: None when there is no pour to choose.
        risk: of the pours; None when no tries were made.
        paper_choice: the choice by the paper's rule.
        model_pictures: caption to picture of the surface in its photographed colours; empty without these.
        scan_pictures: caption to picture, small; one a view.
        pictures: caption to picture; wide ones get a row of their own.
        films: caption to film.
        seconds: stage to how long it took.
        known_s: stage to seconds from the scan's last view to its end; empty where nothing was scanned.
        versions: program to version.
        warnings: sentences the stages gave.
        motions: which pours an arm can make; None when that was not checked.
        runs: the pours that an arm made, or began.
        operator: what a person chose instead of the program; None when nobody did.
    """

    name: str
    created: str
    preset_name: str
    preset: Parameters
    parameters: Parameters
    containability: Containability
    surface: TriangleMesh
    reconstruction: Reconstruction | None = None
    quality: ScanQuality | None = None
    pours: PourGrid | None = None
    capacity: Capacity | None = None
    retention: Retention | None = None
    amount: Amount | None = None
    choice: PourChoice | None = None
    risk: PourRisk | None = None
    paper_choice: PourChoice | None = None
    model_pictures: Mapping[str, Media] = field(default_factory=dict)
    scan_pictures: Mapping[str, Media] = field(default_factory=dict)
    pictures: Mapping[str, Media] = field(default_factory=dict)
    films: Mapping[str, Media] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    known_s: Mapping[str, float] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    motions: PourMotions | None = None
    runs: tuple[PourRun, ...] = ()
    operator: OperatorChoice | None = None
