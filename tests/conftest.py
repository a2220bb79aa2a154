"""Fixtures that all tests share."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The third-party data beside the project; tests that need it skip where it is absent."""
    folder = Path(__file__).resolve().parents[1].parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"needs the data in {folder}")
    return folder


def pytest_collection_modifyitems(items):
    """What one process runs of several: a file, or all of the app, whose sessions are costly to make."""
    here = Path(__file__).parent
    for item in items:
        path = item.path.relative_to(here)
        group = "app" if path.parts[0] == "app" else str(path)
        item.add_marker(pytest.mark.xdist_group(group))
