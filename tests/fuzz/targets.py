"""What is fuzzed: how each kind of input is damaged, and the readers that are handed it."""

from __future__ import annotations

import json
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import trimesh

from app.cli.options import given_path, written_file
from app.cli.parameters import named_values
from app.library.compare import compare
from app.library.exchange import export_zip, import_zip
from app.library.index import INDEX_FILE, REMEMBERED_FILE, Library
from app.library.session_folder import preset_of, remembered_parameters
from app.library.summary import summarize
from app.library.thumbnail import make_thumbnail
from core.errors import StageError
from core.evaluation.fitting.spills import read_spills
from core.evaluation.labels import read_labels
from core.files import reading
from core.mesh_file import read_mesh
from core.motion.pour.plan import PourPlan
from core.parameters import Parameters, apply_settings, flatten, load_preset
from core.pipeline.given_mesh import GivenMesh
from core.pipeline.pipeline import Pipeline
from core.pipeline.running import RUNS
from core.pipeline.session_view import SessionView
from core.progress import Reporter
from core.scan import read_scan, write_scan
from core.session import Session
from core.session.cups import next_cup
from core.session.pour_runs import pour_runs
from hardware.cell import SIMULATED_CELL, read_cell
from hardware.simulation.pour_outcome.outcome import TableOutcome
from tests.fuzz.calibrated_cell import damaged_calibration, prepare_calibration
from tests.fuzz.evaluations import damaged_evaluation, prepare_evaluation
from tests.fuzz.mutation import (
    ODD_NUMBERS,
    ODD_WORDS,
    damaged_arrays,
    damaged_bytes,
    damaged_json,
    damaged_lines,
    replaced,
)
from tests.fuzz.unfinished_scan import damaged_unfinished_scan, prepare_unfinished_scan
from tests.fuzz.whole_session import make_whole_session, small_scan

Calls = Iterator[Callable[[], object]]
_REPORT_SHARE = 0.02
"""A report takes a second or two."""
_PARTS = (
    "verdict",
    "pours",
    "operator",
    "place",
    "amount",
    "judgement",
    "containability",
    "grid",
    "tries",
    "motions",
)


@dataclass(frozen=True)
class Target:
    """A kind of input.

    Attributes:
        prepare: writes what is to be damaged, once, into an empty folder.
        calls: damages a copy in an empty folder, and yields one reader after the other.
    """

    prepare: Callable[[Path], None]
    calls: Callable[[Path, Path, Random], Calls]


class _NoWork:
    """In place of the workers: what is damaged would be computed again, which is not what is tested here."""

    def run(self, *_: Any, **__: Any) -> Any:
        raise StageError("Nothing is computed here.")


def _prepare_scan(base: Path) -> None:
    write_scan(small_scan(), base)


def _scan(base: Path, folder: Path, pick: Random) -> Calls:
    shutil.copytree(base, folder / "scan")
    path = pick.choice(sorted(path for path in (folder / "scan").rglob("*") if path.is_file()))
    if not replaced(path, pick):
        damage = {".png": damaged_bytes, ".json": damaged_json}.get(path.suffix, damaged_lines)
        path.write_bytes(damage(path.read_bytes(), pick))
    yield lambda: read_scan(folder / "scan", Reporter())


def _prepare_meshes(base: Path) -> None:
    body = trimesh.creation.annulus(0.03, 0.05, 0.06, sections=8)
    for ending in ("obj", "ply", "stl", "off", "glb"):
        body.export(base / f"body.{ending}")
    (base / "text.stl").write_text(trimesh.exchange.stl.export_stl_ascii(body))
    (base / "text.ply").write_bytes(trimesh.exchange.ply.export_ply(body, encoding="ascii"))


def _mesh(base: Path, folder: Path, pick: Random) -> Calls:
    source = pick.choice(sorted(base.iterdir()))
    path = folder / source.name
    is_text = source.suffix in (".obj", ".off") or source.stem == "text"
    path.write_bytes((damaged_lines if is_text else damaged_bytes)(source.read_bytes(), pick))
    replaced(path, pick)

    def read() -> None:
        mesh = read_mesh(path, Reporter())
        assert np.isfinite(mesh.vertices_m[mesh.faces]).all(), "a mesh of odd numbers was read"

    yield read
    yield lambda: GivenMesh.read(path, Reporter())


def _prepare_labels(base: Path) -> None:
    rows = [f"thing{k},{'container' if k % 2 else 'non-container'},cup,,1,0" for k in range(4)]
    (base / "labels.csv").write_text("\n".join(["id,label,category,notes,restricted,calib", *rows, ""]))
    answers = [f"thing{k // 3},person{k % 3},1,{k % 2}" for k in range(9)]
    (base / "answers.csv").write_text("\n".join(["object,annotator,contains,pourable", *answers, ""]))


