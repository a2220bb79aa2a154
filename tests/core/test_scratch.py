"""Temporary folders: gone when they are closed, and, after a kill, when the next program needs one."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from core.scratch import ScratchFolder, remove_left

HOLD = """
import sys
from core.scratch import ScratchFolder
folder = ScratchFolder()
(folder.path / "body.obj").write_text("v 0 0 0")
print(folder.path, flush=True)
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def temporary(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    return tmp_path


def aged(folder):
    """As if it had been made ten seconds ago."""
    held = folder / ".held"
    os.utime(held, (held.stat().st_atime - 10, held.stat().st_mtime - 10))
    return folder


def started():
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    return process, aged(Path(process.stdout.readline().strip()))


def test_it_goes_when_it_is_closed_and_with_its_owner(temporary):
    with ScratchFolder() as folder:
        (folder / "body.obj").write_text("v 0 0 0")
    assert not folder.exists()
    unowned = ScratchFolder().path
    assert not unowned.exists()
    assert list(temporary.iterdir()) == []


def test_a_killed_program_s_folder_is_removed_by_the_next_one_and_a_living_one_s_stays(temporary):
    killed, left = started()
    living, kept = started()
    try:
        killed.kill()
        killed.communicate()
        assert (left / "body.obj").is_file()
        with ScratchFolder():
            assert not left.exists()
            assert (kept / "body.obj").is_file()
    finally:
        living.communicate("")
    assert list(temporary.iterdir()) == []


def test_one_that_is_just_being_made_and_those_of_others_stay(temporary):
    new, foreign, linked = (temporary / f"poursight-{name}" for name in ("new", "foreign", "linked"))
    new.mkdir()
    (new / ".held").touch()
    foreign.mkdir()
    (foreign / "file").touch()
    linked.symlink_to(foreign)
    remove_left()
    assert {path.name for path in temporary.iterdir()} == {new.name, foreign.name, linked.name}
    aged(new)
    remove_left()
    assert not new.exists()
