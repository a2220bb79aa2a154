from datetime import date

import pytest

from app.library.places import SESSIONS_VARIABLE, new_session_folder, sessions_folder, slug


def test_the_variable_decides_where_sessions_live(tmp_path, monkeypatch):
    monkeypatch.setenv(SESSIONS_VARIABLE, str(tmp_path / "here"))
    assert sessions_folder() == tmp_path / "here"
    assert not sessions_folder().exists()
    monkeypatch.delenv(SESSIONS_VARIABLE)
    assert sessions_folder().parts[-2:] == ("Poursight", "sessions")


def test_a_new_folder_is_never_one_that_exists(tmp_path):
    first = new_session_folder("Blue Mug", tmp_path)
    assert first == tmp_path / f"{date.today().isoformat()}-blue-mug"
    first.mkdir()
    second = new_session_folder("Blue Mug", tmp_path)
    assert second.name == f"{first.name}-2"
    second.write_text("a file is in the way, too")
    assert new_session_folder("Blue Mug", tmp_path).name == f"{first.name}-3"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("../../etc/passwd", "etc-passwd"),
        ("Müsli Schüssel (2)", "müsli-schüssel-2"),
        ("  ", "session"),
        ("...", "session"),
        ("a" * 200, "a" * 60),
        ("con:aux|x\n_y", "con-aux-x-y"),
    ],
)
def test_names_become_folders_on_any_system(name, expected):
    assert slug(name) == expected
