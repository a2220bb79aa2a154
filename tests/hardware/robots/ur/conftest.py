"""Benches, put in order before each test, and kept as long as the next one wants the same kind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, closing

import pytest

from hardware.simulation.ur_controller.process import ControllerProcess
from tests.hardware.robots.ur.bench import HOME, VERSIONS, Bench, driver


class OneBench:
    """The bench that is there now: also a standing one takes a part of a processor before all others."""

    def __init__(self) -> None:
        self._kind: tuple[str, float] | None = None
        self._open = ExitStack()

    def of(self, version: str, speed_up: float = 1.0) -> Bench:
        """This kind, at home: the one that is there, or a new one in its place."""
        if self._kind != (version, speed_up):
            self.close()
            controller = self._open.enter_context(
                ControllerProcess(version=version, joints_rad=HOME, speed_up=speed_up)
            )
            self._bench = Bench(controller, self._open.enter_context(driver(controller.address)))
            self._kind = version, speed_up
        self._bench.put_in_order()
        return self._bench

    def close(self) -> None:
        self._kind = None
        self._open.close()


@pytest.fixture(scope="module")
def one_bench() -> Iterator[OneBench]:
    with closing(OneBench()) as benches:
        yield benches


@pytest.fixture(scope="module", params=VERSIONS)
def either_version(request: pytest.FixtureRequest) -> str:
    """Of a module's scope, so that pytest runs the tests of one version together."""
    return str(request.param)


@pytest.fixture
def either_bench(one_bench: OneBench, either_version: str) -> Bench:
    """A CB3 at 125 Hz and an e-Series at 500 Hz, at home."""
    return one_bench.of(either_version)


@pytest.fixture
def bench(one_bench: OneBench) -> Bench:
    """A CB3, as the paper's arm has, at home."""
    return one_bench.of("3.15")


@pytest.fixture
def fast_bench(one_bench: OneBench) -> Bench:
    """Its clock runs faster, so that the 5 s of a protective stop, and switching on, are over sooner."""
    return one_bench.of("3.15", speed_up=4.0)


@pytest.fixture
def controller() -> Iterator[ControllerProcess]:
    """Nobody is connected to it."""
    with ControllerProcess(joints_rad=HOME) as controller:
        yield controller
