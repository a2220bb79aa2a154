from __future__ import annotations

import time

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QComboBox, QPushButton

from app.gui.views.timeline import STEP_S, Scrubber, Section, Timeline

SECTIONS = (Section("drop", 0, 1), Section("tilt about x", 1, 3), Section("shove", 3, 4))


@pytest.fixture
def timeline(qtbot):
    widget = Timeline()
    qtbot.addWidget(widget)
    widget.resize(700, 40)
    widget.set_sections(4.0, SECTIONS)
    widget.show()
    return widget


def test_it_plays_with_the_wall_clock_and_its_speed(qtbot, timeline):
    timeline.findChild(QComboBox).setCurrentText("2x")
    begin = time.perf_counter()
    timeline.play()
    qtbot.wait(400)
    timeline.pause()
    passed_s = time.perf_counter() - begin
    assert timeline.time_s == pytest.approx(2 * passed_s, abs=0.2)


def test_it_stops_at_the_end_and_plays_again_from_the_beginning(qtbot, timeline):
    timeline.set_time(3.95)
    timeline.play()
    qtbot.waitUntil(lambda: not timeline.is_playing)
    assert timeline.time_s == 4.0
    with qtbot.waitSignal(timeline.time_changed) as heard:
        timeline.play()
    assert heard.args[0] < 0.5


def test_space_toggles_and_the_button_says_what_it_does(qtbot, timeline):
    button = timeline.findChild(QPushButton, "timeline_play")
    scrubber = timeline.findChild(Scrubber)
    qtbot.keyClick(scrubber, Qt.Key.Key_Space)
    assert timeline.is_playing
    assert button.text() == "Pause"
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    assert not timeline.is_playing
    assert button.text() == "Play"


def test_arrows_step_by_a_frame_and_with_control_by_a_section(qtbot, timeline):
    scrubber = timeline.findChild(Scrubber)
    qtbot.keyClick(scrubber, Qt.Key.Key_Right)
    assert timeline.time_s == pytest.approx(STEP_S)
    qtbot.keyClick(scrubber, Qt.Key.Key_Right, Qt.KeyboardModifier.ControlModifier)
    assert timeline.time_s == 1.0
    qtbot.keyClick(scrubber, Qt.Key.Key_Left)
    assert timeline.time_s == pytest.approx(1 - STEP_S)
    qtbot.keyClick(scrubber, Qt.Key.Key_End)
    assert timeline.time_s == 4.0
    qtbot.keyClick(scrubber, Qt.Key.Key_Left, Qt.KeyboardModifier.ControlModifier)
    assert timeline.time_s == 3.0


def test_scrubbing_pauses_and_goes_there(qtbot, timeline):
    scrubber = timeline.findChild(Scrubber)
    timeline.play()
    qtbot.mouseClick(
        scrubber, Qt.MouseButton.LeftButton, pos=QPoint(scrubber.width() // 2, scrubber.height() // 2)
    )
    assert not timeline.is_playing
    assert timeline.time_s == pytest.approx(2.0, abs=0.05)


def test_times_outside_are_limited_and_the_same_time_is_not_sent_again(qtbot, timeline):
    timeline.set_time(99)
    assert timeline.time_s == 4.0
    with qtbot.assertNotEmitted(timeline.time_changed):
        timeline.set_time(100)


def test_without_a_duration_nothing_plays(qtbot, timeline):
    timeline.set_sections(0.0)
    timeline.play()
    assert not timeline.is_playing
    assert not timeline.findChild(QPushButton, "timeline_play").isEnabled()


def test_hidden_it_does_not_go_on(timeline):
    timeline.play()
    timeline.hide()
    assert not timeline.is_playing


def test_the_section_under_a_time_is_found(timeline):
    scrubber = timeline.findChild(Scrubber)
    assert scrubber.section_at(0.5).name == "drop"
    assert scrubber.section_at(1.0).name == "tilt about x"
    assert scrubber.section_at(4.5) is None


def test_changing_the_speed_while_playing_does_not_jump(qtbot, timeline):
    timeline.play()
    qtbot.wait(200)
    before = timeline.time_s
    timeline.findChild(QComboBox).setCurrentText("4x")
    with qtbot.waitSignal(timeline.time_changed) as heard:
        pass
    assert heard.args[0] - before < 1.0
