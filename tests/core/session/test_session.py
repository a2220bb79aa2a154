import json
from pathlib import Path

import pytest

from core.errors import SessionError
from core.session import Session

INPUTS = {"scan": "0" * 64}
PARAMETERS = {"seed": 3, "voxel_m": 0.003, "crop_min_m": (-0.3, -0.55, 0.03), "truncation_m": None}


def write_model(session: Session, text: str = "v 0 0 0\n", **changes: object) -> None:
    with session.writing("reconstruction", inputs=INPUTS, parameters=PARAMETERS | changes) as folder:
        (folder / "mesh.obj").write_text(text)
        (folder / "parts").mkdir()
        (folder / "parts" / "0.obj").write_text("v 1 1 1\n")


@pytest.fixture
def session(tmp_path: Path) -> Session:
    return Session.create_or_open(tmp_path / "blue mug")


def test_new_session_is_called_like_its_folder_and_opens_again(session: Session) -> None:
    assert session.name == "blue mug"
    again = Session.open(session.path)
    assert (again.name, again.created) == (session.name, session.created)
    assert json.loads((session.path / "session.json").read_text())["format"] == 1


def test_a_written_stage_has_a_record_and_is_fresh(session: Session) -> None:
    with session:
        write_model(session)
    record = Session.open(session.path).record("reconstruction")
    assert record is not None
    assert (record.stage, record.inputs, record.parameters["seed"]) == ("reconstruction", INPUTS, 3)
    assert record.files == {"mesh.obj": 8, "parts/0.obj": 8}
    assert set(record.versions) == {"python", "poursight", "numpy", "pybullet", "mujoco-core", "open3d"}
    assert record.seconds >= 0 and record.created.endswith("+00:00")
    assert session.is_fresh("reconstruction", INPUTS, PARAMETERS)
    assert session.folder("reconstruction") == session.path / "reconstruction"


def test_stale_when_an_input_a_parameter_or_a_file_differs(session: Session) -> None:
    with session:
        write_model(session)
    assert not session.is_fresh("reconstruction", {"scan": "1" * 64}, PARAMETERS)
    assert not session.is_fresh("reconstruction", INPUTS, PARAMETERS | {"seed": 4})
    assert not session.is_fresh("collision", INPUTS, PARAMETERS)
    mesh = session.path / "reconstruction" / "mesh.obj"
    mesh.write_text("v 0")
    assert not session.is_fresh("reconstruction", INPUTS, PARAMETERS)
    mesh.unlink()
    assert not session.is_fresh("reconstruction", INPUTS, PARAMETERS)


def test_the_same_result_written_again_keeps_its_digest(session: Session) -> None:
    with session:
        write_model(session)
        before = session.record("reconstruction")
        write_model(session, seed=4)
        after = session.record("reconstruction")
    assert before is not None and after is not None
    assert before.digest == after.digest and before.parameters != after.parameters


@pytest.mark.parametrize("text", ["", "{", "[]", '{"stage": "reconstruction"}', '{"surprise": 1}'])
def test_a_damaged_record_counts_as_no_record(session: Session, text: str) -> None:
    with session:
        write_model(session)
    (session.path / "reconstruction" / "record.json").write_text(text)
    assert session.record("reconstruction") is None
    assert not session.is_fresh("reconstruction", INPUTS, PARAMETERS)
    with pytest.raises(SessionError, match="no finished stage 'reconstruction'"):
        session.folder("reconstruction")


def test_a_failed_stage_leaves_the_old_one_and_no_trace(session: Session) -> None:
    with session:
        write_model(session)
        with (
            pytest.raises(KeyboardInterrupt),
            session.writing("reconstruction", inputs={}, parameters={}) as folder,
        ):
            (folder / "mesh.obj").write_text("half")
            raise KeyboardInterrupt
        assert not folder.exists()
    assert session.is_fresh("reconstruction", INPUTS, PARAMETERS)
    assert [path.name for path in session.path.glob(".recon*")] == []


def test_seconds_can_be_given(session: Session) -> None:
    with session, session.writing("scan", inputs={}, parameters={}, seconds=12.5):
        pass
    record = session.record("scan")
    assert record is not None and record.seconds == 12.5


def test_writing_needs_the_lock_a_plain_name_and_plain_parameters(session: Session) -> None:
    with pytest.raises(RuntimeError), session.writing("scan", inputs={}, parameters={}):
        pass
    with session:
        with pytest.raises(ValueError), session.writing("../scan", inputs={}, parameters={}):
            pass
        with pytest.raises(ValueError), session.writing("scan", inputs={}, parameters={"x": float("nan")}):
            pass


def test_what_is_no_session_is_refused_with_a_sentence(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("x")
    (tmp_path / "empty").mkdir()
    for path, sentence in (
        (tmp_path / "nowhere", "There is no session"),
        (file, "is a file; a session is a folder"),
        (tmp_path / "empty", "is no session"),
        (tmp_path, "is no session"),
    ):
        with pytest.raises(SessionError, match=sentence):
            Session.open(path)
    with pytest.raises(SessionError, match="is a file"):
        Session.create_or_open(file)
    with pytest.raises(SessionError, match="holds other files"):
        Session.create_or_open(tmp_path)
    with pytest.raises(SessionError, match="cannot be made"):
        Session.create_or_open(file / "below")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "file"]
    assert Session.create_or_open(tmp_path / "empty").name == "empty"


def test_a_newer_session_is_refused(session: Session) -> None:
    (session.path / "session.json").write_text('{"format": 9, "something": "new"}')
    with pytest.raises(SessionError, match=r"newer Poursight \(format 9, this one knows 1\); update"):
        Session.open(session.path)


@pytest.mark.parametrize(
    "text", ["", "{", "[1]", "{}", '{"format": 1, "name": 7, "created": ""}', "\x00\xff"]
)
def test_a_damaged_header_costs_one_file(session: Session, text: str) -> None:
    with session:
        write_model(session)
    header = session.path / "session.json"
    header.write_text(text)
    with pytest.raises(SessionError, match=r"is damaged .*; delete this one file"):
        Session.create_or_open(session.path)
    header.unlink()
    with Session.open(session.path) as again:
        assert again.is_fresh("reconstruction", INPUTS, PARAMETERS)
    assert Session.open(session.path).name == "blue mug"
    assert header.exists()
