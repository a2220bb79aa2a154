import builtins
import os
import re
import subprocess
import sys
import zipfile
from base64 import b64encode

import pytest
from PIL import ImageFile

from app.library.exchange import export_html, export_model, export_pdf, export_zip, pdf_job, report_is_current
from core.errors import Cancelled, InputError, SessionError, StageError
from core.mesh_file import read_mesh, read_ply
from core.progress import Reporter
from core.workers import WorkerPool


@pytest.fixture
def session(make_session):
    folder = make_session("mug")
    make_session.pour(folder, spilled=1)
    make_session.report(folder)
    return folder


def names(target):
    with zipfile.ZipFile(target) as archive:
        assert archive.testzip() is None
        return {info.filename for info in archive.infolist()}


def test_html_is_the_report(session, tmp_path):
    export_html(session, tmp_path / "a.html")
    assert (tmp_path / "a.html").read_bytes() == (session / "report.html").read_bytes()


@pytest.mark.parametrize("ending", [".ply", ".glb"])
def test_a_coloured_model_goes_out_whole_or_not_at_all(session, make_session, tmp_path, ending):
    target = tmp_path / f"mug{ending}"
    with pytest.raises(SessionError, match="no coloured model"):
        export_model(session, target)
    make_session.photograph(session)
    export_model(session, target)
    mesh = read_mesh(target, Reporter())
    own = read_ply(session / "reconstruction" / "mesh.ply")
    assert mesh.volume_m3 == pytest.approx(own.volume_m3, rel=1e-4)
    assert mesh.aabb_max_m == pytest.approx(own.aabb_max_m, abs=1e-6)
    before = target.read_bytes()
    with pytest.raises(InputError, match="exists"):
        export_model(session, target)
    assert target.read_bytes() == before
    with pytest.raises(InputError, match=r"\.ply or \.glb"):
        export_model(session, tmp_path / "mug.obj")


def test_zip_holds_every_file_but_hidden_ones(session, tmp_path):
    (session / ".scan.writing").mkdir()
    (session / ".scan.writing" / "half.png").write_text("half")
    (session / ".lock").touch()
    (session / "notes and müsli.txt").write_text("mine")
    export_zip(session, tmp_path / "a.zip", Reporter())
    files = {path.relative_to(session.parent) for path in session.rglob("*") if path.is_file()}
    assert names(tmp_path / "a.zip") == {
        file.as_posix() for file in files if not any(part.startswith(".") for part in file.parts)
    }
    assert "mug/notes and müsli.txt" in names(tmp_path / "a.zip")


def test_progress_ends_at_all(session, tmp_path):
    told = []

    class Face(Reporter):
        def progress(self, stage, done, total):
            told.append((stage, done / total))

    export_zip(session, tmp_path / "a.zip", Face())
    assert told == sorted(told) and told[-1] == ("export", 1.0)


@pytest.mark.parametrize("export", ["html", "zip"])
def test_what_exists_is_replaced_only_when_asked(session, tmp_path, export):
    target = tmp_path / "there"
    target.write_text("precious")

    def run(overwrite):
        if export == "html":
            export_html(session, target, overwrite)
        else:
            export_zip(session, target, Reporter(), overwrite)

    with pytest.raises(InputError, match="exists already"):
        run(overwrite=False)
    assert target.read_text() == "precious"
    run(overwrite=True)
    assert target.stat().st_size > 8 and target.read_bytes()[:8] != b"precious"
    assert list(tmp_path.glob(".*.part")) == []


@pytest.mark.parametrize("name", ["no/such/folder/a.zip", "sessions", "x" * 300])
def test_a_target_that_cannot_be_is_a_sentence(session, tmp_path, name):
    for run in (
        lambda: export_html(session, tmp_path / name),
        lambda: export_zip(session, tmp_path / name, Reporter()),
    ):
        with pytest.raises(InputError) as refused:
            run()
        assert str(refused.value).endswith(".")


