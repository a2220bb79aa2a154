"""`poursight scan` from the command line."""

import json
import shutil

import numpy as np
import pytest

from core.resources import RESOURCES
from tests.app.cli.commanding import command
from tests.app.sessions import copied, made_once

pytestmark = pytest.mark.system

SIMULATED = RESOURCES / "cells" / "simulated.toml"
COARSE = "--set=reconstruction.voxel_m=0.004"
QUICK = [
    COARSE,
    "--set=evidence.renders=false",
    "--set=containability.n_max=64",
    "--set=containability.n_min=40",
    "--set=containability.verdict=omega",
    "--set=risk.n_tries=4",
    "--set=pouring.n_pour=20",
    "--set=evidence.films=false",
]


def few_views(tmp_path, n=6):
    """The simulated cell with some of its views only."""
    head, _, rest = SIMULATED.read_text().partition("views_rad = [\n")
    rows, _, tail = rest.partition("\n]\n")
    kept = rows.split("\n")[:: 24 // n]
    path = tmp_path / "few.toml"
    path.write_text(f"{head}views_rad = [\n" + "\n".join(kept) + f"\n]\n{tail}")
    return path


def test_scan_reconstruct_imagine_equals_demo(poursight, tmp_path):
    one, other = tmp_path / "one", tmp_path / "other"
    assert poursight("scan", "--session", one, "--object", "bowl", *QUICK)[0] == 0
    assert poursight("reconstruct", one)[0] == 0
    code, out, err = poursight("imagine", one, "--json", "-")
    assert code == 0, err
    assert poursight("demo", "--object", "bowl", "--out", other, *QUICK)[0] == 0
    again = json.loads(poursight("imagine", other, "--json", "-")[1])
    answer = json.loads(out)
    assert answer.pop("seconds") and again.pop("seconds")
    assert answer == again
    for stage in ("scan", "reconstruction", "quality", "collision", "containability", "pouring"):
        digests = [json.loads((s / stage / "record.json").read_text())["digest"] for s in (one, other)]
        assert digests[0] == digests[1], stage


def scan_command(session, tmp_path, name="bowl"):
    return ["scan", "--session", session, "--cell", few_views(tmp_path), "--object", name, COARSE]


@pytest.fixture
def scanned(tmp_path_factory, tmp_path):
    """A bowl, scanned with few views."""

    def scan(folder):
        command(*scan_command(folder, tmp_path))

    return copied(made_once(tmp_path_factory, "scanned_with_few_views", scan), tmp_path / "session")


def test_a_finished_scan_is_not_taken_again_but_single_views_are(poursight, tmp_path):
    session = tmp_path / "session"
    words = scan_command(session, tmp_path)
    code, out, err = poursight(*words)
    assert code == 0, err
    assert "6 views" in out
    assert "scan: 100 %" in err
    assert not (session / "scan-in-progress").exists()
    assert "scan:" not in poursight(*words)[2]
    image = session / "scan/rgbd/frame-000002.color.png"
    before = image.stat().st_mtime_ns
    other = (session / "scan/rgbd/frame-000001.color.png").read_bytes()
    assert poursight(*words, "--retake", "frame-000002")[0] == 0
    assert image.stat().st_mtime_ns != before
    assert (session / "scan/rgbd/frame-000001.color.png").read_bytes() == other


def test_an_unknown_view_cannot_be_retaken(refused, scanned, tmp_path):
    unscanned = scan_command(tmp_path / "unscanned", tmp_path)
    assert "no finished scan" in refused(*unscanned, "--retake", "frame-000000")
    assert "no view 'frame-000099'" in refused(*scan_command(scanned, tmp_path), "--retake", "frame-000099")


def test_an_interrupted_scan_of_another_object_is_not_mixed_in(refused, poursight, scanned, tmp_path):
    shutil.copytree(scanned / "scan", scanned / "scan-in-progress")
    words = scan_command(scanned, tmp_path, "mug")
    assert "another scan (6, of" in refused(*words)
    assert poursight(*words, "--restart")[0] == 0


def test_what_cannot_be_scanned(refused, tmp_path):
    session = tmp_path / "session"
    assert "--object mug" in refused("scan", "--session", session)
    assert "did you mean" in refused("scan", "--session", session, "--object", "mugg")
    assert "nothing.obj" in refused("scan", "--session", session, "--object", tmp_path / "nothing.obj")
    assert "missing.toml" in refused("scan", "--session", session, "--cell", tmp_path / "missing.toml")
    real = RESOURCES / "cells" / "ur5_example.toml"
    assert "leave out --object" in refused("scan", "--session", session, "--cell", real, "--object", "mug")
    assert "192.168.0.10" in refused("scan", "--session", session, "--cell", real)


def test_a_session_with_a_mesh_takes_no_scan(refused, mesh_session, tmp_path):
    sentence = refused("scan", "--session", mesh_session, "--cell", few_views(tmp_path), "--object", "bowl")
    assert "holds a mesh" in sentence


def test_a_recorded_scan_is_replayed(poursight, refused, tmp_path, shared_data):
    text = SIMULATED.read_text().replace('kind = "simulated"', 'kind = "replay"', 2)
    tray = shared_data / "real_scan" / "amazon_tray"
    cell = tmp_path / "replay.toml"
    cell.write_text(text.replace("[camera]\n", f'[camera]\nrecording = "{tray}"\n'))
    session = tmp_path / "session"
    code, out, err = poursight("scan", "--session", session, "--cell", cell, COARSE)
    assert code == 0, err
    assert "24 views" in out
    poses = [np.loadtxt(path) for path in sorted((session / "scan/rgbd").glob("*.pose.txt"))]
    recorded = [np.loadtxt(path) for path in sorted((tray / "rgbd").glob("*.pose.txt"))]
    np.testing.assert_allclose(poses, recorded, atol=1e-6)
    assert "cannot be taken again" in refused("scan", "--session", session, "--cell", cell, "--adaptive")


def test_doctor_tries_the_cell(poursight, tmp_path):
    code, out, _ = poursight("doctor", "--cell", SIMULATED)
    assert code == 0
    assert "SIMULATED" in out
    assert "6, all reachable" in poursight("doctor", "--cell", few_views(tmp_path))[1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text.replace("home_rad = [4.57", "home_rad = [0.0"), "cannot stand there"),
        (
            lambda text: text.replace(
                "    [3.7752", "    [3.8755, -2.1402, -0.5990, -2.4150, 2.1841, -0.2587],\n    [3.7752"
            ),
            "are the same",
        ),
        (lambda text: text.replace('kind = "simulated"', 'kind = "realsense"', 1), "RealSense"),
    ],
)
def test_doctor_says_what_is_wrong_with_a_cell(poursight, tmp_path, change, said):
    cell = tmp_path / "cell.toml"
    cell.write_text(change(SIMULATED.read_text()))
    code, out, _ = poursight("doctor", "--cell", cell)
    assert code == 1
    assert said in out
