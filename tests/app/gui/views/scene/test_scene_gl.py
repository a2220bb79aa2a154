"""What is really drawn. Run with -m gl under xvfb-run."""

from __future__ import annotations

import itertools
import statistics
import time

import numpy as np
import pytest
from PySide6.QtGui import QColor, QImage
from PySide6.QtWidgets import QLabel, QMainWindow, QStackedWidget

from app.gui.theme import DARK, LIGHT, palette_of
from app.gui.views.scene import (
    ColorScale,
    Frustum,
    Scene3D,
    box_mesh,
    cylinder_mesh,
    prepare_mesh,
    revolved_mesh,
)
from app.gui.views.scene.camera import Camera
from app.gui.views.scene.candies import CANDY_COLORS, LOST_COLOR
from app.gui.views.scene.canvas import has_opengl
from app.gui.views.scene.occlusion import surface_points_m
from app.gui.views.scene.view import SceneView
from core.geometry import look_at
from core.motion.arm_models import UR5
from tests.awake import in_time
from tests.benchmarks.scene_speed import draw, falling, mug, replay_scene

pytestmark = pytest.mark.gl
CANDY = revolved_mesh([(0.0, 0.01), (0.02, 0.004), (0.02, -0.004), (0.0, -0.01)])
CUBE = box_mesh((-0.1, -0.1, -0.1), (0.1, 0.1, 0.1))
GAP = 60
"""How far colours (0 to 255) may be from the theme's: they are shaded."""


@pytest.fixture
def scene(qtbot):
    return shown(qtbot, Scene3D())


def shown(qtbot, widget):
    widget.setPalette(palette_of(LIGHT))
    widget.resize(400, 300)
    qtbot.addWidget(widget)
    with qtbot.waitExposed(widget):
        widget.show()
    return widget


def pixels(image: QImage):
    """(height, width, 3)"""
    rgb = image.convertToFormat(QImage.Format.Format_RGBX8888)
    data = np.frombuffer(rgb.constBits(), dtype=np.uint8).reshape(rgb.height(), -1, 4)
    return data[:, : rgb.width(), :3].astype(int)


def middle(scene):
    return pixels(scene.grab_image())[150, 200]


def rgb(theme, name):
    return np.array(QColor(getattr(theme, name)).getRgb()[:3])


def n_like(picture, color, gap=GAP):
    """How many pixels are about of a colour."""
    return int((np.abs(picture - color).max(axis=-1) < gap).sum())


def test_nothing_is_seen_before_there_is_a_layer(scene):
    assert (pixels(scene.grab_image()) == rgb(LIGHT, "scene")).all()


@pytest.mark.parametrize("direction", ["iso", "top", "front", "side"])
def test_a_surface_is_lit_from_wherever_it_is_seen(scene, direction):
    scene.set_mesh("cube", *CUBE, color="lost")
    scene.look_from(direction)
    assert np.abs(middle(scene) - rgb(LIGHT, "lost")).max() < GAP


def test_a_surface_turned_inside_out_is_lit_as_well(scene):
    vertices, faces = CUBE
    scene.set_mesh("cube", vertices, faces)
    scene.look_from("top")
    outside = middle(scene)
    scene.set_mesh("cube", vertices, faces[:, ::-1])
    assert middle(scene) == pytest.approx(outside, abs=2)


def test_values_are_coloured_by_their_scale(scene):
    scale = ColorScale("Height", "mm", -100, 100)
    vertices, faces = CUBE
    scene.set_mesh("cube", vertices, faces, values=1000 * vertices[:, 2], scale=scale)
    scene.look_from("top")
    assert np.abs(middle(scene) - 255 * scale.colors([100])[0, :3]).max() < GAP


def test_the_theme_recolours_everything(scene):
    scene.set_mesh("cube", *CUBE, color="kept")
    scene.look_from("top")
    scene.setPalette(palette_of(DARK))
    picture = pixels(scene.grab_image())
    assert (picture[5, 5] == rgb(DARK, "scene")).all()
    assert np.abs(picture[150, 200] - rgb(DARK, "kept")).max() < GAP


