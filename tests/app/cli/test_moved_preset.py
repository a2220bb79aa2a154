"""A session keeps what it needs: the preset's file may be moved, or the session go elsewhere."""

import json

import pytest

from app.library.exchange import export_zip, import_zip
from app.library.session_folder import preset_of, remember_parameters
from core.parameters import apply_settings, load_preset
from core.progress import Reporter
from core.session import Session

OURS = {"pouring.n_pour": 33, "holding.n_load": 8}


@pytest.fixture
def gone(tmp_path):
    """A session that was imagined with a preset in a file, which is no longer there."""
    preset = tmp_path / "ours.json"
    preset.write_text(json.dumps({"parameters": OURS}))
    parameters = apply_settings(load_preset(str(preset)), {"seed": 5})
    with Session.create_or_open(tmp_path / "session") as session:
        remember_parameters(session.path, str(preset), parameters)
    preset.unlink()
    return session.path, str(preset)


def test_the_presets_values_are_those_of_its_file(gone):
    session, preset = gone
    name, values = preset_of(session, preset)
    assert (name, values) == (preset, apply_settings(load_preset("default"), OURS))


def test_they_go_with_the_session(gone, tmp_path):
    session, preset = gone
    export_zip(session, tmp_path / "away.zip", Reporter())
    (tmp_path / "elsewhere").mkdir()
    arrived = import_zip(tmp_path / "away.zip", tmp_path / "elsewhere", Reporter())
    assert preset_of(arrived, preset) == preset_of(session, preset)


@pytest.mark.system
def test_a_report_is_made_after_the_preset_was_moved(mesh_session, tmp_path, poursight):
    preset = tmp_path / "ours.json"
    preset.write_text(json.dumps({"parameters": {"containability.verdict": "omega", "risk.n_tries": 0}}))
    words = ("--set=containability.n_max=64", "--set=containability.n_min=40", "--set=pouring.n_pour=20")
    code, _, err = poursight("imagine", mesh_session, "--preset", preset, *words)
    assert code == 0, err
    preset.rename(tmp_path / "moved.json")
    (mesh_session / "report.html").unlink(missing_ok=True)
    code, _, err = poursight("report", mesh_session)
    assert code == 0, err
    assert str(preset) in (mesh_session / "report.html").read_text(encoding="utf-8")
