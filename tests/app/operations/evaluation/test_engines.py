"""Both engines finish every task but those that kill their worker again and again."""

import multiprocessing
import os
import signal
import threading
import time
from contextlib import suppress

import psutil
import pytest
from distributed import Client, LocalCluster

from app.operations.evaluation import dask_engine
from app.operations.evaluation.dask_engine import DaskEngine
from app.operations.evaluation.engine import MAX_DEATHS, LocalEngine
from core.errors import Cancelled, InputError, Remedy, WorkerError
from core.progress import Reporter
from tests.app.operations.evaluation.conftest import running_cluster
from tests.app.operations.evaluation.fakes import done, fake_task, fake_trial, pids
from tests.patience import wait_until

pytestmark = pytest.mark.system

NAMES = ("a", "b", "c", "d", "e")


@pytest.fixture(params=["local", "dask"])
def engine(request):
    """Each engine with two workers."""
    if request.param == "local":
        return LocalEngine(2, fake_trial)
    return DaskEngine(request.getfixturevalue("cluster_address"), fake_trial)


def finished(engine, tasks):
    """Run all and return the results by name, after checking that each place comes once."""
    found = list(engine.run(iter(tasks), Reporter()))
    assert sorted(index for index, _ in found) == list(range(len(tasks)))
    assert all(result.trials[0].name == tasks[index].name for index, result in found)
    return {tasks[index].name: result for index, result in found}


def test_every_task_is_finished_once(engine, tmp_path):
    results = finished(engine, [fake_task(tmp_path, name) for name in NAMES])
    assert [trial.variant for trial in results["c"].trials] == ["imagination", "fixed-theta"]
    assert results["c"].pictures["c.0.imagination.png"] == b"picture of c.0.imagination.png"
    assert done(tmp_path / "log.txt") == dict.fromkeys(NAMES, 1)
    assert engine.workers == 2


def test_what_kills_and_what_raises_is_a_row(engine, tmp_path):
    requests = {"b": {"deaths": 1}, "c": {"deaths": 99}, "d": {"raises": True}}
    results = finished(engine, [fake_task(tmp_path, name, **requests.get(name, {})) for name in NAMES])
    problems = {name: result.trials[0].problem for name, result in results.items()}
    assert [problems[name] for name in "abe"] == [""] * 3
    assert problems["c"].startswith(f"{MAX_DEATHS} worker processes died of this object")
    assert problems["d"] == "A fault of the program ended this (ValueError: as requested)."
    assert len(results["c"].trials) == 2, "a row for each variant"
    counts = done(tmp_path / "log.txt")
    # Dask blames whatever a dying worker holds, so there a suspect is tried once more, alone.
    n_deaths = counts.pop("c")
    assert MAX_DEATHS <= n_deaths <= 2 * MAX_DEATHS
    check_done(engine, counts, {"a": 1, "b": 2, "d": 1, "e": 1}, n_deaths + 1)


def test_a_worker_killed_from_outside_costs_only_time(engine, tmp_path):
    log = tmp_path / "log.txt"
    killer = threading.Thread(target=kill_whoever_does, args=("c", log))
    killer.start()
    results = finished(engine, [fake_task(tmp_path, name, sleep_s=0.4) for name in NAMES])
    killer.join()
    assert not any(trial.problem for result in results.values() for trial in result.trials)
    check_done(engine, done(log), {"a": 1, "b": 1, "c": 2, "d": 1, "e": 1}, n_deaths=1)


def check_done(engine, counts, expected, n_deaths):
    """Check how often each was begun: Dask makes anew what dies with its worker before it is fetched."""
    lost = n_deaths if isinstance(engine, DaskEngine) else 0
    assert counts.keys() == expected.keys()
    assert all(times <= counts[name] <= times + lost for name, times in expected.items()), counts


def kill_whoever_does(name, log):
    while not log.exists() or name not in pids(log):
        time.sleep(0.01)
    os.kill(pids(log)[name], signal.SIGKILL)


def test_cancelling_ends_the_work(engine, tmp_path):
    before = set(multiprocessing.active_children())
    reporter = Reporter()
    running = engine.run((fake_task(tmp_path, name, sleep_s=0.3) for name in NAMES), reporter)
    next(running)
    reporter.cancel()
    with pytest.raises(Cancelled):
        list(running)
    assert sum(done(tmp_path / "log.txt").values()) < len(NAMES)
    assert not [child for child in set(multiprocessing.active_children()) - before if child.is_alive()]


def test_tasks_are_taken_only_when_there_is_a_worker_for_them(engine, tmp_path):
    taken = []

    def tasks():
        for name in NAMES:
            taken.append(name)
            yield fake_task(tmp_path, name, sleep_s=0.2)

    running = engine.run(tasks(), Reporter())
    next(running)
    assert len(taken) <= 4, "a mesh may be large: two at work, one more done, one in hand"
    running.close()


