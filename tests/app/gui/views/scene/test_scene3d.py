from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QGuiApplication, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget

from app.gui.views.scene import ColorScale, Frustum, Scene3D, box_mesh
from app.gui.views.scene.overlay import ScaleLegend, tick_texts
from core.geometry import look_at, make_pose
from core.motion.arm_models import UR5

LEFT, MIDDLE, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.NoButton


@pytest.fixture
def scene(qtbot):
    scene = Scene3D()
    qtbot.addWidget(scene)
    scene.resize(800, 600)
    scene.show()
    return scene


@pytest.fixture
def box_scene(scene):
    scene.set_mesh("box", *box_mesh((-0.1, -0.1, 0), (0.1, 0.1, 0.2)))
    scene.fit("box")
    scene.look_from("top")
    return scene


def surface(scene):
    """What takes the mouse."""
    return scene.findChild(QLabel, "no_opengl") or scene.findChild(QWidget, "gl_view")


def send(scene, kind, at, button=LEFT, held=LEFT, modifiers=Qt.KeyboardModifier.NoModifier):
    widget = surface(scene)
    place = QPointF(*at)
    event = QMouseEvent(kind, place, widget.mapToGlobal(place), button, held, modifiers)
    QApplication.sendEvent(widget, event)


def drag(scene, start, end, button=LEFT, modifiers=Qt.KeyboardModifier.NoModifier):
    send(scene, QEvent.Type.MouseButtonPress, start, button, button, modifiers)
    for share in (0.5, 1):
        at = tuple(np.add(start, share * np.subtract(end, start)))
        send(scene, QEvent.Type.MouseMove, at, NONE, button, modifiers)
    send(scene, QEvent.Type.MouseButtonRelease, end, button, NONE, modifiers)


def click(scene, at):
    drag(scene, at, at)


def camera(scene):
    QApplication.processEvents()  # layers are brought into view together, when the loop comes round
    return scene._navigator.camera


def wheel(scene, delta):
    widget = surface(scene)
    none = Qt.KeyboardModifier.NoModifier
    begin = Qt.ScrollPhase.NoScrollPhase
    at = QPointF(400, 300)
    event = QWheelEvent(at, widget.mapToGlobal(at), QPoint(), QPoint(0, delta), NONE, none, begin, False)
    QApplication.sendEvent(widget, event)


def test_without_opengl_a_sentence_says_so(scene):
    if QGuiApplication.platformName() != "offscreen":
        pytest.skip("here there is OpenGL")
    assert "OpenGL" in surface(scene).text()
    assert not scene.grab_image().isNull()


def test_layers_are_listed_until_they_are_removed(scene):
    scene.set_line("line", [(0, 0, 0), (1, 1, 1)])
    scene.set_points("points", [(0, 0, 0)])
    scene.set_arrow("arrow", (0, 0, 0), (1, 0, 0))
    scene.set_label("label", (0, 0, 0), "pivot")
    scene.set_line("line", [(0, 0, 0), (2, 1, 1)])
    assert scene.layers() == ("line", "points", "arrow", "label")
    scene.remove("points")
    scene.remove("points")
    assert scene.layers() == ("line", "arrow", "label")
    scene.clear()
    assert scene.layers() == ()


def test_the_empty_text_is_there_until_there_is_a_layer(scene):
    scene.set_empty_text("Scan an object to see it here.")
    hint = scene.findChild(QLabel, "empty_text")
    scene.set_line("line", [(0, 0, 0), (1, 1, 1)])
    assert hint.isHidden()
    scene.remove("line")
    assert hint.text() == "Scan an object to see it here."
    assert hint.isHidden() == (QGuiApplication.platformName() == "offscreen")


def test_a_click_picks_the_nearest_layer(qtbot, box_scene):
    box_scene.set_mesh("floor", *box_mesh((-1, -1, -0.1), (1, 1, 0)))
    with qtbot.waitSignal(box_scene.picked) as emitted:
        click(box_scene, (400, 300))
    assert emitted.args[0] == "box"
    with qtbot.waitSignal(box_scene.picked) as emitted:
        click(box_scene, (790, 10))
    assert emitted.args[0] == "floor"


def test_hidden_layers_are_not_picked(qtbot, box_scene):
    box_scene.set_visible("box", False)
    with qtbot.assertNotEmitted(box_scene.picked):
        click(box_scene, (400, 300))


def test_a_moved_layer_is_picked_where_it_is(qtbot, box_scene):
    box_scene.set_pose("box", make_pose(np.eye(3), (5, 0, 0)))
    with qtbot.assertNotEmitted(box_scene.picked):
        click(box_scene, (400, 300))


