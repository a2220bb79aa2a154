"""That every camera is a `Camera` is for the type checker to say; it does not look at tests by itself."""

from __future__ import annotations

from pathlib import Path

import mypy.api
import pytest

ROOT = Path(__file__).resolve().parents[3]
CAMERAS = """
from hardware.cameras.openni import OpenNICamera
from hardware.cameras.realsense import RealSenseCamera
from hardware.cameras.replay import ReplayCamera
from hardware.interfaces import Camera

kinds: list[type[Camera]] = [OpenNICamera, RealSenseCamera, ReplayCamera]
"""


@pytest.mark.parametrize(("more", "errors"), [("", 0), ("\nkinds.append(Path)", 1)], ids=["cameras", "other"])
def test_the_cameras_conform(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, more: str, errors: int) -> None:
    monkeypatch.chdir(ROOT)
    (tmp_path / "cameras.py").write_text(f"from pathlib import Path\n{CAMERAS}{more}")
    report, problem, status = mypy.api.run([str(tmp_path / "cameras.py")])
    assert status == errors, report + problem
    assert report.count(" error: ") == errors
