"""Whatever people give: one clear sentence, exit code 1, nothing lost."""

import json
import os
import subprocess

import numpy as np
import pytest
from PIL import Image

from app.operations.evaluation.placed_object import place_object
from app.operations.scanning import object_mesh
from core.progress import Reporter

BOX_OBJ = """
v 0 0 0
v {x} 0 0
v {x} {x} 0
v 0 {x} 0
v 0 0 {x}
v {x} 0 {x}
v {x} {x} {x}
v 0 {x} {x}
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
"""


def box_file(path, edge_m=0.08):
    path.write_text(BOX_OBJ.format(x=edge_m))
    return path


def frame(folder, index, kind):
    return folder / "rgbd" / f"frame-{index:06d}.{kind}"


def break_nothing_there(folder):
    for path in (folder / "rgbd").iterdir():
        path.unlink()


def break_missing_pose(folder):
    frame(folder, 2, "pose.txt").unlink()


def break_no_rotation(folder):
    pose = np.loadtxt(frame(folder, 2, "pose.txt"))
    pose[:3, :3] *= 1.1
    np.savetxt(frame(folder, 2, "pose.txt"), pose)


def break_nan_pose(folder):
    pose = np.loadtxt(frame(folder, 2, "pose.txt"))
    pose[0, 3] = np.nan
    np.savetxt(frame(folder, 2, "pose.txt"), pose)


def break_truncated_png(folder):
    path = frame(folder, 2, "depth.png")
    path.write_bytes(path.read_bytes()[:-30])


def break_depth_in_metres(folder):
    depth = np.full((48, 64), 0.7, dtype=np.float32)
    Image.fromarray(depth).save(frame(folder, 2, "depth.png"), format="TIFF")


def break_two_sizes(folder):
    Image.fromarray(np.full((24, 32), 700, dtype=np.uint16)).save(frame(folder, 2, "depth.png"))
    Image.fromarray(np.zeros((24, 32, 3), dtype=np.uint8)).save(frame(folder, 2, "color.png"))


@pytest.mark.parametrize(
    ("damage", "named"),
    [
        (break_nothing_there, "scan"),
        (break_missing_pose, "frame-000002.pose.txt"),
        (break_no_rotation, "frame-000002.pose.txt"),
        (break_nan_pose, "frame-000002.pose.txt"),
        (break_truncated_png, "frame-000002.depth.png"),
        (break_depth_in_metres, "frame-000002.depth.png"),
        (break_two_sizes, "frame-000002"),
    ],
)
def test_a_damaged_scan_is_refused_and_the_old_one_kept(
    damage, named, scan_folder, tmp_path, poursight, refused
):
    session = tmp_path / "session"
    code, _, err = poursight("import", scan_folder, "--session", session)
    assert code == 0, err
    before = (session / "scan" / "record.json").read_bytes()
    damage(scan_folder)
    assert named in refused("import", scan_folder, "--session", session)
    assert (session / "scan" / "record.json").read_bytes() == before


def mesh_millimetres(path):
    return box_file(path, 80.0)


def mesh_empty(path):
    path.write_text("")
    return path


def mesh_points_only(path):
    path.write_text("v 0 0 0\nv 1 0 0\n")
    return path


def mesh_inside_out(path):
    lines = BOX_OBJ.format(x=0.08).splitlines()
    turned = [f"f {b} {a} {c}" for a, b, c in (line.split()[1:] for line in lines if line.startswith("f"))]
    path.write_text("\n".join([line for line in lines if line.startswith("v")] + turned))
    return path


def mesh_nowhere(path):
    return path.with_name("nowhere.obj")


@pytest.mark.parametrize(
    "make", [mesh_millimetres, mesh_empty, mesh_points_only, mesh_inside_out, mesh_nowhere]
)
def test_a_bad_mesh_is_refused(make, tmp_path, refused):
    path = make(tmp_path / "object.obj")
    assert path.name in refused("imagine", path)


def test_a_mesh_of_five_million_faces_is_refused_at_once(tmp_path, refused):
    path = tmp_path / "huge.stl"
    with path.open("wb") as file:
        file.write(bytes(80) + (5_000_000).to_bytes(4, "little"))
        file.truncate(84 + 50 * 5_000_000)
    assert "5,000,000 faces" in refused("imagine", path)


