import json
from dataclasses import replace

import numpy as np
import pytest

from app.gui.pages.reconstruction.loading import key_of, load_model
from app.gui.pages.reconstruction.modes import difference_scale
from app.gui.views.scene import box_mesh
from core.collision import CollisionModel
from core.errors import SessionError
from core.mesh import TriangleMesh
from core.mesh_file import write_ply
from core.pipeline.session_view import SessionView
from core.scan import CropBox
from core.session import Session


def test_a_scanned_session_has_all_there_is_to_show(mug_session):
    session = Session.open(mug_session)
    loaded = load_model(key_of(SessionView(session)))
    model = loaded.model
    assert loaded.own_box == CropBox((-0.3, -0.55, 0.03), (0.18, -0.15, 0.35))
    assert model.is_closed
    assert len(model.quality.n_views) == len(model.mesh.vertices_m) == len(model.body.vertices_m)
    assert model.collision.method == "exact"
    assert model.collision.mesh.edges is not None
    assert len(model.collision.centers_m) == model.collision.n_faces
    assert "The views see the table" in model.health


def test_what_belongs_to_another_surface_is_left_out(mug_session):
    for stage in ("quality", "collision"):
        path = mug_session / stage / "record.json"
        record = json.loads(path.read_text())
        path.write_text(json.dumps(record | {"inputs": record["inputs"] | {"reconstruction": "another"}}))
    model = load_model(key_of(SessionView.of(mug_session))).model
    assert model.quality is None
    assert model.collision is None


def test_a_scan_alone_has_its_crop_box(mug_session):
    key = replace(key_of(SessionView.of(mug_session)), surface="", quality="", collision="")
    loaded = load_model(key)
    assert loaded.model is None
    assert loaded.own_box is not None


def test_an_imported_mesh_has_no_views_and_its_parts_have_tints(tmp_path):
    parts = tuple(
        TriangleMesh(vertices, faces)
        for vertices, faces in (box_mesh((x, 0, 0), (x + 0.02, 0.02, 0.02)) for x in (0, 0.03))
    )
    with Session.create_or_open(tmp_path / "mesh") as session:
        with session.writing("mesh", inputs={}, parameters={}) as folder:
            write_ply(folder / "mesh.ply", parts[0])
        digest = session.record("mesh").digest
        with session.writing("collision", inputs={"mesh": digest}, parameters={}) as folder:
            CollisionModel("given", parts, parts[0]).save(folder)
    loaded = load_model(key_of(SessionView(session)))
    assert loaded.own_box is None
    assert loaded.model.reconstruction is None
    assert loaded.model.quality is None
    assert loaded.model.health == ""
    assert loaded.model.collision.n_parts == 2
    assert len(np.unique(loaded.model.collision.mesh.values)) == 2


def test_a_damaged_file_is_explained(mug_session):
    (mug_session / "reconstruction" / "result.json").write_text("{")
    with pytest.raises(SessionError, match=r"result\.json"):
        load_model(key_of(SessionView.of(mug_session)))


@pytest.mark.parametrize(("most_m", "limit_mm"), [(0.0, 0.5), (0.0009, 1), (0.0012, 2), (0.031, 50)])
def test_the_scale_of_a_difference_is_round_and_the_same_both_ways(most_m, limit_mm):
    scale = difference_scale(np.linspace(-most_m, most_m, 1000), "Moved")
    assert (scale.low, scale.high) == pytest.approx((-limit_mm, limit_mm))
