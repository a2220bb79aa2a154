from __future__ import annotations

import pytest

from hardware.cell import read_cell
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import world_with
from hardware.simulation.world import World
from tests.hardware.scanning.faulty import SEED, contents, scan_into


@pytest.fixture(scope="session")
def world() -> World:
    return world_with(builtin_object("mug"), read_cell().place, SEED)


@pytest.fixture(scope="session")
def undisturbed(world: World, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The files of a scan that nothing happened to."""
    folder = tmp_path_factory.mktemp("undisturbed") / "scan"
    scan_into(folder, world)
    return contents(folder)