def test_a_view_that_was_hidden_while_the_theme_changed_is_drawn_in_the_new_one(qtbot):
    """The window's palette is another one by then, which is not told to what nobody sees."""
    window = QMainWindow()
    qtbot.addWidget(window)
    pages = QStackedWidget()
    window.setCentralWidget(pages)
    scene = Scene3D()
    pages.addWidget(QLabel())
    pages.addWidget(scene)
    window.resize(400, 300)
    window.show()
    pages.setCurrentWidget(scene)
    assert (pixels(scene.grab_image())[5, 5] == rgb(LIGHT, "scene")).all()
    pages.setCurrentIndex(0)
    window.setPalette(palette_of(DARK))
    pages.setCurrentWidget(scene)
    assert (pixels(scene.grab_image())[5, 5] == rgb(DARK, "scene")).all()


def test_hidden_and_removed_layers_are_not_drawn(scene):
    scene.set_mesh("cube", *CUBE)
    assert (middle(scene) != rgb(LIGHT, "scene")).any()
    scene.set_visible("cube", False)
    assert (middle(scene) == rgb(LIGHT, "scene")).all()
    scene.set_visible("cube", True)
    assert (middle(scene) != rgb(LIGHT, "scene")).any()
    scene.remove("cube")
    assert (middle(scene) == rgb(LIGHT, "scene")).all()


def test_one_sees_through_a_see_through_layer_whatever_came_first(scene):
    inner = box_mesh((-0.05, -0.05, -0.05), (0.05, 0.05, 0.05))
    seen = []
    for order in (("glass", "core"), ("core", "glass")):
        scene.clear()
        for name in order:
            if name == "glass":
                scene.set_mesh("glass", *CUBE, color="lost", opacity=0.3)
            else:
                scene.set_mesh("core", *inner, color="kept")
        scene.fit("glass")
        scene.look_from("top")
        seen.append(middle(scene))
    expected = 0.3 * rgb(LIGHT, "lost") + 0.7 * rgb(LIGHT, "kept")
    assert np.abs(seen[0] - expected).max() < GAP
    assert seen[0] == pytest.approx(seen[1], abs=2)


def test_see_through_layers_are_drawn_from_far_to_near(scene):
    scene.set_mesh("near", *box_mesh((-0.1, -0.1, 0.2), (0.1, 0.1, 0.25)), color="lost", opacity=0.6)
    scene.set_mesh("far", *box_mesh((-0.1, -0.1, 0.0), (0.1, 0.1, 0.05)), color="kept", opacity=0.6)
    scene.look_from("top")
    scene.set_line("unseen", [(0, 0, 0)])
    behind = 0.6 * rgb(LIGHT, "kept") + 0.4 * rgb(LIGHT, "scene")
    expected = 0.6 * rgb(LIGHT, "lost") + 0.4 * behind
    assert np.abs(middle(scene) - expected).max() < GAP


def test_kept_and_lost_candies_are_seen_and_absent_ones_are_not(scene):
    turns = [(0, 0, 0, 1)] * 3
    scene.set_candies("candies", 3, CANDY, np.array([True, False, True]))
    scene.set_candy_poses("candies", [(-0.05, 0, 0), (0.05, 0, 0), (0, np.nan, 0)], turns)
    scene.fit()
    picture = pixels(scene.grab_image())
    rim, grey = n_like(picture, rgb(LIGHT, "lost"), 30), n_like(picture, QColor(LOST_COLOR).getRgb()[:3], 30)
    colours = [n_like(picture[:, :200], QColor(color).getRgb()[:3], 45) for color in CANDY_COLORS]
    assert rim > 300 and grey > 1000 and max(colours) > 1000
    scene.set_candy_poses("candies", [(-0.05, 0, 0), (np.nan, 0, 0), (0, np.nan, 0)], turns)
    assert n_like(pixels(scene.grab_image()), rgb(LIGHT, "lost"), 30) < 20


