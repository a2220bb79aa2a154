"""Child processes end when they should, whatever happens, and never outlive their use."""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import subprocess
import sys
import time
from multiprocessing.connection import Connection, wait

import psutil
import pytest

from core.child_process import STDERR, STDOUT, ChildProcess

LIMIT_S = 10.0


def echo(connection: Connection) -> None:
    """Answer everything, end when asked by end-of-file or by `None`."""
    while (message := connection.recv()) is not None:
        connection.send(message)


def sleep(connection: Connection, seconds: float) -> None:
    connection.send(os.getpid())
    time.sleep(seconds)


def print_from_c(connection: Connection) -> None:
    ctypes.CDLL(None).puts(b"noise")
    ctypes.CDLL(None).fflush(None)
    os.write(STDERR, b"noise")
    connection.send(None)


def look_around(connection: Connection) -> None:
    connection.send((os.environ.get("FROM_PARENT"), sys.stdin.read()))


def hold_the_interpreter(connection: Connection, seconds: int) -> None:
    connection.send(os.getpid())
    ctypes.PyDLL(None).sleep(seconds)


def have_a_busy_child(connection: Connection) -> None:
    own = ChildProcess(hold_the_interpreter, 60, name="grandchild")
    connection.send(own.connection.recv())
    connection.recv()


def have_a_child(connection: Connection) -> None:
    own = ChildProcess(sleep, 60.0, name="grandchild")
    connection.send(own.connection.recv())
    connection.recv()


def is_gone(pid: int) -> bool:
    deadline_s = time.monotonic() + LIMIT_S
    while psutil.pid_exists(pid):
        if time.monotonic() > deadline_s:
            return False
        time.sleep(0.02)
    return True


def test_it_answers_and_ends_when_asked() -> None:
    child = ChildProcess(echo, name="echo")
    child.connection.send({"depth_m": 0.4})
    assert child.connection.recv() == {"depth_m": 0.4}
    assert child.exit_code is None
    child.connection.send(None)
    child.end(LIMIT_S)
    assert child.exit_code == 0
    assert wait([child.sentinel], 0)
    with pytest.raises(EOFError):
        child.connection.recv()
    child.end()


def test_one_that_does_not_end_is_killed() -> None:
    child = ChildProcess(sleep, 60.0, name="sleeper")
    assert child.connection.recv() == child.pid
    began_s = time.monotonic()
    child.end(0.2)
    assert child.exit_code == -signal.SIGKILL and time.monotonic() - began_s < LIMIT_S


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("when_s", [0.0, 0.05, 0.5])
def test_signals_meant_for_the_parent_do_not_end_it(number: signal.Signals, when_s: float) -> None:
    child = ChildProcess(echo, name="echo")
    time.sleep(when_s)
    os.kill(child.pid, number)
    child.connection.send("there?")
    assert child.connection.recv() == "there?"
    child.end()


def test_a_forgotten_one_is_killed() -> None:
    pid = ChildProcess(sleep, 60.0, name="sleeper").pid
    gc.collect()
    assert is_gone(pid)


PARENT = """
import os, time
from core.child_process import ChildProcess
from tests.core.test_child_process import have_a_child

if __name__ == "__main__":
    child = ChildProcess(have_a_child, name="child")
    print(child.pid, child.connection.recv(), flush=True)
    {then}
"""


@pytest.mark.parametrize("then", ["time.sleep(60)", "pass", "raise SystemExit(1)", "os._exit(0)"])
def test_children_and_theirs_end_with_the_parent_however_it_ends(tmp_path, then: str) -> None:
    script = tmp_path / "parent.py"
    script.write_text(PARENT.format(then=then))
    with subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    ) as parent:
        assert parent.stdout is not None
        family = [int(word) for word in parent.stdout.readline().split()]
        assert len(family) == 2
        if "sleep" in then:
            parent.kill()
        parent.wait(LIMIT_S)
    assert all(is_gone(pid) for pid in family)


def test_one_in_a_library_that_holds_the_interpreter_ends_with_a_killed_parent() -> None:
    child = ChildProcess(have_a_busy_child, name="parent")
    grandchild = child.connection.recv()
    time.sleep(1.0)  # so that it is in the library, most likely; elsewhere it ends, too
    assert psutil.pid_exists(grandchild)
    child.kill()
    assert is_gone(grandchild)


def test_only_what_is_silenced_is_dropped(capfd) -> None:
    for silenced in ((STDOUT, STDERR), (STDOUT,)):
        child = ChildProcess(print_from_c, name="printer", silenced=silenced)
        child.connection.recv()
        child.end(LIMIT_S)
    assert capfd.readouterr() == ("", "noise")


def test_its_environment_is_its_own_and_its_input_empty() -> None:
    child = ChildProcess(look_around, name="looker", environment={"FROM_PARENT": "1"})
    assert child.connection.recv() == ("1", "")
    assert "FROM_PARENT" not in os.environ
    child.end(LIMIT_S)
