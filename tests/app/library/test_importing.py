import random
import stat
import zipfile

import pytest

from app.library.exchange import export_zip, import_zip, report_is_current
from app.library.summary import summarize
from core.errors import InputError, PoursightError
from core.progress import Reporter

HEADER = '{"format": 1, "name": "mug", "created": "2026-11-20T12:00:00+00:00"}'


@pytest.fixture
def archive(tmp_path):
    """Write a ZIP file of (name, content) and return its path."""

    def write(*members):
        with zipfile.ZipFile(tmp_path / "some.zip", "w") as opened:
            for name, content in members:
                opened.writestr(name, content)
        return tmp_path / "some.zip"

    return write


def test_there_and_back(make_session, tmp_path):
    folder = make_session("mug")
    make_session.pour(folder, spilled=2)
    make_session.report(folder)
    export_zip(folder, tmp_path / "a.zip", Reporter())
    new = import_zip(tmp_path / "a.zip", folder.parent, Reporter())
    assert new == folder.parent / "mug-2"
    before, after = summarize(folder), summarize(new)
    assert (after.name, after.omega, after.n_spilled, after.stages, after.size_bytes) == (
        before.name,
        before.omega,
        before.n_spilled,
        before.stages,
        before.size_bytes,
    )
    assert report_is_current(new)
    for path in folder.rglob("*"):
        if path.is_file() and not path.name.startswith("."):
            assert (new / path.relative_to(folder)).read_bytes() == path.read_bytes()
    assert not list(folder.parent.glob(".importing*"))


@pytest.mark.parametrize(
    "name",
    [
        "../evil.txt",
        "mug/../../evil.txt",
        "/tmp/evil.txt",
        "mug\\..\\..\\evil.txt",
        "C:/evil.txt",
        "other/evil.txt",
        ".hidden/evil.txt",
    ],
)
def test_paths_out_of_the_folder_are_refused(archive, tmp_path, name):
    root = tmp_path / "a" / "b" / "root"
    path = archive(("mug/session.json", HEADER), (name, "evil"))
    with pytest.raises(InputError):
        import_zip(path, root, Reporter())
    assert not list(tmp_path.rglob("evil.txt"))
    assert not root.exists() or list(root.iterdir()) == []


def test_links_are_refused(archive, tmp_path):
    link = zipfile.ZipInfo("mug/link")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with pytest.raises(InputError, match="mug/link"):
        import_zip(
            archive(("mug/session.json", HEADER), (link, "/etc/passwd")), tmp_path / "root", Reporter()
        )


@pytest.mark.parametrize(
    "members",
    [
        [],
        [("notes.txt", "x")],
        [("session.json", HEADER)],
        [("mug/deeper/session.json", HEADER)],
        [(".mug/session.json", HEADER)],
        [("mug/session.json", "nonsense")],
        [("mug/session.json", '{"format": 99, "name": "a", "created": "b"}')],
    ],
)
def test_what_is_no_session_is_refused_and_leaves_nothing(archive, tmp_path, members):
    root = tmp_path / "root"
    with pytest.raises(PoursightError) as refused:
        import_zip(archive(*members), root, Reporter())
    assert str(refused.value).rstrip().endswith(".")
    assert not root.exists() or list(root.iterdir()) == []


def test_damaged_files_are_refused(make_session, tmp_path):
    folder = make_session("mug")
    export_zip(folder, tmp_path / "whole.zip", Reporter())
    whole = (tmp_path / "whole.zip").read_bytes()
    flipped = bytearray(whole)
    for at in range(200, len(whole) // 2, 97):
        flipped[at] ^= 0xFF
    for content in (b"", b"no zip", whole[: len(whole) // 2], bytes(flipped)):
        (tmp_path / "bad.zip").write_bytes(content)
        with pytest.raises(PoursightError):
            import_zip(tmp_path / "bad.zip", tmp_path / "root", Reporter())
    with pytest.raises(InputError):
        import_zip(tmp_path / "missing.zip", tmp_path / "root", Reporter())
    assert not (tmp_path / "root").exists() or list((tmp_path / "root").iterdir()) == []


def refused(path, tmp_path):
    """Import it; return the sentence. Nothing is left behind."""
    with pytest.raises(InputError) as error:
        import_zip(path, tmp_path / "root", Reporter())
    assert not (tmp_path / "root").exists() or list((tmp_path / "root").iterdir()) == []
    said = str(error.value)
    assert len(said) <= 300 and said.endswith(".") and "\n" not in said
    return said


@pytest.mark.parametrize("kind", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2, zipfile.ZIP_DEFLATED], ids=str)
def test_damaged_compression_is_refused(tmp_path, kind):
    noise = bytes(random.Random(kind).randrange(256) for _ in range(4000))
    path = tmp_path / "bad.zip"
    with zipfile.ZipFile(path, "w", kind) as opened:
        opened.writestr("mug/session.json", HEADER)
        opened.writestr("mug/noise.bin", noise)
    content = path.read_bytes()
    assert import_zip(path, tmp_path / "whole", Reporter()).is_dir()
    begin = content.index(b"mug/noise.bin") + len("mug/noise.bin")
    for at in range(begin, begin + 20):  # properties, header and the beginning of the stream
        damaged = bytearray(content)
        damaged[at : at + 8] = bytes(sign ^ 0xFF for sign in content[at : at + 8])
        path.write_bytes(damaged)
        said = refused(path, tmp_path)
        assert "can be read" in said or "cannot be unpacked" in said


@pytest.mark.parametrize("n_bytes", [20_000_000, 2_000_000])
def test_what_unpacks_to_far_more_than_its_size_is_refused(tmp_path, monkeypatch, n_bytes):
    """Up to a fixed size anything may unpack; beyond that it is the ratio that counts."""
    path = tmp_path / "bomb.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as opened:
        opened.writestr("mug/session.json", HEADER)
        opened.writestr("mug/large.bin", bytes(n_bytes))
    assert n_bytes > 100 * path.stat().st_size
    if n_bytes < 10_000_000:
        assert import_zip(path, tmp_path / "root", Reporter()).name == "mug"
    else:
        monkeypatch.setattr("zipfile.ZipFile.extract", None)  # it is known before anything is unpacked
        assert "would unpack to 20 MB, which no session of its size does" in refused(path, tmp_path)


def test_more_than_the_disk_holds_is_refused_before_it_is_unpacked(archive, tmp_path, monkeypatch):
    path = archive(("mug/session.json", HEADER), ("mug/large.bin", b"0" * 10_000))
    monkeypatch.setattr("shutil.disk_usage", lambda _: Usage)
    with pytest.raises(InputError, match="free some space"):
        import_zip(path, tmp_path / "root", Reporter())


class Usage:
    free = 5_000
