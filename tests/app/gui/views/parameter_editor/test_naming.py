from __future__ import annotations

from math import radians

import pytest

from app.gui.views.parameter_editor.naming import Display, titles
from core.parameters import describe

FACTS = {fact.name: fact for fact in describe()}


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("reconstruction.voxel_m", 0.002, "2 mm"),
        ("particle.height_m", 0.0028, "2.8 mm"),
        ("pouring.cup.mouth_radius_m", 0.0333, "33.3 mm"),
        ("pouring.gamma_0_rad", radians(62), "62°"),
        ("particle.mass_kg", 0.0003, "0.3 g"),
        ("containability.translation_m_s2", 0.5, "0.5 m/s²"),
        ("containability.drop_s", 0.625, "0.625 s"),
        ("collision.max_faces", 4000, "4000"),
        ("collision.method", "vhacd", "V-HACD"),
        ("reconstruction.refine_poses", True, "yes"),
        ("reconstruction.truncation_m", None, "automatic"),
        ("reconstruction.crop_min_m", (-0.3, -0.55, 0.03), "-300, -550, 30 mm"),
    ],
)
def test_values_read_in_the_units_people_use(qtbot, name, value, text):
    assert Display.of(FACTS[name]).text(value) == text


@pytest.mark.parametrize("name", [name for name, fact in FACTS.items() if isinstance(fact.default, float)])
def test_a_default_comes_back_from_its_shown_number(name):
    display = Display.of(FACTS[name])
    default = FACTS[name].default
    assert display.to_data(display.to_shown(default)) == pytest.approx(default, rel=1e-11)


def test_a_typed_number_is_exactly_the_one_in_a_preset():
    assert Display.of(FACTS["reconstruction.voxel_m"]).to_data(4.0) == 0.004
    assert Display.of(FACTS["pouring.gamma_0_rad"]).to_data(62.0) == radians(62)


def test_titles_are_unique_in_their_group_and_without_units():
    found = titles(list(FACTS.values()))
    assert found["reconstruction.voxel_m"] == "Voxel"
    assert found["collision.vhacd_hulls"] == "V-HACD hulls"
    assert found["containability.rotation_s"] == "Rotation time"
    assert found["containability.rotation_rad"] == "Rotation angle"
    grouped = [(name.rpartition(".")[0], title) for name, title in found.items()]
    assert len(set(grouped)) == len(grouped)


def test_the_tooltip_has_doc_range_source_and_name(qtbot):
    said = Display.of(FACTS["reconstruction.voxel_m"]).tooltip()
    for word in ("Edge of a voxel", "1 to 20 mm", "Poursight", "reconstruction.voxel_m"):
        assert word in said
