"""Whatever closed or broken mesh people bring: an answer or a sentence, never a traceback."""

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.errors import PoursightError
from core.mesh import TriangleMesh
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool

QUICK = {
    "containability.n_max": 20,
    "containability.n_min": 5,
    "containability.drop_s": 0.1,
    "containability.rotation_s": 0.05,
    "containability.translation_s": 0.02,
    "pouring.n_pour": 4,
    "capacity.n_fillings": 1,
    "capacity.n_aimed": 20,
    "capacity.lattice_points": 10_000,
    "holding.n_load": 4,
    "holding.settle_s": 0.2,
    "holding.tilt_step_rad": 0.2,
    "holding.tilt_max_rad": 0.4,
    "holding.hold_s": 0.05,
    "risk.n_tries": 4,
    "pouring.turn_s": 0.5,
    "evidence.renders": False,
    "evidence.films": False,
}


@pytest.fixture(scope="module")
def pool():
    with WorkerPool(2) as workers:
        yield workers


@st.composite
def meshes(draw):
    """Convex bodies and triangle soups of random points, stretched any way."""
    n_vertices = draw(st.integers(5, 12))
    seed = draw(st.integers(0, 10_000))
    generator = np.random.default_rng(seed)
    stretch = np.array([draw(st.sampled_from([1e-4, 0.01, 0.1, 0.5, 5.0])) for _ in range(3)])
    vertices = generator.uniform(-0.5, 0.5, (n_vertices, 3)) * stretch
    if draw(st.booleans()):
        hull = trimesh.convex.convex_hull(vertices)
        return TriangleMesh(np.array(hull.vertices), np.array(hull.faces, dtype=np.int64))
    faces = generator.integers(0, n_vertices, (draw(st.integers(1, 20)), 3))
    return TriangleMesh(vertices, faces)


parameter_choices = st.fixed_dictionaries(
    {},
    optional={
        "containability.verdict": st.sampled_from(["capacity", "omega"]),
        "collision.method": st.sampled_from(["exact", "vhacd"]),
        "particle.shape": st.sampled_from(["cylinder", "ellipsoid", "sphere"]),
        "particle.diameter_m": st.floats(0.001, 0.05),
        "particle.height_m": st.floats(0.001, 0.05),
        "pouring.counted": st.sampled_from(["inside", "above_floor"]),
        "pouring.theta_fixed_rad": st.floats(-3, 3),
        "pouring.cup.wall_m": st.floats(0.0005, 0.02),
        "containability.omega_threshold": st.floats(0, 1),
        "solver.substeps": st.integers(1, 8),
    },
)


@pytest.mark.system
@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(mesh=meshes(), chosen=parameter_choices)
def test_any_mesh_with_any_parameters(mesh, chosen, pool, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fuzz")
    write_ply(folder / "soup.ply", mesh)
    try:
        parameters = apply_settings(Parameters(), QUICK | chosen)
        with Session.create_or_open(folder / "session") as session:
            pipeline = Pipeline(session, parameters, pool, Reporter())
            pipeline.import_mesh(folder / "soup.ply")
            result = pipeline.imagination()
    except PoursightError as error:
        assert "\n" not in str(error)
        assert str(error).endswith((".", "?"))
    else:
        assert 0 <= result.containability.omega <= 1
        if result.grid is not None:
            assert ((result.grid.p >= 0) & (result.grid.p <= 1)).all()
