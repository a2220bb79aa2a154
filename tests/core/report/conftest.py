"""Results like those of a real object: an oblong tray that holds about half of what falls."""

from __future__ import annotations

from io import BytesIO
from math import pi

import numpy as np
import pytest
from PIL import Image, ImageDraw

from core.geometry import FloatArray
from core.imagination.recording import Recorder, Recording
from core.imagination.results import Containability, Footprint, PourChoice, PourGrid
from core.mesh import TriangleMesh
from core.parameters import apply_settings, load_preset
from core.reconstruction.pose_health import PoseHealth, ViewHealth
from core.reconstruction.result import Reconstruction
from core.report import ReportContent

CENTER_M = np.array([-0.07, -0.36])
AXIS_RAD = 0.6
SPILLS = ((0, 0, 0), (0, 0, 7), (1, 0, 55), (0, 0, 3), (0, 0, 0), (0, 0, 5), (4, 0, 59), (3, 0, 9))


def no_recording(n: int) -> Recording:
    return Recorder(n).recording()


def drop_grid(extent_m: tuple[float, float], n: tuple[int, int], layers: int = 1) -> FloatArray:
    x, y = (np.linspace(-e / 2, e / 2, count) for e, count in zip(extent_m, n, strict=True))
    z = 0.08 + 0.05 * np.arange(layers)
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    grid[:, :2] += CENTER_M
    return grid


def in_tray(positions_m: FloatArray) -> FloatArray:
    c, s = np.cos(AXIS_RAD), np.sin(AXIS_RAD)
    along = (positions_m[:, :2] - CENTER_M) @ np.array([[c, -s], [s, c]])
    return (np.abs(along[:, 0]) < 0.085) & (np.abs(along[:, 1]) < 0.045)


def containability_of(positions_m: FloatArray, retained: FloatArray) -> Containability:
    margin = np.array([0.006, 0.006, 0.01])
    aabb = np.array([positions_m.min(axis=0) - margin, positions_m.max(axis=0) + margin])
    aabb[0, 2] = 0.03
    footprint = Footprint.of(positions_m[retained, :2], 0.08) if retained.any() else None
    return Containability(
        positions_m, retained, aabb, footprint, no_recording(len(retained)), omega_threshold=0.0
    )


def pours_of(n_packings: int, n_directions: int = 8) -> PourGrid:
    noise = np.random.default_rng(1).integers(-2, 3, (8, 3, n_packings))
    spilled = np.array(SPILLS)[:, :, None] + (noise if n_packings > 1 else 0)
    n_in = (60 - np.clip(np.where(np.array(SPILLS)[:, :, None] == 0, 0, spilled), 0, 60))[:n_directions]
    theta = AXIS_RAD + np.arange(n_directions) * pi / 4
    indent = np.array([0.01, 0.031, 0.052])
    pivots = np.zeros((n_directions, 3, 3))
    pivots[..., 0] = CENTER_M[0] + np.cos(theta)[:, None] * indent
    pivots[..., 1] = CENTER_M[1] + np.sin(theta)[:, None] * indent
    recordings = tuple(tuple(no_recording(60) for _ in range(3)) for _ in range(n_directions))
    return PourGrid(60, n_in.astype(np.int64), 60 - n_in.astype(np.int64), theta, indent, pivots, recordings)


def choice_of(grid: PourGrid, i: int, j: int) -> PourChoice:
    return PourChoice(i, j, float(grid.theta_rad[i]), grid.pivot_m[i, j], np.eye(4))


def box_mesh() -> TriangleMesh:
    corners = np.array([[x, y, z] for x in (0, 0.21) for y in (0, 0.17) for z in (0.03, 0.058)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return TriangleMesh(corners, np.array(faces, dtype=np.int64))


def drawn_picture(width: int, height: int, text: str, columns: int = 1, rows: int = 1) -> bytes:
    image = Image.new("RGB", (width, height), (208, 214, 222))
    draw = ImageDraw.Draw(image)
    w, h = width / columns, height / rows
    for k in range(columns * rows):
        x, y = (k % columns) * w, (k // columns) * h
        draw.ellipse((x + w * 0.2, y + h * 0.3, x + w * 0.8, y + h * 0.8), fill=(120, 140, 160))
        draw.rectangle((x, y, x + w - 2, y + h - 2), outline=(255, 255, 255))
        draw.text((x + 6, y + 6), text, fill=(30, 30, 30))
    buffer = BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()


@pytest.fixture(scope="session")
def tray() -> Containability:
    positions = drop_grid((0.19, 0.15), (22, 14))
    return containability_of(positions, in_tray(positions))


@pytest.fixture(scope="session")
def block() -> Containability:
    positions = drop_grid((0.06, 0.05), (8, 4), layers=2)
    return containability_of(positions, np.zeros(len(positions), dtype=bool))


@pytest.fixture(scope="session")
def pours() -> PourGrid:
    return pours_of(3)


@pytest.fixture(scope="session")
def reconstruction() -> Reconstruction:
    random = np.random.default_rng(2)
    views = [
        ViewHealth(
            f"frame-{150 + k:06d}", float(random.normal(0.0186, 0.003)), float(random.uniform(0.003, 0.05))
        )
        for k in range(23)
    ]
    views.insert(7, ViewHealth("frame-000190", None, None))
    return Reconstruction(box_mesh(), 0.031, 0.02, PoseHealth(tuple(views)))


@pytest.fixture(scope="session")
def full_content(tray: Containability, pours: PourGrid, reconstruction: Reconstruction) -> ReportContent:
    preset = load_preset("authors")
    moments = ("start", "falling", "settled", "rotated", "pushed", "end")
    return ReportContent(
        name="blue tray <3 & more",
        created="2026-11-20T14:03:22+00:00",
        preset_name="authors",
        preset=preset,
        parameters=apply_settings(
            preset,
            {"reconstruction.voxel_m": 0.003, "pouring.n_packings": 5, "reconstruction.truncation_m": None},
        ),
        containability=tray,
        surface=reconstruction.mesh,
        reconstruction=reconstruction,
        pours=pours,
        choice=choice_of(pours, 0, 0),
        scan_pictures={f"view {k}": drawn_picture(160, 120, str(k)) for k in range(24)},
        pictures={f"Drop: {word}": drawn_picture(640, 480, word) for word in moments}
        | {"The 24 pours at their end": drawn_picture(1920, 540, "pour", 8, 3)},
        seconds={
            "reconstruction": 0.9,
            "collision": 0.4,
            "containability": 3.6,
            "pouring": 1.7,
            "evidence": 6.2,
        },
        versions={"python": "3.11.7", "poursight": "0.1.0", "numpy": "2.4.6", "pybullet": "3.2.7"},
        warnings=("The views disagree by 3.0 mm: calibrate the camera, or scan again.",),
    )


@pytest.fixture(scope="session")
def choice(pours: PourGrid) -> PourChoice:
    return choice_of(pours, 0, 0)


@pytest.fixture(scope="session")
def one_direction() -> PourGrid:
    return pours_of(1, 1)


@pytest.fixture(scope="session")
def bare_content(block: Containability) -> ReportContent:
    """Only what cannot be missing."""
    preset = load_preset("default")
    return ReportContent("block", "some day", "default", preset, preset, block, box_mesh())
