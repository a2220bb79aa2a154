import sys

import numpy as np
import pytest
from PIL import Image

from app import cli
from core.geometry import look_at


@pytest.fixture
def poursight(monkeypatch, capfd):
    """Run the command line in this process: returns (exit code, stdout, stderr)."""

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["poursight", *map(str, words)])
        try:
            cli.main()
            code = 0
        except SystemExit as leaving:
            code = int(leaving.code or 0)
        out, err = capfd.readouterr()
        return code, out, err

    return run


@pytest.fixture
def refused(poursight):
    """Run the command line and return the one sentence it ends with."""

    def run(*words):
        code, _, err = poursight(*words)
        assert code == 1, err
        assert "Traceback" not in err
        sentences = [line for line in err.splitlines() if line.startswith("poursight: ")]
        assert len(sentences) == 1, err
        assert sentences[0].endswith((".", "?")), sentences[0]
        return sentences[0]

    return run


@pytest.fixture
def scan_folder(tmp_path):
    """A small scan in the authors' layout: four views of nothing but a far table."""
    folder = tmp_path / "scan"
    rgbd = folder / "rgbd"
    rgbd.mkdir(parents=True)
    (folder / "camera-intrinsics.txt").write_text("50 0 32\n0 50 24\n0 0 1\n")
    for index in range(4):
        eye = np.array([0.3 * np.cos(index) - 0.06, 0.3 * np.sin(index) - 0.35, 0.6])
        depth = np.full((48, 64), 700 + index, dtype=np.uint16)
        Image.fromarray(np.zeros((48, 64, 3), dtype=np.uint8)).save(rgbd / f"frame-{index:06d}.color.png")
        Image.fromarray(depth).save(rgbd / f"frame-{index:06d}.depth.png")
        np.savetxt(rgbd / f"frame-{index:06d}.pose.txt", look_at(eye, [-0.06, -0.35, 0.05]))
    return folder


@pytest.fixture(scope="session")
def made_sessions(tmp_path_factory):
    """A container (mug) and something that is none (block), each made when first asked for."""
    from tests.app.sessions import made_once, make_session

    def make(name):
        return made_once(tmp_path_factory, name, lambda folder: make_session(folder, name))

    return make


@pytest.fixture
def mug_session(made_sessions, tmp_path):
    """A session with a scanned, reconstructed and imagined mug."""
    from tests.app.sessions import copied

    return copied(made_sessions("mug"), tmp_path / "mug")


@pytest.fixture
def block_session(made_sessions, tmp_path):
    """The same with a block, which is no container."""
    from tests.app.sessions import copied

    return copied(made_sessions("block"), tmp_path / "block")