def test_setting_a_layer_again_keeps_its_pose(qtbot, box_scene):
    box_scene.set_pose("box", make_pose(np.eye(3), (5, 0, 0)))
    box_scene.set_mesh("box", *box_mesh((-0.1, -0.1, 0), (0.1, 0.1, 0.1)))
    with qtbot.assertNotEmitted(box_scene.picked):
        click(box_scene, (400, 300))


def test_a_view_of_the_camera_is_picked_by_its_index(qtbot, scene):
    poses = [look_at((0.3 * k, 0, 0.4), (0.3 * k, 0, 0)) for k in range(3)]
    scene.set_frusta("views", [Frustum(f"frame-{k}", pose) for k, pose in enumerate(poses)])
    scene.look_from("top")
    with qtbot.waitSignal(scene.picked) as emitted:
        click(scene, (400, 300))
    assert emitted.args == ["views", 1]


def test_a_candy_is_picked_by_its_index(qtbot, scene):
    scene.set_candies("candies", 2, box_mesh((-0.01,) * 3, (0.01,) * 3))
    scene.set_candy_poses("candies", [(0, 0, 0), (0, 0, 0.1)], [(0, 0, 0, 1)] * 2)
    scene.fit("candies")
    scene.look_from("top")
    with qtbot.waitSignal(scene.picked) as emitted:
        click(scene, (400, 300))
    assert emitted.args == ["candies", 1]


def test_dragging_turns_and_does_not_pick(qtbot, box_scene):
    box_scene.look_from("iso")
    before = box_scene.azimuth_deg
    with qtbot.assertNotEmitted(box_scene.picked), qtbot.waitSignal(box_scene.azimuth_changed) as emitted:
        drag(box_scene, (400, 300), (500, 300))
    assert box_scene.azimuth_deg < before
    assert emitted.args[0] != before


@pytest.mark.parametrize(
    ("button", "modifier"),
    [(MIDDLE, Qt.KeyboardModifier.NoModifier), (LEFT, Qt.KeyboardModifier.ShiftModifier)],
)
def test_the_middle_button_or_shift_moves_the_picture(box_scene, button, modifier):
    before = camera(box_scene)
    drag(box_scene, (400, 300), (450, 320), button, modifier)
    after = camera(box_scene)
    center = np.array([before.center_m])
    assert after.project(center, (800, 600))[0] == pytest.approx((450, 320))
    assert after.azimuth_deg == before.azimuth_deg


def test_the_wheel_goes_nearer(box_scene):
    before = camera(box_scene).distance_m
    wheel(box_scene, 120)
    assert camera(box_scene).distance_m < before


def test_a_double_click_centres(box_scene):
    box_scene.look_from("top")
    at = (480, 300)
    ray = camera(box_scene).ray(at, (800, 600))
    send(box_scene, QEvent.Type.MouseButtonDblClick, at)
    assert camera(box_scene).center_m[2] == pytest.approx(0.2)
    assert np.cross(np.array(camera(box_scene).center_m) - ray.origin_m, ray.direction) == pytest.approx(
        np.zeros(3), abs=1e-9
    )


def test_keys_turn_and_enlarge_and_others_are_left_alone(box_scene):
    before = camera(box_scene)
    QTest.keyClick(surface(box_scene), Qt.Key.Key_Right)
    QTest.keyClick(surface(box_scene), Qt.Key.Key_Plus)
    after = camera(box_scene)
    assert after.azimuth_deg == pytest.approx(before.azimuth_deg + 5)
    assert after.distance_m < before.distance_m
    QTest.keyClick(surface(box_scene), Qt.Key.Key_A)
    assert camera(box_scene) == after


def test_dragging_a_handle_edits_the_box_and_does_not_turn(qtbot, scene):
    scene.set_box("crop", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), has_handles=True)
    scene.look_from("front")
    before = camera(scene)
    start, end = before.project(np.array([[0.1, 0, 0.1], [0.13, 0, 0.1]]), (800, 600))
    with qtbot.waitSignal(scene.box_edited) as emitted:
        drag(scene, tuple(start), tuple(end))
    name, low, high = emitted.args
    assert name == "crop"
    assert low == pytest.approx((-0.1, -0.1, 0))
    assert high == pytest.approx((0.13, 0.1, 0.2))
    assert camera(scene) == before


def test_the_cursor_shows_a_handle(scene):
    scene.set_box("crop", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), has_handles=True)
    scene.look_from("front")
    at = camera(scene).project(np.array([[0.1, 0, 0.1]]), (800, 600))[0]
    send(scene, QEvent.Type.MouseMove, tuple(at), NONE, NONE)
    assert surface(scene).cursor().shape() == Qt.CursorShape.SizeAllCursor
    send(scene, QEvent.Type.MouseMove, (5, 5), NONE, NONE)
    assert surface(scene).cursor().shape() == Qt.CursorShape.ArrowCursor