@pytest.mark.system
def test_a_non_manifold_mesh_is_scanned_and_judged_with_a_warning(tmp_path, poursight):
    path = box_file(tmp_path / "fin.obj")
    path.write_text(path.read_text() + "v 0.04 0.04 0.12\nf 5 7 9\n")
    code, out, err = poursight("imagine", path, "--session", tmp_path / "judged")
    assert (code, "ot an open container" in out) == (0, True), err
    assert "1 non-manifold edges" in err and "taken as a surface" in err
    assert len(place_object(object_mesh(str(path), Reporter()), "scan", 0).true.faces) == 13


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["particle.diameter_m=0.05", "particle.shape=sphere"], "smaller than a candy"),
        (["pouring.n_pour=1000", "containability.verdict=omega"], "cannot hold 1000 candies"),
        (["pouring.npour=10"], "did you mean 'pouring.n_pour'"),
        (["pouring.n_pour=0"], "allowed is 1 to 1000"),
        (["pouring.n_pour"], "lacks a value"),
    ],
)
def test_settings_that_cannot_be_met(settings, said, tmp_path, refused):
    path = box_file(tmp_path / "box.obj", 0.04)
    words = [word for setting in settings for word in ("--set", setting)]
    assert said in refused("imagine", path, *words)


@pytest.mark.parametrize("command", ["imagine", "reconstruct", "report"])
def test_a_folder_that_may_not_be_read_is_one_sentence(command, tmp_path, monkeypatch, poursight):
    monkeypatch.setattr("app.cli.options.os.access", lambda path, mode: False)
    code, out, err = poursight(command, tmp_path)
    assert (code, out) == (1, "")
    assert err.strip().endswith("cannot be read (Permission denied); make it readable.")
    assert err.count("\n") == 1


def test_an_unknown_preset_object_or_session(tmp_path, refused):
    assert "did you mean 'authors'" in refused("imagine", tmp_path / "x.obj", "--preset", "author")
    assert "did you mean 'mug'" in refused("demo", "--object", "mugg", "--out", tmp_path / "demo")
    assert not (tmp_path / "demo").exists()
    assert "There is no session" in refused("reconstruct", tmp_path / "nothing")
    (tmp_path / "empty").mkdir()
    assert "is no session" in refused("imagine", tmp_path / "empty")


def test_a_session_without_a_scan(tmp_path, poursight, refused):
    session = tmp_path / "session"
    assert poursight("imagine", box_file(tmp_path / "box.obj", 0.004), "--session", session)[0] == 1
    assert "holds no 'scan' yet" in refused("reconstruct", session)


def test_a_session_of_a_newer_version_is_left_alone(scan_folder, tmp_path, poursight, refused):
    session = tmp_path / "session"
    poursight("import", scan_folder, "--session", session)
    header = json.loads((session / "session.json").read_text())
    (session / "session.json").write_text(json.dumps(header | {"format": 99}))
    before = sorted(path.name for path in session.rglob("*"))
    assert "newer Poursight" in refused("reconstruct", session)
    assert sorted(path.name for path in session.rglob("*")) == before


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 300 kB."""
    if os.geteuid() != 0:
        pytest.skip("mounting a small disk needs root")
    folder = tmp_path / "disk"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", folder], check=False).returncode:
        pytest.skip("no small disk can be mounted here")
    yield folder
    subprocess.run(["umount", "-l", folder], check=True)


def test_a_full_disk(small_disk, tmp_path, refused):
    folder = tmp_path / "big"
    (folder / "rgbd").mkdir(parents=True)
    (folder / "camera-intrinsics.txt").write_text("50 0 160\n0 50 120\n0 0 1\n")
    generator = np.random.default_rng(0)
    for index in range(4):
        pose = np.eye(4)
        pose[2, 3] = 0.1 * index
        np.savetxt(folder / "rgbd" / f"frame-{index:06d}.pose.txt", pose)
        noise = generator.integers(0, 255, (240, 320, 3), dtype=np.uint8)
        Image.fromarray(noise).save(folder / "rgbd" / f"frame-{index:06d}.color.png")
        depth = generator.integers(500, 900, (240, 320), dtype=np.uint16)
        Image.fromarray(depth).save(folder / "rgbd" / f"frame-{index:06d}.depth.png")
    assert "full" in refused("import", folder, "--session", small_disk / "session")


def test_a_read_only_folder(small_disk, scan_folder, refused):
    subprocess.run(["mount", "-o", "remount,ro", small_disk], check=True)
    said = refused("import", scan_folder, "--session", small_disk / "session")
    assert "session" in said


@pytest.mark.system
def test_an_answer_that_cannot_be_written(tmp_path, refused):
    path = box_file(tmp_path / "box.obj", 0.06)
    said = refused("imagine", path, "--set", "containability.n_max=64", "--json", tmp_path / "no" / "a.json")
    assert "a.json" in said


def test_wrong_words_are_exit_code_2(poursight):
    assert poursight("imagine")[0] == 2
    assert poursight("fly")[0] == 2
    assert poursight("demo", "--workers", "none")[0] == 2
