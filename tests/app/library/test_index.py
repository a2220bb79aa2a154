import json
import shutil
import threading
from pathlib import Path

import pytest

from app.library import index
from app.library.index import INDEX_FILE, REMEMBERED_FILE, Library
from core.errors import SessionError
from core.session import Session
from tests.awake import within


@pytest.fixture
def library(library_root):
    return Library((library_root,))


@pytest.fixture
def summed_up(monkeypatch):
    """The names of the sessions that were read."""
    names = []

    def noted(folder):
        names.append(folder.name)
        return real(folder)

    real = index.summarize
    monkeypatch.setattr(index, "summarize", noted)
    return names


def name_all(summaries):
    return [summary.name for summary in summaries]


def dated(folder: Path, created: str) -> Path:
    header = json.loads((folder / "session.json").read_text())
    (folder / "session.json").write_text(json.dumps(header | {"created": created}))
    return folder


def test_no_folder_yet_is_no_sessions(library, library_root):
    assert library.refresh() == ()
    assert library.search("") == ()
    assert not library_root.exists()


def test_the_newest_stands_first(library, make_session):
    dated(make_session.empty("old"), "2026-01-02T00:00:00+00:00")
    dated(make_session.empty("new"), "2026-11-02T00:00:00+00:00")
    dated(make_session.empty("middle"), "2026-05-02T00:00:00+00:00")
    assert name_all(library.refresh()) == ["new", "middle", "old"]


def test_only_what_changed_is_read_again(library, library_root, make_session, summed_up):
    mug, bowl = make_session("mug"), make_session("bowl")
    before = library.refresh()
    assert sorted(summed_up) == ["bowl", "mug"]
    summed_up.clear()
    assert library.refresh() == before
    assert Library((library_root,)).refresh() == before
    assert summed_up == []
    with Session.open(bowl) as session:
        make_session.imagine(session, kept=10)
    assert {summary.name: summary.omega for summary in library.refresh()} == {"mug": 0.4, "bowl": 0.1}
    run = make_session.pour(mug)
    library.refresh()
    (run / "outcome.json").write_text(
        '{"n_candies": 60, "n_spilled": 7, "remarks": "", "is_simulated": false, "facts": {}}'
    )
    assert {summary.n_spilled for summary in library.refresh()} == {None, 7}
    assert summed_up == ["bowl", "mug", "mug"]


def test_the_index_can_be_deleted_or_damaged(library, library_root, make_session):
    make_session("mug")
    before = library.refresh()
    for damage in (b"", b"{", b'{"/x": 3}', b"\xff\x00"):
        (library_root / INDEX_FILE).write_bytes(damage)
        assert Library((library_root,)).refresh() == before
    (library_root / INDEX_FILE).unlink()
    assert Library((library_root,)).refresh() == before
    assert (library_root / INDEX_FILE).is_file()
    assert not list(library_root.glob("*.part")) and not list(library_root.glob(".*.part"))


def test_an_index_of_another_format_is_made_anew(library, make_session, summed_up, monkeypatch):
    make_session("mug")
    library.refresh()
    monkeypatch.setattr(index, "_FORMAT", index._FORMAT + 1)
    library.refresh()
    assert summed_up == ["mug", "mug"]


def test_a_deleted_session_is_gone(library, make_session):
    folder = make_session("mug")
    make_session("bowl")
    library.refresh()
    shutil.rmtree(folder)
    assert name_all(library.refresh()) == ["bowl"]


def test_other_folders_and_files_are_no_sessions(library, library_root, make_session):
    make_session("mug")
    (library_root / "notes").mkdir()
    (library_root / "notes.txt").write_text("notes")
    (library_root / ".importing-abc").mkdir()
    assert name_all(library.refresh()) == ["mug"]


