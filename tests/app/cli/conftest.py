"""A session that holds a mesh, which several commands refuse."""

from __future__ import annotations

import pytest

from tests.app.cli.commanding import command
from tests.app.sessions import copied, made_once

FEW_POURS = (
    "--set=containability.n_max=64",
    "--set=containability.n_min=40",
    "--set=containability.verdict=omega",
    "--set=risk.n_tries=0",
    "--set=pouring.n_pour=20",
    "--set=pouring.theta_fixed_rad=0",
)


@pytest.fixture
def mesh_session(shared_data, tmp_path_factory, tmp_path):
    """A mug's mesh, imagined."""
    mesh = next((shared_data / "objects" / "meshes").glob("*mug*.obj"))
    made = made_once(
        tmp_path_factory,
        "imagined_mesh",
        lambda folder: command("imagine", mesh, "--session", folder, *FEW_POURS),
    )
    return copied(made, tmp_path / "session")
