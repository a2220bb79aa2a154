"""`poursight evaluate`, `compare` and `cluster` at the command line."""

import json
import os
import signal
import subprocess
import sys

import psutil
import pytest

from app.operations.evaluation import dask_engine
from core.mesh_file import write_mesh
from hardware.simulation.objects import builtin_object
from tests.app.operations.evaluation.conftest import running_cluster
from tests.app.operations.evaluation.fakes import write_labels
from tests.awake import within
from tests.patience import HANG_S

pytestmark = pytest.mark.system

QUICK = (
    "--input=mesh",
    "--variant=imagination",
    "--pours=1",
    "--set=risk.n_tries=4",
    "--set=containability.verdict=omega",
    "--set=pouring.n_pour=20",
    "--truth=object_error_m=0.002",
)
QUICK += ("--set=pouring.theta_fixed_rad=0", "--set=containability.n_max=40", "--set=containability.n_min=20")


@pytest.fixture
def objects(tmp_path):
    """A container, something else, and a label without a mesh."""
    folder = tmp_path / "objects"
    folder.mkdir()
    for name in ("bowl", "block"):
        write_mesh(folder / f"{name}.obj", builtin_object(name))
    write_labels(folder, bowl="container", block="non-container", gone="ambiguous")
    return folder


def test_interrupted_and_continued_to_the_tables_and_a_comparison(objects, tmp_path, poursight):
    out = tmp_path / "out"
    words = ["evaluate", str(objects), "--out", str(out), "--workers", "1", *QUICK]
    process = subprocess.Popen(
        [sys.executable, "-m", "app.cli", *words],
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        start_new_session=True,
    )
    while not process.stderr.readline().startswith("evaluation: 50 %"):
        assert process.poll() is None
    with within(2):
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the whole group
        _, err = process.communicate(timeout=HANG_S)
    assert process.returncode == 1
    assert "Stopped on request" in err
    assert "Traceback" not in err
    assert not (out / "report.html").exists()

    code, said, err = poursight(*words)
    assert code == 0, err
    assert "1 trial was finished before" in err
    assert "Table I" in said
    assert "gone.obj cannot be read" in said.replace("\n    ", " ")
    assert "The ground-truth worlds did not have their usual settings: object_error_m = 0.002." in said
    assert f"Report: {out / 'report.html'}" in said
    assert (out / "report.html").is_file()
    header = (out / "objects.csv").read_text().splitlines()[0]
    assert header.startswith("id,label,omega,predicted,p_chosen,poured,spilled,seconds")
    assert json.loads((out / "summary.json").read_text())["n"] == 2

    code, said, err = poursight("compare", out, out)
    assert code == 0, err
    assert f"Report: {out / 'comparison.html'}" in said
    assert (out / "comparison.html").is_file()


def test_the_papers_text_and_code_are_rows_beside_ours_unless_others_are_asked_for(tmp_path, poursight):
    objects = tmp_path / "objects"
    objects.mkdir()
    (objects / "broken.obj").write_text("no mesh")
    write_labels(objects, broken="container")
    code, out, err = poursight("evaluate", objects, "--input=mesh", "--out", tmp_path / "out")
    assert code == 0, err
    rows = {line.split()[0] for line in out.splitlines() if line}
    assert {"imagination", "paper", "authors"} <= rows


def test_what_cannot_be_asked(objects, tmp_path, refused, poursight, monkeypatch):
    monkeypatch.setattr(dask_engine, "_CONNECT_S", 0.3)
    words = ("evaluate", objects, "--out", tmp_path / "out")
    assert "no variant 'imagine'; did you mean 'imagination'" in refused(*words, "--variant=imagine")
    assert "no Dask scheduler at tcp://127.0.0.1:9" in refused(*words, "--scheduler=tcp://127.0.0.1:9")
    assert len(refused(*words, f"--scheduler={'x' * 5000}")) < 320
    assert "holds no labels" in refused("evaluate", tmp_path, "--out", tmp_path / "out")
    assert "comparing" not in refused("compare", tmp_path / "a", tmp_path / "b")
    assert "did you mean 'object_error_m'" in refused(*words, "--truth=object_error=0.005")
    assert "allowed is 0 to 0.1 m" in refused(*words, "--truth=object_error_m=5")
    assert "use --set pouring.n_pour" in refused(*words, "--truth=n_candies=5")
    assert "use --world NAME" in refused(*words, "--truth=engine=mujoco")
    assert "no ground-truth world 'moon'" in refused(*words, "--world=moon")
    assert "lacks a value" in refused(*words, "--truth=object_error_m")
    assert poursight(*words, "--scheduler=tcp://127.0.0.1:9", "--workers=2")[0] == 2
    assert poursight(*words, "--input=photo")[0] == 2


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_cluster_leaves_no_process_behind(number):
    with running_cluster(2) as (process, address):
        assert address.startswith("tcp://127.0.0.1:")
        whole = psutil.Process(process.pid).children(recursive=True)
        assert len(whole) >= 2
        listening = [
            connection.laddr.ip
            for one in [psutil.Process(process.pid), *whole]
            for connection in one.net_connections("inet")
            if connection.status == psutil.CONN_LISTEN
        ]
        assert set(listening) == {"127.0.0.1"}
        os.kill(process.pid, number)
        assert process.wait(timeout=HANG_S) == (0 if number == signal.SIGINT else -number)
    _, alive = psutil.wait_procs(whole, timeout=5)
    assert alive == []