def test_a_handle_may_vanish_while_it_is_dragged(qtbot, scene):
    scene.set_box("crop", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), has_handles=True)
    scene.look_from("front")
    at = tuple(camera(scene).project(np.array([[0.1, 0, 0.1]]), (800, 600))[0])
    send(scene, QEvent.Type.MouseButtonPress, at)
    scene.remove("crop")
    with qtbot.assertNotEmitted(scene.box_edited):
        send(scene, QEvent.Type.MouseMove, (600, 300), NONE)
        send(scene, QEvent.Type.MouseButtonRelease, (600, 300), LEFT, NONE)


def test_layers_come_into_view_until_the_user_chose_what_to_see(scene):
    scene.set_points("near", [(0, 0, 0), (0.1, 0, 0)])
    first = camera(scene).distance_m
    scene.set_points("far", [(2, 0, 0)])
    both = camera(scene).distance_m
    assert both > 3 * first
    scene.fit("near")
    assert camera(scene).distance_m == pytest.approx(first)
    scene.set_points("farther", [(9, 0, 0)])
    assert camera(scene).distance_m == pytest.approx(first)


def test_what_was_fitted_stays_in_view_when_the_size_changes_until_the_user_moves(box_scene):
    before = camera(box_scene).distance_m
    box_scene.resize(300, 600)
    narrow = camera(box_scene).distance_m
    assert narrow > before
    wheel(box_scene, 120)
    zoomed = camera(box_scene).distance_m
    box_scene.resize(800, 600)
    assert camera(box_scene).distance_m == zoomed


def test_layers_can_be_fitted_before_they_come(scene):
    scene.set_points("far", [(-5, 0, 0), (5, 0, 0)])
    before = camera(scene).distance_m
    scene.fit("object")
    scene.set_mesh("object", *box_mesh((0, 0, 0), (0.1, 0.1, 0.1)))
    assert camera(scene).distance_m < before / 10


@pytest.mark.parametrize("direction", ["iso", "top", "front", "side"])
def test_buttons_choose_where_to_look_from(qtbot, box_scene, direction):
    box_scene.look_from("side" if direction != "side" else "top")
    button = box_scene.findChild(QWidget, f"view_{direction}")
    assert button.accessibleName()
    with qtbot.waitSignal(box_scene.azimuth_changed):
        button.click()
    assert camera(box_scene).azimuth_deg == camera(box_scene).looking_from(direction).azimuth_deg


def test_the_fit_button_brings_everything_back(box_scene):
    wheel(box_scene, -2000)
    far = camera(box_scene).distance_m
    box_scene.findChild(QWidget, "view_fit").click()
    assert camera(box_scene).distance_m < far / 2


def test_an_arm_bends_and_a_mesh_replaces_it(scene):
    scene.set_arm("arm", UR5, np.zeros(6))
    before = scene._layers["arm"].outline_m()
    scene.set_joints("arm", np.full(6, 0.5))
    assert not np.allclose(scene._layers["arm"].outline_m(), before)
    scene.set_mesh("arm", *box_mesh((0, 0, 0), (1, 1, 1)))
    with pytest.raises(KeyError):
        scene.set_joints("arm", np.zeros(6))


def test_the_scale_is_shown_with_numbers_and_unit(scene):
    legend = scene.findChild(ScaleLegend)
    assert legend.isHidden()
    scene.show_scale(ColorScale("Height", "mm", 0, 92))
    assert not legend.isHidden()
    assert legend.accessibleName() == "Height 0 23 46 69 92 mm"
    assert scene.rect().contains(legend.geometry())
    scene.show_scale(None)
    assert legend.isHidden()
    scene.show_scale(ColorScale("Height", "mm", 0, 92))
    scene.clear()
    assert legend.isHidden()


@pytest.mark.parametrize(
    ("low", "high", "texts"),
    [
        (0, 100, ["0", "25", "50", "75", "100"]),
        (-1, 1, ["-1.0", "-0.5", "0.0", "0.5", "1.0"]),
        (0.4, 0.6, ["0.40", "0.45", "0.50", "0.55", "0.60"]),
        (1, 6, ["1.0", "2.2", "3.5", "4.8", "6.0"]),
        (3, 3, ["3", "3", "3", "3", "3"]),
    ],
)
def test_numbers_of_a_scale_have_as_many_decimals_as_they_need(low, high, texts):
    assert tick_texts(ColorScale("x", "m", low, high)) == texts
