"""A session that holds every file a session can hold, written by the classes that write real ones."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.library.session_folder import remember_parameters
from core.collision import CollisionModel
from core.geometry import look_at
from core.imagination.amount.result import Amount, PlannedAmount
from core.imagination.capacity.result import Capacity
from core.imagination.hollow_map import HollowMap
from core.imagination.judgement import Judgement
from core.imagination.recording import Recording
from core.imagination.rendering.evidence import Evidence
from core.imagination.results import Drop, Footprint, PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.imagination.risk.result import PourRisk
from core.imagination.risk.tries import Tries
from core.imagination.verdict import Verdict
from core.mesh import TriangleMesh
from core.motion.pour.feasibility import PourFeasibility, PourMotions
from core.motion.pour.plan import MOVES, PlannedMove, PourPlan
from core.motion.trajectory import JointTrajectory
from core.parameters import Parameters
from core.pipeline.freshness import motion_settings
from core.pipeline.pipeline import WARNINGS_FILE
from core.quality.measures import HiddenCavity, ScanQuality
from core.quality.view_quality import ViewQuality
from core.reconstruction.pose_health import PoseHealth, ViewHealth
from core.reconstruction.result import Reconstruction, Refinement, ViewCorrection
from core.scan import Scan, write_scan
from core.scan.model import CropBox, Intrinsics, RgbdFrame
from core.session import Session
from core.session.operator_choice import write_operator_choice
from core.session.pour_runs import EVENTS_FILE, STATES_FILE, Outcome, next_run_folder, write_outcome
from core.stages import SCAN, stage
from hardware.simulation.pour_outcome.outcome import TableOutcome

N_VIEWS, N_DROP, N_POUR = 4, 12, 6
_VERDICT = Verdict(0.4, 0.1, 21.0, 18.5)


def make_whole_session(folder: Path) -> Path:
    """Write it; takes a tenth of a second."""
    parameters = Parameters()
    with Session.create_or_open(folder) as session:

        def write(
            name: str, save: Callable[[Path], object], settings: dict[str, object] | None = None
        ) -> None:
            inputs = () if name == SCAN else stage(name).inputs_of("reconstruction")
            digests = {one: record.digest for one in inputs if (record := session.record(one)) is not None}
            if settings is None:
                settings = stage(name).settings(parameters)
            with session.writing(name, inputs=digests, parameters=settings, seconds=1.0) as place:
                save(place)
                (place / WARNINGS_FILE).write_text(json.dumps({"warnings": [f"{name} wants to be known."]}))

        write(
            SCAN, lambda place: write_scan(small_scan(), place), {"cell": {"name": "cell"}, "object": "mug"}
        )
        write("reconstruction", reconstruction().save)
        write("quality", quality().save)
        write("collision", CollisionModel("exact", (box_mesh(),), box_mesh()).save)
        write("containability", drop().save)
        write("judgement", Judgement(0.1, _VERDICT, capacity()).save)
        write("retention", retention().save)
        write("amount", PlannedAmount(N_POUR, amount()).save)
        write("pouring", grid().save)
        write("risk", Tries(risk(), choice(0, 1)).save)
        write("motion", motions().save, motion_settings({"arm": "UR5"}, parameters))
        write("evidence", Evidence({"drop_6_end.png": _png(), "drop.mp4": b"film"}, "EGL").save)
        pours = session.record("pouring")
        assert pours is not None
        write_operator_choice(folder, 1, 2, "It is nearer.", pours.digest)
        _write_run(folder, pours.digest)
        remember_parameters(folder, "default", parameters)
    (folder / "report.html").write_text("<!DOCTYPE html><title>report</title><h1>A report</h1>")
    return folder


def small_scan() -> Scan:
    """Four small views of a table, each from another side."""
    frames = []
    for index in range(N_VIEWS):
        eye = np.array([0.3 * np.cos(index) - 0.06, 0.3 * np.sin(index) - 0.35, 0.6])
        depth = np.full((24, 32), 0.7 + 0.001 * index, dtype=np.float32)
        color = np.full((24, 32, 3), 50 * index, dtype=np.uint8)
        frames.append(
            RgbdFrame(f"frame-{index:06d}", color, depth, look_at(eye, np.array([-0.06, -0.35, 0.05])))
        )
    return Scan(
        tuple(frames), Intrinsics(25.0, 25.0, 16.0, 12.0), 0.02, CropBox((-0.3, -0.5, 0), (0.2, -0.1, 0.3))
    )


def box_mesh() -> TriangleMesh:
    """A closed box."""
    corners = np.array([[x, y, z] for x in (0, 0.1) for y in (0, 0.08) for z in (0, 0.05)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return TriangleMesh(corners, np.array(faces, dtype=np.int64))


def reconstruction() -> Reconstruction:
    """With corrected poses."""
    views = tuple(ViewHealth(f"frame-{k:06d}", 0.02 + 0.001 * k, 0.01) for k in range(N_VIEWS))
    corrections = tuple(ViewCorrection(view.name, 0.001, 0.01, 0.002, 0.001, np.eye(4)) for view in views)
    refined = Refinement(corrections, 0.002, 0.001, 0.001, 0.0005, 0.001)
    return Reconstruction(box_mesh(), 0.02, 0.01, PoseHealth(views), refined)


def quality() -> ScanQuality:
    """Of a usable scan with a hidden cavity."""
    views = tuple(
        ViewQuality(f"frame-{k:06d}", 0.9, False, 0.02, 0.01, 0.0, 0.001, 0.001) for k in range(N_VIEWS)
    )
    cavity = HiddenCavity(np.zeros((2, 3)), np.zeros((3, 3), dtype=np.int64), 1e-4, 2.0, 0.03, 0.02)
    return ScanQuality(views, cavity, np.arange(8), 0.1, "usable", ("usable: a little was not seen.",))


def recording(n: int) -> Recording:
    """Three moments."""
    return Recording(
        np.arange(3, dtype=np.float32),
        np.zeros((3, n, 3), dtype=np.float32),
        np.zeros((3, n, 4), dtype=np.float32),
        np.tile(np.eye(4, dtype=np.float32), (3, 1, 1)),
    )


def drop() -> Drop:
    """Half of the candies stayed."""
    line = np.linspace(0, 0.1, N_DROP)
    positions = np.column_stack([line, line[::-1] ** 2, np.full(N_DROP, 0.2)])
    retained = np.arange(N_DROP) < N_DROP // 2
    footprint = Footprint.of(positions[retained, :2], 0.05)
    return Drop(positions, retained, np.array([[0, 0, 0], [0.1, 0.08, 0.05]]), footprint, recording(N_DROP))


def capacity() -> Capacity:
    """Two fillings."""
    curve = np.linspace(0, 0.04, 5), np.linspace(0, 20, 5)
    fillings = (30, 30), (25.0, 24.0), (21.0, 21.0)
    found = Capacity(
        21.0, 0.5, 17.0, 1.5, 18.0, 17.5, 1.0, *fillings, 0.04, 0.03, "", *curve, 1.2, recording(30)
    )
    hollows = HollowMap(
        np.zeros(2), 0.01, np.full((3, 2), 0.04), np.full((3, 2), 0.01), np.ones((3, 2), dtype=bool)
    )
    return replace(found, hollows=hollows)


def retention() -> Retention:
    """Of eight directions."""
    left = np.tile(np.array([10, 10, 7, 2]), (8, 1))
    return Retention(12, 10, np.linspace(0, 0.6, 4), np.arange(8) * np.pi / 4, left)


def amount() -> Amount:
    """Two cups."""
    return Amount("safe", 21, 14, 10, (N_POUR, 4), 0.5, 0.02, 0.47, "Pour slowly.", "")


def grid() -> PourGrid:
    """Two directions, three distances, one packing."""
    n_in = np.array([[[3], [6], [6]], [[1], [4], [6]]])
    recordings = tuple(tuple(recording(N_POUR) for _ in range(3)) for _ in range(2))
    theta, indent = np.array([0.0, np.pi]), np.array([0.01, 0.02, 0.03])
    return PourGrid(N_POUR, n_in, N_POUR - n_in, theta, indent, np.zeros((2, 3, 3)), recordings)


def risk() -> PourRisk:
    """Two tries each."""
    return PourRisk(N_POUR, np.array([[[3, 2], [0, 0], [0, 1]], [[5, 5], [2, 0], [0, 0]]]))


def choice(i: int, j: int) -> PourChoice:
    """One of the grid's pours."""
    return PourChoice(i, j, 0.0, np.zeros(3), np.eye(4))