def _labels(base: Path, folder: Path, pick: Random) -> Calls:
    path = folder / "labels.csv"
    path.write_bytes(damaged_lines(pick.choice(sorted(base.iterdir())).read_bytes(), pick))
    replaced(path, pick)
    yield lambda: read_labels(folder, path)


def _prepare_spills(base: Path) -> None:
    rows = ["mug,0.5,0.02,3,60,1", "bowl,1.5,0.03,0,60,", "pan,-2,0.01,7.5,,2"]
    (base / "spills.csv").write_text("\n".join(["object,theta,indent,spilled,n_pour,seed", *rows, ""]))


def _spills(base: Path, folder: Path, pick: Random) -> Calls:
    path = folder / "spills.csv"
    path.write_bytes(damaged_lines((base / "spills.csv").read_bytes(), pick))
    replaced(path, pick)
    yield lambda: read_spills(path)


def _prepare_preset(base: Path) -> None:
    values = {name: value for name, value in flatten(Parameters()).items() if value is not None}
    (base / "mine.json").write_text(json.dumps({"description": "mine", "parameters": values}))


def _preset(base: Path, folder: Path, pick: Random) -> Calls:
    path = folder / "mine.json"
    path.write_bytes(damaged_json((base / "mine.json").read_bytes(), pick))
    replaced(path, pick)
    yield lambda: load_preset(str(path))
    yield lambda: load_preset(pick.choice(ODD_WORDS))


def _nothing(base: Path) -> None:
    """No file is needed."""


def _set(base: Path, folder: Path, pick: Random) -> Calls:
    names = [*flatten(Parameters()), *ODD_WORDS]
    odd = (
        *ODD_NUMBERS,
        *ODD_WORDS,
        "[" * 100_000,
        "[1, 2, 3]",
        "[1e999, 0, 0]",
        "null",
        '{"a": 1}',
        "1" * 4000,
    )
    text = pick.choice((f"{pick.choice(names)}={pick.choice(odd)}", pick.choice(odd)))
    yield lambda: apply_settings(Parameters(), named_values("--set", [text]))


def _prepare_cell(base: Path) -> None:
    shutil.copy(SIMULATED_CELL, base / "cell.toml")


def _cell(base: Path, folder: Path, pick: Random) -> Calls:
    path = folder / "cell.toml"
    odd = (
        *ODD_NUMBERS,
        *ODD_WORDS,
        "a=" + "[" * 100_000,
        "a=" + "{b=" * 5000,
        "[" + "a." * 5000 + "a]",
        "a=" + "1" * 5000,
    )
    path.write_bytes(damaged_lines((base / "cell.toml").read_bytes(), pick, odd))
    replaced(path, pick)
    yield lambda: read_cell(path)


def _prepare_session(base: Path) -> None:
    make_whole_session(base / "whole")


def _session(base: Path, folder: Path, pick: Random) -> Calls:
    session = Path(shutil.copytree(base / "whole", folder / "whole", copy_function=os.link))
    for _ in range(pick.choice((1, 1, 1, 2))):
        _damage_file_of(session, pick)
    yield from _readers_of(session)
    yield lambda: compare(session, base / "whole")
    yield lambda: export_zip(session, folder / "out.zip", Reporter())
    yield lambda: Library((folder,)).refresh()
    if pick.random() < _REPORT_SHARE:
        yield lambda: _report(session)


def _damage_file_of(session: Path, pick: Random) -> None:
    path = pick.choice(sorted(path for path in session.rglob("*") if path.is_file() and path.name != ".lock"))
    content = path.read_bytes()
    path.unlink()  # it is linked to the undamaged one
    kinds = {".json": damaged_json, ".npz": damaged_arrays, ".txt": damaged_lines, ".csv": damaged_lines}
    if path.suffix == ".jsonl":
        lines = content.splitlines()
        index = pick.randrange(len(lines))
        lines[index] = pick.choice((damaged_json, damaged_lines, damaged_bytes))(lines[index], pick)
        content = b"\n".join(lines) + b"\n"
    else:
        content = kinds.get(path.suffix, damaged_bytes)(content, pick)
    path.write_bytes(content)
    replaced(path, pick)


def _readers_of(session: Path) -> Calls:
    yield lambda: summarize(session)
    yield lambda: make_thumbnail(session)
    yield lambda: remembered_parameters(session)
    yield lambda: preset_of(session, "gone.json")
    view: list[SessionView] = []
    yield lambda: view.append(SessionView.of(session))
    for part in _PARTS if view else ():
        yield partial(getattr, view[0], part)
    for name, run in RUNS.items():
        yield partial(_load, session / name, run.load)
    yield lambda: next_cup(session, "", [6, 4])
    yield lambda: [(run.sentence, run.begun, run.note, run.problem) for run in pour_runs(session)]
    for folder in sorted((session / "pours").glob("[0-9]*")):
        yield partial(PourPlan.load, folder / "plan")
        yield partial(_load, folder / "table", lambda place: TableOutcome.load(place).lying)


