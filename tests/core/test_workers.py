import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress

import psutil
import pytest

from core.errors import Cancelled, InputError, WorkerError
from core.progress import Reporter
from core.workers import Task, WorkerPool, report_fraction
from tests.awake import within
from tests.patience import wait_until


def square(x):
    time.sleep(0.02 * (3 - x % 3))  # so that results come in another order than they were asked for
    return x * x


def process_number():
    time.sleep(0.05)
    return os.getpid()


def sleep_reporting(seconds):
    for k in range(int(seconds * 50)):
        report_fraction(k / (seconds * 50))
        time.sleep(0.02)


def sleep_deaf(seconds):
    time.sleep(seconds)


def sleep_with(seconds, data):
    time.sleep(seconds)


def kill_myself():
    os.kill(os.getpid(), signal.SIGKILL)


def refuse():
    raise InputError("No.")


class Watching(Reporter):
    def __init__(self):
        super().__init__()
        self.fractions = []

    def progress(self, stage, done, total):
        self.fractions.append(done / total)


@pytest.fixture
def pool():
    with WorkerPool(2) as workers:
        yield workers


def test_results_come_in_the_order_of_the_tasks(pool):
    assert pool.run([Task(square, (x,)) for x in range(12)], "squares", Reporter()) == [
        x * x for x in range(12)
    ]


def test_progress_grows_to_one_and_moves_within_a_task(pool):
    watching = Watching()
    pool.run([Task(sleep_reporting, (1.0,))], "sleep", watching)
    assert watching.fractions == sorted(watching.fractions)
    assert watching.fractions[-1] == 1
    assert sum(0.2 < fraction < 0.8 for fraction in watching.fractions) > 3


def test_a_tasks_own_error_reaches_the_caller_and_the_pool_goes_on(pool):
    with pytest.raises(InputError, match="No"):
        pool.run([Task(refuse, ())], "refuse", Reporter())
    assert pool.run([Task(square, (3,))], "squares", Reporter()) == [9]


def test_a_killed_worker_is_a_sentence_and_the_pool_goes_on(pool):
    with pytest.raises(WorkerError, match="worker process died during 'kill'"):
        pool.run([Task(square, (1,)), Task(kill_myself, ())], "kill", Reporter())
    assert pool.run([Task(square, (3,))], "squares", Reporter()) == [9]


@pytest.mark.parametrize("task", [Task(sleep_reporting, (30.0,)), Task(sleep_deaf, (30.0,))])
def test_cancelling_takes_less_than_two_seconds_even_when_a_task_does_not_listen(pool, task):
    pool.run([Task(square, (1,))], "start", Reporter())
    reporter = Reporter()
    threading.Timer(0.3, reporter.cancel).start()
    with within(2), pytest.raises(Cancelled):
        pool.run([task] * 3, "sleep", reporter)
    assert pool.run([Task(square, (3,))], "squares", Reporter()) == [9]


def test_closing_ends_the_processes():
    with WorkerPool(2) as workers:
        numbers = set(workers.run([Task(process_number, ()) for _ in range(6)], "numbers", Reporter()))
    wait_until(lambda: not any(psutil.pid_exists(number) for number in numbers))


@pytest.mark.parametrize("seconds", [0.0, 60.0], ids=["idle", "busy"])
def test_no_thread_of_the_executor_is_left_when_it_is_closed(seconds):
    """One that is still closing its pipes when Python ends writes a traceback to the terminal."""
    before = set(threading.enumerate())
    reporter = Reporter()
    with WorkerPool(2) as workers:
        if seconds:
            threading.Timer(1.5, reporter.cancel).start()
            with pytest.raises(Cancelled):
                workers.run([Task(sleep_deaf, (seconds,)) for _ in range(8)], "sleep", reporter)
        else:
            workers.run([Task(process_number, ())], "numbers", reporter)
    assert not [t.name for t in set(threading.enumerate()) - before if not isinstance(t, threading.Timer)]


STOPPED_BY_A_SIGNAL = """
import signal, time
from core.errors import Cancelled
from core.progress import Reporter
from core.workers import Task, WorkerPool
from tests.core.test_workers import sleep_with

if __name__ == "__main__":
    reporter = Reporter()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: reporter.cancel())
    with WorkerPool(2) as pool:
        pool.run([Task(time.sleep, (0.0,))], "start", reporter)
        print("ready", flush=True)
        try:
            pool.run([Task(sleep_with, (60.0, bytes(3_000_000))) for _ in range(40)], "sleep", reporter)
        except Cancelled:
            print("cancelled", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
def test_a_signal_to_all_processes_is_the_parents_to_obey(tmp_path, number):
    """Ctrl-C in a terminal, or `timeout` and service managers: with much handed out, Python still ends."""
    script = tmp_path / "parent.py"
    script.write_text(STOPPED_BY_A_SIGNAL)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment,
        text=True,
        start_new_session=True,
    ) as parent:
        try:
            assert parent.stdout.readline() == "ready\n"
            time.sleep(0.5)
            os.killpg(parent.pid, number)
            said, complained = parent.communicate(timeout=20)
        finally:
            with suppress(ProcessLookupError):
                os.killpg(parent.pid, signal.SIGKILL)
    assert (said, complained, parent.returncode) == ("cancelled\n", "", 0)


def test_workers_die_with_a_parent_that_is_killed(tmp_path):
    script = (
        "import sys, time\n"
        "from core.progress import Reporter\n"
        "from core.workers import Task, WorkerPool\n"
        "import os\n"
        "if __name__ == '__main__':\n"
        "    pool = WorkerPool(1)\n"
        "    print(*pool.run([Task(os.getpid, ())], 'x', Reporter()), flush=True)\n"
        "    time.sleep(60)\n"
    )
    (tmp_path / "parent.py").write_text(script)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        [sys.executable, str(tmp_path / "parent.py")], stdout=subprocess.PIPE, env=environment
    ) as parent:
        worker = int(parent.stdout.readline())
        parent.kill()
    wait_until(lambda: not psutil.pid_exists(worker))


def print_from_c():
    import ctypes

    ctypes.CDLL(None).puts(b"noise")
    ctypes.CDLL(None).fflush(None)


def test_what_workers_print_does_not_reach_stdout(capfd):
    with WorkerPool(1) as workers:
        workers.run([Task(print_from_c, ())], "print", Reporter())
    assert capfd.readouterr().out == ""