def test_a_candy_that_stands_on_its_edge_looks_narrow(scene):
    scene.set_candies("candies", 1, CANDY)
    shares = []
    for turn in ((0, 0, 0, 1), (0.5**0.5, 0, 0, 0.5**0.5)):
        scene.set_candy_poses("candies", [(0, 0, 0)], [turn])
        scene.look_from("top")
        shares.append((np.abs(pixels(scene.grab_image()) - rgb(LIGHT, "scene")).max(axis=-1) > 30).mean())
    assert shares[1] < 0.75 * shares[0]


def test_the_ground_is_opaque_from_above_has_shadows_and_is_not_in_the_way_from_below(scene):
    scene.set_ground("ground", (0, 0, -0.1), (0.5, 0.5), surface_points_m(*CUBE, 20_000), grid_m=0.0)
    scene.set_points("corners", [(-0.3, -0.3, 0), (0.3, 0.3, 0)], size_px=1)
    scene.fit("corners")
    scene.look_from("top")
    picture = pixels(scene.grab_image())
    assert np.abs(picture[150, 300] - rgb(LIGHT, "ground")).max() < 12
    assert picture[150, 200].max() < rgb(LIGHT, "ground").min() - 40
    scene.set_mesh("cube", *CUBE, color="lost")
    scene.findChild(SceneView).set_camera(Camera((0, 0, 0), 1.5, -90, -89))
    assert np.abs(middle(scene) - rgb(LIGHT, "lost")).max() < GAP


def test_the_ground_has_lines(scene):
    scene.set_ground("ground", (0, 0, 0), (0.5, 0.5), np.empty((0, 3)), grid_m=0.1, fades=False)
    scene.set_points("corners", [(-0.3, -0.3, 0), (0.3, 0.3, 0)], size_px=1)
    scene.fit("corners")
    scene.look_from("top")
    row = pixels(scene.grab_image())[100, 60:340].max(axis=-1)
    assert 4 <= (np.diff((row < row.max() - 3).astype(int)) == 1).sum() <= 8


def test_words_are_legible_over_a_ground(scene):
    """Its texture leaves the painter of the labels as it was."""
    scene.set_mesh("cube", *CUBE, color="kept")
    scene.set_label("label", (0, 0, 0.1), "WWWWWWWW")
    scene.fit("cube")
    before = pixels(scene.grab_image())
    scene.set_ground("ground", (0, 0, -5), (0.01, 0.01), np.empty((0, 3)))
    assert (np.abs(pixels(scene.grab_image()) - before).max(axis=-1) > 20).sum() < 20


def test_an_arm_moves_when_its_joints_do(scene):
    scene.set_arm("arm", UR5, np.array([0.0, -1.5, 1.5, 0, 0, 0]))
    scene.fit()
    before = pixels(scene.grab_image())
    scene.set_joints("arm", np.array([0.8, -1.0, 1.5, 0, 0, 0]))
    assert (pixels(scene.grab_image()) != before).any(axis=-1).sum() > 500


def test_each_state_of_a_view_looks_different(scene):
    pictures = []
    for state in ("pending", "taken", "poor", "failed"):
        scene.set_frusta("views", [Frustum("frame", look_at((0, -0.1, 0.4), (0, 0, 0)), state)])
        scene.fit("views")
        pictures.append(pixels(scene.grab_image()))
    for k, picture in enumerate(pictures):
        for other in pictures[:k]:
            assert (np.abs(picture - other).max(axis=-1) > 30).sum() > 100


def test_a_wire_frame_lies_on_its_surface(scene):
    scene.set_mesh("body", *cylinder_mesh(0.1, 0.2), color="body")
    scene.set_mesh("wires", *cylinder_mesh(0.1, 0.2), color="stop", is_wireframe=True)
    assert n_like(pixels(scene.grab_image()), rgb(LIGHT, "stop"), 90) > 800


