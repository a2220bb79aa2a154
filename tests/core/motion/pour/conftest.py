import pytest

from tests.core.motion.pour.stage import Planned, planned

POURS = [("mug", 0, 1), ("bowl", 6, 0), ("basket", 7, 0), ("glass", 1, 2)]


@pytest.fixture(scope="session", params=POURS, ids=lambda pour: f"{pour[0]}-{pour[1]}-{pour[2]}")
def pour(request) -> Planned:
    """Plans for several objects and pivots."""
    return planned(*request.param)


@pytest.fixture(scope="session")
def mug() -> Planned:
    return planned("mug", 0, 1)
