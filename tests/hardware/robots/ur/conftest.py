"""Benches, started once a file and put in order before each test: starting one takes a second."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from hardware.simulation.ur_controller.process import ControllerProcess
from tests.hardware.robots.ur.bench import HOME, VERSIONS, Bench, driver


@contextmanager
def connected(version: str, speed_up: float = 1.0) -> Iterator[Bench]:
    with (
        ControllerProcess(version=version, joints_rad=HOME, speed_up=speed_up) as controller,
        driver(controller.address) as robot,
    ):
        yield Bench(controller, robot)


@pytest.fixture(scope="module", params=VERSIONS)
def either_connected(request: pytest.FixtureRequest) -> Iterator[Bench]:
    with connected(request.param) as bench:
        yield bench


@pytest.fixture(scope="module")
def cb3_connected() -> Iterator[Bench]:
    with connected("3.15") as bench:
        yield bench


@pytest.fixture(scope="module")
def fast_connected() -> Iterator[Bench]:
    with connected("3.15", speed_up=4.0) as bench:
        yield bench


@pytest.fixture
def either_bench(either_connected: Bench) -> Bench:
    """A CB3 at 125 Hz and an e-Series at 500 Hz, at home."""
    either_connected.put_in_order()
    return either_connected


@pytest.fixture
def bench(cb3_connected: Bench) -> Bench:
    """A CB3, as the paper's arm has, at home."""
    cb3_connected.put_in_order()
    return cb3_connected


@pytest.fixture
def fast_bench(fast_connected: Bench) -> Bench:
    """Its clock runs faster, so that the 5 s of a protective stop, and switching on, are over sooner."""
    fast_connected.put_in_order()
    return fast_connected


@pytest.fixture
def controller() -> Iterator[ControllerProcess]:
    """Nobody is connected to it."""
    with ControllerProcess(joints_rad=HOME) as controller:
        yield controller