def test_labels_are_in_every_kind_of_picture(qtbot, scene):
    scene.set_mesh("cube", *CUBE, color="kept")
    scene.set_label("label", (0, 0, 0.1), "WWWWWWWW")
    scene.fit("cube")
    assert n_like(pixels(scene.grab_image()), rgb(LIGHT, "surface"), 40) > 300
    qtbot.waitUntil(lambda: n_like(pixels(scene.grab().toImage()), rgb(LIGHT, "surface"), 40) > 300)
    scene.set_visible("label", False)
    assert n_like(pixels(scene.grab_image()), rgb(LIGHT, "surface"), 10) == 0


def test_a_picture_has_smooth_edges(scene):
    scene.set_mesh("cube", *CUBE, color="text")
    picture = pixels(scene.grab_image())
    background, body = rgb(LIGHT, "scene"), rgb(LIGHT, "text")
    is_between = (picture.min(axis=-1) > body.max() + 40) & (picture.max(axis=-1) < background.min() - 40)
    assert is_between.sum() > 100


def test_a_still_view_is_not_painted_again(qtbot, scene):
    scene.set_mesh("cube", *CUBE)
    scene.set_arm("ghost", UR5, np.zeros(6), looks="ghost")
    qtbot.wait(1000)
    frames = []
    scene.findChild(SceneView).painted.connect(lambda: frames.append(1))
    qtbot.wait(500)
    assert frames == []
    scene.set_joints("ghost", np.ones(6))
    scene.set_joints("ghost", np.zeros(6))
    qtbot.wait(500)
    assert 1 <= len(frames) <= 2


def test_two_views_in_a_window_draw_their_own(qtbot):
    pages = shown(qtbot, QStackedWidget())
    scenes = [Scene3D(), Scene3D()]
    for scene, color in zip(scenes, ("kept", "lost"), strict=True):
        pages.addWidget(scene)
        scene.set_mesh("cube", *CUBE, color=color)
        scene.set_points("points", [(0.05, 0.05, 0.11)])
        scene.fit("cube")
        scene.look_from("top")
    for scene, color in [*zip(scenes, ("kept", "lost"), strict=True)] * 2:
        pages.setCurrentWidget(scene)
        qtbot.wait(50)
        assert np.abs(middle(scene) - rgb(LIGHT, color)).max() < GAP


def test_a_view_that_moves_to_another_window_still_draws(qtbot):
    scene = Scene3D()
    scene.set_mesh("cube", *CUBE, color="kept")
    scene.set_line("line", [(-0.2, 0, 0), (0.2, 0, 0)])
    scene.look_from("top")
    windows = QMainWindow(), QMainWindow()
    for window in windows:
        window.setCentralWidget(scene)
        shown(qtbot, window)
        qtbot.wait(50)
        assert np.abs(middle(scene) - rgb(LIGHT, "kept")).max() < GAP


@pytest.fixture
def _asked_anew():
    """Whether there is OpenGL is asked once in a program."""
    has_opengl.cache_clear()
    yield
    has_opengl.cache_clear()


@pytest.mark.usefixtures("_asked_anew")
def test_without_a_context_a_sentence_is_shown(qtbot, monkeypatch):
    monkeypatch.setattr("app.gui.views.scene.canvas.QOpenGLContext.create", lambda _: False)
    scene = shown(qtbot, Scene3D())
    scene.set_mesh("cube", *CUBE)
    assert "OpenGL" in scene.findChild(QLabel, "no_opengl").text()


def test_a_large_mesh_does_not_stall_the_window(qtbot, scene):
    prepared = prepare_mesh(*mug(200_000))
    seconds = []
    for _ in range(4):
        start = time.perf_counter()
        scene.set_prepared_mesh("object", prepared)
        seconds.append(time.perf_counter() - start)
    in_time(statistics.median(seconds), 0.06)


def test_each_step_of_a_replay_is_seen(qtbot):
    """How many a second is up to the machine: `make scene-speed` holds that against its goal."""
    scene = replay_scene(10_000)
    qtbot.addWidget(scene)
    scene.resize(900, 600)
    scene.show()
    spot, seen = falling(), []
    for _ in range(5):
        draw(scene, next(spot))
        seen.append(scene.grab().toImage())
    assert all(one != other for one, other in itertools.pairwise(seen))
