"""What the pipeline lets its workers do: each job reads its input from the session's files."""

from __future__ import annotations

from pathlib import Path

from core.collision import CollisionModel, build_collision_model
from core.mesh import TriangleMesh
from core.parameters.reconstruction import CollisionParameters, ReconstructionParameters
from core.quality.measures import ScanQuality
from core.quality.plain_fusion import coarse_volume
from core.quality.verdict import assess
from core.reconstruction.colors import ModelColors, photographed
from core.reconstruction.pose_health import find_tables
from core.reconstruction.result import Reconstruction
from core.reconstruction.stage import reconstruct
from core.scan import crop_box_of, stored_scan, views_so_far
from core.workers import WorkerReporter

JOBS_MODULE = __name__
"""For pools that will reconstruct: its import takes a worker a second."""


def reconstruction_job(
    scan_folder: Path, parameters: ReconstructionParameters
) -> tuple[Reconstruction, list[str]]:
    """Reconstruct a scan; return the result and what the user should know."""
    reporter = WorkerReporter()
    scan = stored_scan(scan_folder, WorkerReporter())  # its warnings were given when it was imported
    return reconstruct(scan, parameters, reporter), reporter.warnings


def views_ahead_job(unfinished: Path, parameters: ReconstructionParameters) -> None:
    """Decode the views that a scan has so far, and find the table in each; once each in this process."""
    scan = views_so_far(unfinished)
    if scan is not None:
        find_tables(scan, parameters)


def quality_job(
    scan_folder: Path,
    reconstruction_folder: Path,
    parameters: ReconstructionParameters,
    table_height_m: float | None,
) -> tuple[ScanQuality, list[str]]:
    """Judge a scan by itself and by what was reconstructed from it."""
    scan = stored_scan(scan_folder, WorkerReporter())
    volume = coarse_volume(scan, crop_box_of(scan, parameters))
    reconstruction = Reconstruction.load(reconstruction_folder)
    return assess(scan, volume, reconstruction, table_height_m=table_height_m), []


def colors_job(scan_folder: Path, reconstruction_folder: Path) -> tuple[ModelColors, list[str]]:
    """Colour what was reconstructed by the images of its scan."""
    scan, found = stored_scan(scan_folder, WorkerReporter()), Reconstruction.load(reconstruction_folder)
    posed = scan if found.refinement is None else found.refinement.applied_to(scan)
    return photographed(found.mesh, posed), []


def collision_job(mesh: TriangleMesh, parameters: CollisionParameters) -> tuple[CollisionModel, list[str]]:
    """Build the collision model; return the result and what the user should know."""
    reporter = WorkerReporter()
    return build_collision_model(mesh, parameters, reporter), reporter.warnings
