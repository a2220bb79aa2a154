from __future__ import annotations

import pytest

from core.scan.model import Scan
from hardware.simulation.objects import builtin_object
from tests.core.quality.studio import LOW_RINGS, Studio, on_platform


@pytest.fixture(scope="session")
def mug() -> Studio:
    return on_platform(builtin_object("mug"))


@pytest.fixture(scope="session")
def mug_scan(mug) -> Scan:
    return mug.scan()


@pytest.fixture(scope="session")
def vase() -> Studio:
    return on_platform(builtin_object("vase"))


@pytest.fixture(scope="session")
def vase_scan(vase) -> Scan:
    """Without the steep views."""
    return vase.scan(LOW_RINGS)