def motions() -> PourMotions:
    """The arm can make all pours but one."""
    pours = [(i, j) for i in range(2) for j in range(3)]
    found = tuple(
        PourFeasibility(*one, one != (0, 0), "" if one != (0, 0) else "Too far.", 0.02, 2.0, 20.0)
        for one in pours
    )
    return PourMotions(found, choice(0, 1), choice(0, 0), risk())


def plan() -> PourPlan:
    """At rest all the time."""
    still = JointTrajectory(np.array([0.0, 0.008]), np.zeros((2, 6)))
    moves = tuple(PlannedMove(name, phase, still, holds, after) for name, phase, holds, after in MOVES)
    return PourPlan(0, 1, moves, np.eye(4), 0.02, ("cup", "table"), 0.01, 0.0, 0.5, 2.0, 2.1)


def table_outcome() -> TableOutcome:
    """Five in, one beside."""
    inside = np.arange(N_POUR) > 0
    quaternions = np.tile(np.array([0, 0, 0, 1.0]), (N_POUR, 1))
    assert len(quaternions) == N_POUR
    return TableOutcome(
        inside,
        np.zeros(N_POUR, dtype=bool),
        np.zeros((N_POUR, 3)),
        np.ones(N_POUR),
        np.eye(4),
        recording(N_POUR),
    )


def _write_run(folder: Path, digest: str) -> None:
    run = next_run_folder(folder)
    (run / "plan").mkdir(parents=True)
    (run / "table").mkdir()
    time = "2026-11-21T11:09:44.000+00:00"
    events = [
        {"time": time, "kind": "confirmed", "sentence": "Go.",
         "imagination": digest, "note": "Nearer.", "is_back_off": False},
        {"time": time, "kind": "move", "sentence": "carry: 3 s", "duration_s": 3.0},
        {"time": time, "kind": "stopped", "sentence": "A person asked for it."},
        {"time": time, "kind": "done", "sentence": "Done."},
    ]  # fmt: skip
    (run / EVENTS_FILE).write_text("".join(json.dumps(event) + "\n" for event in events))
    joints = [f"joint_{k}_rad" for k in range(1, 7)]
    rows = [f"{0.04 * k:.4f},pour,{','.join(['0.000000'] * 6)}" for k in range(5)]
    (run / STATES_FILE).write_text("\n".join([",".join(["time_s", "move", *joints]), *rows, ""]))
    plan().save(run / "plan")
    table_outcome().save(run / "table")
    write_outcome(run, Outcome(N_POUR, 1, "One rolled off.", is_simulated=True, facts={"n_in_cup": 0}))


def _png() -> bytes:
    from io import BytesIO

    from PIL import Image

    buffer = BytesIO()
    Image.new("RGB", (640, 480), (200, 0, 0)).save(buffer, "PNG")
    return buffer.getvalue()