def test_a_damaged_session_is_listed_with_its_problem_and_without_it_when_mended(library, make_session):
    folder = make_session("mug")
    header = (folder / "session.json").read_text()
    (folder / "session.json").write_text("nonsense")
    (summary,) = library.refresh()
    assert "damaged" in summary.problem
    (folder / "session.json").write_text(header)
    (summary,) = library.refresh()
    assert summary.problem == ""


def test_sessions_elsewhere_are_remembered_until_forgotten_or_gone(
    library, library_root, make_session, tmp_path
):
    make_session.root = tmp_path / "elsewhere"
    away, gone = make_session("away"), make_session("gone")
    for folder in (away, gone, away):
        library.remember(folder)
    assert sorted(name_all(Library((library_root,)).refresh())) == ["away", "gone"]
    shutil.rmtree(gone)
    assert name_all(library.refresh()) == ["away"]
    assert json.loads((library_root / REMEMBERED_FILE).read_text()) == [str(away)]
    library.forget(away)
    assert library.refresh() == ()
    assert away.is_dir()


def test_a_disk_that_is_not_plugged_in_is_not_forgotten(library, make_session, tmp_path):
    make_session.root = tmp_path / "disk"
    library.remember(make_session("away"))
    (tmp_path / "disk").rename(tmp_path / "unplugged")
    assert library.refresh() == ()
    (tmp_path / "unplugged").rename(tmp_path / "disk")
    assert name_all(library.refresh()) == ["away"]


def test_what_lies_in_the_library_is_not_remembered_twice(library, library_root, make_session):
    library.remember(make_session("mug"))
    assert not (library_root / REMEMBERED_FILE).exists()
    assert name_all(library.refresh()) == ["mug"]


def test_only_sessions_are_remembered(library, tmp_path):
    with pytest.raises(SessionError, match="is no session"):
        library.remember(tmp_path)


def test_a_library_that_cannot_be_written_still_lists(make_session, tmp_path):
    in_the_way = tmp_path / "file"
    in_the_way.write_text("no folder")
    folder = make_session("mug")
    library = Library((in_the_way, folder.parent))
    assert name_all(library.refresh()) == ["mug"]
    make_session.root = tmp_path / "elsewhere"
    with pytest.raises(SessionError, match="cannot be written"):
        library.remember(make_session("away"))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", {"mug", "block"}),
        ("MUG", {"mug"}),
        ("simulated scan", {"mug", "block"}),
        ("open container", {"mug"}),
        ("not a container", {"block"}),
        ("spilled mug", {"mug"}),
        ("spilled block", set()),
        ("2026-11", {"mug"}),
        ("november", {"mug"}),
        ("teapot", set()),
    ],
)
def test_every_word_must_be_found(library, make_session, text, expected):
    mug = dated(make_session("mug"), "2026-11-20T12:00:00+00:00")
    make_session.pour(mug, spilled=2)
    dated(make_session("block", kept=0), "2026-01-20T12:00:00+00:00")
    library.refresh()
    assert set(name_all(library.search(text))) == expected


def test_500_sessions_that_did_not_change_take_less_than_half_a_second(library_root, make_session):
    first = make_session("mug")
    make_session.pour(first, spilled=2)
    small = {path.relative_to(first): path.read_bytes() for path in first.rglob("*.json*")}
    for number in range(1, 500):
        for name, content in small.items():
            path = library_root / f"mug-{number}" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    Library((library_root,)).refresh()
    with within(0.5):
        library = Library((library_root,))
        assert len(library.refresh()) == 500
    with within(0.1):
        assert len(library.search("mug open")) == 500


def test_threads_may_refresh_and_remember_at_once(library, make_session, tmp_path):
    make_session("mug")
    make_session.root = tmp_path / "elsewhere"
    away = [make_session.empty(f"away {number}") for number in range(8)]
    threads = [threading.Thread(target=library.remember, args=(folder,)) for folder in away]
    threads += [threading.Thread(target=library.refresh) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(library.refresh()) == 9
