"""The desktop's tests: widgets offscreen, those marked `gl` under Xvfb."""

from __future__ import annotations

import os

import pytest

pytest.importorskip("PySide6")
pytest.importorskip("pytestqt")


@pytest.fixture(scope="session", autouse=True)
def _no_real_settings(tmp_path_factory):
    """Nothing of the desktop's tests may touch the settings and the sessions of whoever runs them."""
    folder = tmp_path_factory.mktemp("home")
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"):
        os.environ[name] = str(folder / name.lower())
