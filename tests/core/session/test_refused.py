"""The disk is full or the folder may not be written: a sentence, and nothing lost."""

import errno
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from core.errors import SessionError
from core.files import write_arrays
from core.session import Session

FULL = r"The disk that holds .*mug is full: free some space; nothing that was finished is lost\."
READ_ONLY = r"The folder .*mug cannot be written \(.*\): make it writable or choose another one; nothing"


def mount(*arguments: str) -> None:
    done = subprocess.run(["mount", *arguments], capture_output=True, check=False)
    if done.returncode:
        pytest.skip("no right to mount a small disk")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """Give a disk of 512 kB."""
    if os.geteuid() != 0:
        pytest.skip("only root may mount a small disk")
    folder = tmp_path / "disk"
    folder.mkdir()
    mount("-t", "tmpfs", "-o", "size=512k", "tmpfs", str(folder))
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def filled(folder: Path) -> Session:
    session = Session.create_or_open(folder / "mug")
    with session, session.writing("scan", inputs={}, parameters={}) as stage:
        (stage / "a").write_text("old")
    return session


def test_a_full_disk_keeps_what_was_there(small_disk: Path) -> None:
    session = filled(small_disk)
    noise = np.random.default_rng(0).random(100_000)
    with session:
        for write in (
            lambda stage: (stage / "a").write_bytes(noise.tobytes()),
            lambda stage: np.save(stage / "a.npy", noise),  # fails without the system's error number
            lambda stage: write_arrays(stage / "a.npz", noise=noise),
        ):
            with (
                pytest.raises(SessionError, match=FULL),
                session.writing("scan", inputs={}, parameters={}) as stage,
            ):
                write(stage)
            assert not stage.exists()
        assert (session.folder("scan") / "a").read_text() == "old"
        assert session.is_fresh("scan", {}, {})
        with session.writing("scan", inputs={}, parameters={}) as stage:  # space is free again
            (stage / "a").write_text("new")


def test_a_session_cannot_start_on_a_full_disk(small_disk: Path) -> None:
    (small_disk / "ballast").write_bytes(bytes(512 * 1024))
    with pytest.raises(SessionError, match=FULL):
        Session.create_or_open(small_disk / "mug")


def test_a_read_only_disk_can_be_read_but_not_written(small_disk: Path) -> None:
    session = filled(small_disk)
    mount("-o", "remount,ro", str(small_disk))
    assert Session.create_or_open(session.path).is_fresh("scan", {}, {})
    with pytest.raises(SessionError, match=READ_ONLY), session:
        pass
    with pytest.raises(SessionError, match=r"cannot be written \(Read-only"):
        Session.create_or_open(small_disk / "new" / "session")


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
def test_a_full_disk_is_told_from_wherever_it_shows(tmp_path: Path, number: int) -> None:
    session = filled(tmp_path)
    with session, pytest.raises(SessionError, match=FULL), session.writing("scan", inputs={}, parameters={}):
        try:
            raise OSError(number, os.strerror(number))
        except OSError as error:
            raise RuntimeError("the film could not be written") from error
    assert session.is_fresh("scan", {}, {})


def test_a_full_disk_at_the_last_moment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    session = filled(tmp_path)

    def fail(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with session:
        monkeypatch.setattr("core.session.swapping.os.fsync", fail)
        with pytest.raises(SessionError, match=FULL), session.writing("scan", inputs={}, parameters={}):
            pass
    assert (session.folder("scan") / "a").read_text() == "old"


def test_a_folder_without_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    session = filled(tmp_path)

    def refuse(path: Path, *_: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    with session:
        monkeypatch.setattr(Path, "mkdir", refuse)
        with pytest.raises(SessionError, match=READ_ONLY), session.writing("scan", inputs={}, parameters={}):
            pass


def test_other_faults_pass_unchanged(tmp_path: Path) -> None:
    session = filled(tmp_path)
    elsewhere = PermissionError(errno.EACCES, "Permission denied", "/somewhere/else")
    for fault in (elsewhere, ValueError("wrong"), FileNotFoundError("gone")):
        with session, pytest.raises(type(fault)), session.writing("scan", inputs={}, parameters={}):
            raise fault


def test_a_swap_that_failed_half_way_is_finished_by_the_next_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = filled(tmp_path)
    rename = Path.rename

    def fail_into_place(path: Path, target: Path) -> Path:
        if Path(target).name == "scan":
            raise OSError(errno.EIO, "Input/output error")
        return rename(path, target)

    with session:
        monkeypatch.setattr(Path, "rename", fail_into_place)
        with pytest.raises(OSError), session.writing("scan", inputs={}, parameters={}):
            pass
        monkeypatch.undo()
        with session.writing("scan", inputs={}, parameters={"seed": 5}):
            pass
    assert session.is_fresh("scan", {}, {"seed": 5})
