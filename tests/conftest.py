"""Fixtures that all tests share."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

FIRST = (
    "app/gui/desk/test_job_steps.py",
    "app/operations/evaluation/test_trial.py",
    "app/cli/test_interrupted.py",
    "app/cli/test_pour_command.py",
    "app/cli/test_scan_command.py",
    "app/cli/test_tune_command.py",
    "app/gui/pages/robot/test_pouring.py",
    "app/jobs/test_arm_work.py",
    "app/jobs/test_scan_work.py",
    "app/operations/evaluation/test_engines.py",
    "app/operations/evaluation/test_same_everywhere.py",
    "core/motion/pour/test_planning.py",
    "hardware/pouring/test_faults.py",
)
"""The first makes the mug's session, for which others would wait. The others take longest: begun last, one of
them would leave the other processor idle."""


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The third-party data beside the project; tests that need it skip where it is absent."""
    folder = Path(__file__).resolve().parents[1].parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"needs the data in {folder}")
    return folder


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    """What programs keep between sessions is neither the user's nor another test run's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def pytest_collection_modifyitems(items):
    """Begin with these files: one process runs a whole file, whose fixtures are costly to make."""
    here, place = Path(__file__).parent, {name: k for k, name in enumerate(FIRST)}
    items.sort(key=lambda item: place.get(str(item.path.relative_to(here)), len(FIRST)))


def pytest_collection_finish():
    """Collected tests stay to the end: looking through thousands for garbage takes 0.4 s each time."""
    gc.collect()
    gc.freeze()
