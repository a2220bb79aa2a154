"""A session survives kill -9 at every moment of writing, and two programs never write one session."""

import subprocess
import sys
from pathlib import Path

import pytest

from core.errors import SessionError
from core.session import Session
from tests.awake import within

ROOT = Path(__file__).resolve().parents[3]

WRITE = """
import os, signal, sys
from pathlib import Path
from core.session import Session, swapping

def killing(function, count=[int(sys.argv[2])]):
    def step(*arguments, **keywords):
        count[0] -= 1
        if count[0] < 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*arguments, **keywords)
    return step

with Session.open(Path(sys.argv[1])) as session:
    os.rmdir, os.unlink, Path.rename, os.fsync = map(killing, (os.rmdir, os.unlink, Path.rename, os.fsync))
    with session.writing("scan", inputs={}, parameters={"seed": 2}) as folder:
        for name in "abc":
            killing(lambda: None)()
            (folder / name).write_text("new")
"""

HOLD = """
import sys, time
from pathlib import Path
from core.session import Session
with Session.open(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def run(code: str, *arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-c", code, *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )


@pytest.fixture
def session(tmp_path: Path) -> Session:
    session = Session.create_or_open(tmp_path / "mug")
    with session, session.writing("scan", inputs={}, parameters={"seed": 1}) as folder:
        for name in "abc":
            (folder / name).write_text("old")
    return session


def whole_stage(session: Session) -> str:
    """Return 'old' or 'new' after checking that the stage is wholly that and nothing else lies about."""
    with session:
        texts = {(session.folder("scan") / name).read_text() for name in "abc"}
        (text,) = texts
        assert session.is_fresh("scan", {}, {"seed": {"old": 1, "new": 2}[text]})
        names = {path.name for path in session.path.iterdir()}
    assert names == {"session.json", "scan", ".lock", ".writer"}
    return text


def test_killed_at_every_step_leaves_the_old_or_the_new_stage(session: Session) -> None:
    # Every removal, rename and flush is a step: three while writing, then those of the commit.
    found = []
    for steps in range(3, 20):
        process = run(WRITE, str(session.path), str(steps))
        killed = process.wait(timeout=30) != 0
        found.append(whole_stage(session))
        if not killed:
            break
        with session, session.writing("scan", inputs={}, parameters={"seed": 1}) as folder:
            for name in "abc":
                (folder / name).write_text("old")
    assert not killed
    # Once the new stage counts it counts for good.
    assert found == sorted(found, reverse=True) and {"old", "new"} == set(found)


def test_a_program_killed_while_writing_is_cleared_up(session: Session) -> None:
    process = run(WRITE, str(session.path), "0")
    assert process.wait(timeout=30) != 0
    assert (session.path / ".scan.writing").exists()
    assert whole_stage(session) == "old"


def test_a_second_program_is_told_who_writes_and_a_killed_one_does_not_block(session: Session) -> None:
    process = run(HOLD, str(session.path))
    try:
        assert process.stdout is not None and process.stdout.readline() == "held\n"
        with pytest.raises(SessionError, match=rf"another program \(process {process.pid}\); close it first"):
            session.__enter__()
        assert session.record("scan") is not None  # reading goes on
    finally:
        process.kill()
        process.wait()
    with within(1):
        assert whole_stage(session) == "old"


def test_one_program_cannot_open_a_session_for_writing_twice(session: Session) -> None:
    with session, pytest.raises(SessionError, match="is being written"), Session.open(session.path):
        pass
    with session:
        pass