def test_no_report_yet(make_session, tmp_path):
    with pytest.raises(SessionError, match="write one first"):
        export_html(make_session("mug"), tmp_path / "a.html")
    with pytest.raises(SessionError, match="There is no session"):
        export_zip(tmp_path / "nowhere", tmp_path / "a.zip", Reporter())


def test_a_session_that_changes_meanwhile_is_refused(session, make_session, tmp_path):
    class Meddler(Reporter):
        def progress(self, stage, done, total):
            if done == total:
                make_session.pour(session)

    with pytest.raises(SessionError, match="changed while"):
        export_zip(session, tmp_path / "a.zip", Meddler())
    assert list(tmp_path.glob("*.zip")) == list(tmp_path.glob(".*.part")) == []


def test_cancelling_leaves_nothing(session, tmp_path):
    reporter = Reporter()
    reporter.cancel()
    with pytest.raises(Cancelled):
        export_zip(session, tmp_path / "a.zip", reporter)
    assert list(tmp_path.glob("*.zip")) == list(tmp_path.glob(".*.part")) == []


def test_a_report_is_old_when_something_came_after_it(session, make_session):
    assert report_is_current(session)
    run = make_session.pour(session)
    later_s = (session / "report.html").stat().st_mtime + 5
    os.utime(run / "events.jsonl", (later_s, later_s))
    assert not report_is_current(session)
    os.utime(run / "events.jsonl", (later_s - 50, later_s - 50))
    assert report_is_current(session)
    (session / "operator_choice.json").write_text("{}")
    os.utime(session / "operator_choice.json", (later_s, later_s))
    assert not report_is_current(session)
    (session / "report.html").unlink()
    assert not report_is_current(session)


def test_pdf_of_a_report(session, tmp_path):
    target = tmp_path / "a.pdf"
    with WorkerPool(1) as pool:
        export_pdf(session, target, pool, Reporter())
        with pytest.raises(InputError, match="exists already"):
            export_pdf(session, target, pool, Reporter())
    assert target.read_bytes().startswith(b"%PDF-") and target.read_bytes().rstrip().endswith(b"%%EOF")
    assert list(tmp_path.glob(".*.part")) == []


def test_pdf_loads_nothing_from_elsewhere(tmp_path, results):
    secret = tmp_path / "secret.png"
    secret.write_bytes(results.png((8, 8), (1, 2, 3)))
    own = b64encode(results.png((8, 8), (4, 5, 6))).decode()
    page = f'<img src="{secret.as_uri()}" alt="x"><img src="data:image/png;base64,{own}" alt="y">'
    page += f'<link rel="stylesheet" href="{secret.as_uri()}"><object data="{secret.as_uri()}"></object>'
    (tmp_path / "a.html").write_text(page)
    pdf_job(tmp_path / "a.html", tmp_path / "a.pdf")
    assert len(re.findall(rb"/Subtype\s*/Image", (tmp_path / "a.pdf").read_bytes())) == 1


def test_printing_leaves_pictures_as_strict_as_before(session, tmp_path):
    pdf_job(session / "report.html", tmp_path / "a.pdf")
    assert ImageFile.LOAD_TRUNCATED_IMAGES is False


def test_without_the_systems_libraries_a_pdf_is_a_sentence(session, tmp_path, monkeypatch):
    def missing(name, *rest, **named):
        if name.startswith("weasyprint"):
            raise OSError("cannot load library 'libpango-1.0-0': no such file\nand more")
        return real(name, *rest, **named)

    real = builtins.__import__
    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(StageError, match=r"apt-get install -y libpango-1\.0-0"):
        pdf_job(session / "report.html", tmp_path / "a.pdf")


def test_the_module_is_cheap_to_import():
    code = (
        "import app.library.exchange, app.library.compare, app.library.index, sys;"
        "print([m for m in ('weasyprint', 'PIL', 'trimesh', 'matplotlib', 'PySide6', 'send2trash', 'numba')"
        " if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