def _load(folder: Path, load: Callable[[Path], object]) -> None:
    if folder.is_dir():
        with reading(folder):
            load(folder)


def _report(session: Path) -> None:
    with Session.open(session) as opened:
        no_work: Any = _NoWork()
        Pipeline(opened, Parameters(), no_work, Reporter()).report()


def _prepare_zip(base: Path) -> None:
    export_zip(make_whole_session(base / "whole"), base / "whole.zip", Reporter())


def _zip(base: Path, folder: Path, pick: Random) -> Calls:
    path = folder / "in.zip"
    content = (base / "whole.zip").read_bytes()
    path.write_bytes(_rezipped(content, pick) if pick.random() < 0.5 else damaged_bytes(content, pick))
    if pick.random() < 0.2:
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 2] + damaged_bytes(content[len(content) // 2 :], pick))
    replaced(path, pick)
    yield lambda: import_zip(path, folder / "sessions", Reporter())


def _rezipped(content: bytes, pick: Random) -> bytes:
    """The same members, of which one has another name, kind, size or compression."""
    buffer = BytesIO()
    kind = pick.choice((zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2, zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED))
    with zipfile.ZipFile(BytesIO(content)) as before, zipfile.ZipFile(buffer, "w", kind) as after:
        members = before.infolist()
        odd = pick.randrange(len(members))
        for index, member in enumerate(members):
            name, data = member.filename, before.read(member)
            if index == odd:
                name = pick.choice(
                    (name, "whole/", "", ".", "/", "whole//x", "../x", "C:x", "whole/" + "x" * 300, "whole/é")
                )
                data = pick.choice((data, b"", b"\0" * 20_000_000, data * 3))
            after.writestr(zipfile.ZipInfo(name), data, kind)
    packed = bytearray(buffer.getvalue())
    for _ in range(pick.choice((0, 0, 1, 8))):
        packed[pick.randrange(len(packed))] ^= 1 << pick.randrange(8)
    return bytes(packed)


def _prepare_library(base: Path) -> None:
    make_whole_session(base / "whole")
    library = Library((base,))
    library.remember(make_whole_session(base / "elsewhere" / "other"))
    library.refresh()


def _library(base: Path, folder: Path, pick: Random) -> Calls:
    root = Path(shutil.copytree(base, folder / "root", copy_function=os.link))
    path = root / pick.choice((INDEX_FILE, REMEMBERED_FILE))
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(damaged_json(content, pick))
    replaced(path, pick)
    if pick.random() < 0.3:
        (root / os.fsdecode(b"caf\xe9")).symlink_to(
            pick.choice((root / "whole", root / "nowhere", root / "whole.zip"))
        )
    library = Library((root,))
    yield library.refresh
    yield lambda: library.search("mug")
    yield lambda: library.remember(root / "nowhere")


def _paths(base: Path, folder: Path, pick: Random) -> Calls:
    (folder / "file").write_text("x")
    os.mkfifo(folder / "pipe")
    (folder / "loop").symlink_to(folder / "loop")
    names = (
        "file",
        "pipe",
        "loop",
        "none",
        "x" * 256,
        "x/" * 2500,
        os.fsdecode(b"caf\xe9"),
        "file/in",
        ".",
        "a\nb",
    )
    text = pick.choice(
        (str(folder / pick.choice(names)), "", "/dev/zero", "/dev/null", "/proc/self/mem", "-")
    )
    yield lambda: given_path(text)
    yield lambda: written_file(text)
    yield lambda: read_mesh(given_path(text), Reporter())
    yield lambda: load_preset(text)


TARGETS: dict[str, Target] = {
    "scan": Target(_prepare_scan, _scan),
    "unfinished scan": Target(prepare_unfinished_scan, damaged_unfinished_scan),
    "mesh": Target(_prepare_meshes, _mesh),
    "labels": Target(_prepare_labels, _labels),
    "spills": Target(_prepare_spills, _spills),
    "preset": Target(_prepare_preset, _preset),
    "set": Target(_nothing, _set),
    "cell": Target(_prepare_cell, _cell),
    "calibration": Target(prepare_calibration, damaged_calibration),
    "evaluation": Target(prepare_evaluation, damaged_evaluation),
    "session": Target(_prepare_session, _session),
    "zip": Target(_prepare_zip, _zip),
    "library": Target(_prepare_library, _library),
    "path": Target(_nothing, _paths),
}
