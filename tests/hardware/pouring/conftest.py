"""One program and one simulated controller for all tests of a module."""

from __future__ import annotations

import pytest

from tests.hardware.pouring.rig import Rig


@pytest.fixture(scope="module")
def lasting(request, tmp_path_factory):
    """One program for all faults: each test's pour is the one after the fault before.

    Its controller runs at the pace that the module names `SPEED_UP`, or else as fast as the rig allows.
    """
    pace = {"speed_up": request.module.SPEED_UP} if hasattr(request.module, "SPEED_UP") else {}
    with Rig(tmp_path_factory.mktemp("session"), **pace) as rig:
        yield rig


@pytest.fixture
def rig(lasting):
    """The lasting one; started again only where a failed test left the arm on its path."""
    yield lasting
    if not lasting.is_fit_for_the_next_test:
        lasting.__exit__(None, None, None)
        lasting.__enter__()