def test_workers_use_one_thread_and_the_parent_keeps_its_own(tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    engine = LocalEngine(1, threads_of_worker)
    ((_, result),) = engine.run([fake_task(tmp_path, "a")], Reporter())
    assert result == "1 1"
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert "OPENBLAS_NUM_THREADS" not in os.environ


def threads_of_worker(task):
    return f"{os.environ['OMP_NUM_THREADS']} {os.environ['OPENBLAS_NUM_THREADS']}"


@pytest.mark.parametrize("address", ["nonsense", "tcp://127.0.0.1:9"])
def test_no_scheduler_is_a_sentence(address, tmp_path, monkeypatch):
    monkeypatch.setattr(dask_engine, "_CONNECT_S", 0.3)
    with pytest.raises(InputError, match=f"no Dask scheduler at {address} that answers") as raised:
        list(DaskEngine(address, fake_trial).run([fake_task(tmp_path, "a")], Reporter()))
    assert raised.value.remedy is Remedy.START_CLUSTER


def test_other_versions_on_the_cluster_are_refused(cluster_address, tmp_path, monkeypatch):
    versions = dask_engine._decisive_versions() | {"pybullet": "0.1"}
    monkeypatch.setattr(dask_engine, "_decisive_versions", lambda: versions)
    with pytest.raises(WorkerError, match=r"pybullet \S+ there, 0.1 here"):
        list(DaskEngine(cluster_address, fake_trial).run([fake_task(tmp_path, "a")], Reporter()))


def test_workers_with_several_threads_are_refused(tmp_path):
    with small_cluster(n_workers=1, threads_per_worker=2) as cluster:
        engine = DaskEngine(cluster.scheduler_address, fake_trial)
        with pytest.raises(WorkerError, match="--nthreads 1"):
            list(engine.run([fake_task(tmp_path, "a")], Reporter()))


def test_a_worker_may_join_later(tmp_path, monkeypatch):
    monkeypatch.setattr(dask_engine, "_WARN_AFTER_S", 0.1)
    monkeypatch.setattr(dask_engine, "_COUNT_EVERY_S", 0.1)
    with small_cluster(n_workers=0, threads_per_worker=1) as cluster:
        reporter = Joining(cluster)
        engine = DaskEngine(cluster.scheduler_address, fake_trial)
        found = list(engine.run([fake_task(tmp_path, "a"), fake_task(tmp_path, "b")], reporter))
    assert [result.trials[0].problem for _, result in found] == ["", ""]
    assert len(reporter.said) == 1
    assert "--nthreads 1" in reporter.said[0]


def registered():
    """Return what finds a scheduler's workers, to be sent there: an address may come twice, an id may not."""
    return lambda dask_scheduler: {state.server_id for state in dask_scheduler.workers.values()}


def test_workers_that_are_given_up_are_started_anew(tmp_path):
    with running_cluster(2) as (_, address):
        with Client(address) as client:
            gone = client.run_on_scheduler(registered())
            client.retire_workers(list(client.scheduler_info()["workers"]))
            wait_until(lambda: len(client.run_on_scheduler(registered()) - gone) == 2)
        assert set(finished(DaskEngine(address, fake_trial), [fake_task(tmp_path, "a")])) == {"a"}


@pytest.mark.parametrize("fault", [signal.SIGKILL, signal.SIGSTOP])
def test_a_worker_whose_start_fails_or_hangs_is_started_anew(fault, monkeypatch):
    monkeypatch.setattr(dask_engine, "_START_S", 10)
    with dask_engine.local_cluster(2, 0) as (address, _), Client(address) as client:
        old = worker_processes()
        client.retire_workers(list(client.scheduler_info()["workers"]))
        wait_until(lambda: worker_processes() - old)
        starting = min(worker_processes() - old)
        os.kill(starting, fault)
        try:
            wait_until(lambda: len(client.scheduler_info()["workers"]) == 2)
            assert starting not in client.run(os.getpid).values()
        finally:
            with suppress(ProcessLookupError):  # what is stopped does not hear that it shall end
                os.kill(starting, signal.SIGKILL)


def worker_processes():
    """Return the ids of this process's Dask workers, those included that are only starting."""
    found = set()
    for process in psutil.Process().children(recursive=True):
        with suppress(psutil.Error):
            if "spawn_main" in " ".join(process.cmdline()):
                found.add(process.pid)
    return found


def test_a_scheduler_that_goes_is_a_sentence_and_takes_its_workers_along(tmp_path):
    with running_cluster(1) as (process, address):
        workers = psutil.Process(process.pid).children(recursive=True)
        running = DaskEngine(address, fake_trial).run(
            (fake_task(tmp_path, name, sleep_s=0.3) for name in NAMES), Reporter()
        )
        next(running)
        process.kill()
        with pytest.raises(WorkerError, match="has gone; start it again"):
            list(running)
    _, alive = psutil.wait_procs(workers, timeout=5)
    assert alive == []


class Joining(Reporter):
    """Starts a worker when it hears that there is none."""

    def __init__(self, cluster):
        super().__init__()
        self._cluster = cluster
        self.said = []

    def warn(self, sentence):
        self.said.append(sentence)
        self._cluster.scale(1)


def small_cluster(**size):
    """A cluster within this process."""
    return LocalCluster(processes=False, dashboard_address="127.0.0.1:0", silence_logs=50, **size)
