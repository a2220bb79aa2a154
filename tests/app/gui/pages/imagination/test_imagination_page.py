import shutil
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QPushButton

from app.gui.pages.imagination.drop import ShownBody
from app.gui.pages.imagination.page import ImaginationPage
from app.gui.shell.job_bar import JobBar
from app.jobs.session_work import PictureDrawn
from core.imagination.results import PoursSoFar
from core.parameters import apply_settings
from core.pipeline.news import StageDone
from tests.app.sessions import QUICK


@pytest.fixture
def page(qtbot, desk):
    page = ImaginationPage(desk)
    qtbot.addWidget(page)
    page.resize(1060, 640)
    page.show()
    return page


@pytest.fixture
def opened(page, desk, qtbot):
    def open_session(folder):
        desk.workspace.open(folder)
        qtbot.waitUntil(lambda: page.content is not None)
        return page

    return open_session


def text(page, name):
    return page.findChild(QLabel, name).text().replace("\u00a0", " ")


def primary(page):
    return page.findChild(QPushButton, "primary")


def change(desk, **settings):
    named = {name.replace("__", "."): value for name, value in settings.items()}
    desk.workspace.edit(apply_settings(desk.workspace.parameters, named), "change")


def test_without_a_model_it_says_what_will_be_here_and_leads_to_the_scan(page, desk, qtbot):
    assert "candies are dropped" in text(page, "drop_verdict")
    assert not primary(page).isEnabled()
    assert page.side.parameters.editor.isEnabled()
    with qtbot.waitSignal(desk.page_wanted) as wanted:
        page.findChild(QPushButton, "drop_empty_button").click()
    assert wanted.args == ["scan"]


def test_a_container_is_shown_with_its_reason_its_seed_and_its_footprint(opened, mug_session):
    page = opened(mug_session)
    found = page.content.containability
    verdict, capacity = text(page, "drop_verdict"), page.content.capacity
    held = f"level with its rim it holds {capacity.level_candies:.0f} candies"
    assert verdict.startswith(f"Open container: {held}")
    assert text(page, "drop_reason").startswith(
        f"By Omega an open container: {found.n_in} of {found.n_drop} dropped candies stayed"
    )
    assert page.side.omega.omega == found.omega
    assert f"{found.n_in} of {found.n_drop}" in page.side.footprint.accessibleDescription()
    facts = {fact.title: fact.value for fact in page.side.facts.facts}
    assert facts["Seed"] == "0"
    assert capacity.least_ml < capacity.level_ml < capacity.most_ml
    between = f"{capacity.least_ml:.0f} to {capacity.most_ml:.0f} ml level"
    assert facts["Holds"] == f"{capacity.level_candies:.0f} candies, {between}"
    assert f"{np.degrees(page.content.retention.holds_rad):.0f}°" in facts["Tilted"]
    assert facts["Inside after"].startswith("drop ")
    assert facts["Inside after"].endswith(f" / push {found.n_in}")
    assert f"{found.n_in} kept" in text(page, "drop_legend")


@pytest.mark.parametrize(
    ("least_ml", "most_ml", "said"), [(None, None, "345 ml"), (310.2, None, "at least 310 ml")]
)
def test_of_the_level_volume_it_is_said_what_is_known(opened, mug_session, least_ml, most_ml, said):
    page = opened(mug_session)
    known = {"least_ml": least_ml, "most_ml": most_ml, "hidden_ml": 0.0}
    capacity = replace(page.drop.capacity, volume_ml=345.0, is_hollow_told=False, **known)
    page.side.show_drop(replace(page.drop, capacity=capacity))
    assert page.side.facts.facts[0].value.endswith(f" candies, {said} level")


def test_a_block_says_why_it_is_not_a_container(opened, block_session):
    page = opened(block_session)
    assert text(page, "drop_verdict").startswith("Not an open container: hollow for 0 % of its bulk")
    assert text(page, "drop_reason").startswith("By Omega not an open container: 0 of")


def test_the_drop_is_replayed_with_its_phases(opened, mug_session):
    page = opened(mug_session)
    timeline, drop = page.replay.timeline, page.content
    assert timeline.time_s == pytest.approx(drop.moments.duration_s)
    assert text(page, "drop_now") == "End"
    for phase, words in zip(
        drop.phases, ("fall and settle", "15° about x", "15° about y", "Pushed along +x"), strict=True
    ):
        timeline.set_time(phase.begin_s + 0.05)
        assert words in text(page, "drop_now")
    shown = page.replay.scene._candies["candies"]._target.centers_m
    np.testing.assert_allclose(shown, drop.moments.positions_m(timeline.time_s))


def test_the_result_is_stale_when_a_parameter_changed_and_fresh_after_undo(opened, mug_session, desk):
    page = opened(mug_session)
    assert not primary(page).isEnabled()
    change(desk, containability__drop_s=1.0)
    assert primary(page).isEnabled()
    assert page.side.stale.text == "This is from before you changed “Drop”: press Imagine."
    assert not page.pictures.button.isEnabled()
    desk.workspace.undo_stack.undo()
    assert page.side.stale.text == ""
    assert page.pictures.button.isEnabled()


@pytest.mark.parametrize("change_of", [{"holding__n_load": 8}, {"capacity__n_fillings": 2}])
def test_a_parameter_of_the_judgement_asks_to_imagine_again(opened, mug_session, desk, change_of):
    page = opened(mug_session)
    assert not primary(page).isEnabled()
    change(desk, **change_of)
    assert primary(page).isEnabled()


def test_footprint_and_parameters_share_a_place_and_the_button_says_what_differs(opened, mug_session, desk):
    page = opened(mug_session)
    assert page.side.footprint.isVisible()
    button = page.findChild(QPushButton, "side_page_parameters")
    n = len(QUICK) - 1  # the voxels belong to another page
    assert button.text() == f"Parameters ({n} differ)"
    button.click()
    assert page.side.parameters.isVisible()
    assert not page.side.footprint.isVisible()
    page.side.parameters.editor.set_value("seed", 7)
    assert desk.workspace.parameters.seed == 7
    assert button.text() == f"Parameters ({n + 1} differ)"


def test_news_of_another_session_is_not_shown(opened, mug_session, desk, tmp_path):
    page = opened(mug_session)
    desk.jobs.event_received.emit(PictureDrawn(tmp_path / "another", tmp_path / "drop_1_start.png"))
    assert page.pictures.strip.pictures == ()


def test_a_damaged_drop_is_explained_on_the_page(page, desk, mug_session, qtbot):
    (mug_session / "containability" / "drop.npz").write_bytes(b"")
    desk.workspace.open(mug_session)
    failed = page.findChild(QLabel, "drop_failed")
    qtbot.waitUntil(failed.isVisible)
    assert "drop.npz" in failed.text()
    change(desk, seed=3)  # it stays explained
    assert failed.isVisible()
    assert text(page, "drop_verdict") == "The drop cannot be shown"


def test_the_model_is_shown_before_anything_was_dropped_on_it(opened, block_session):
    for stage in ("containability", "judgement", "amount", "pouring", "risk", "evidence"):
        shutil.rmtree(block_session / stage, ignore_errors=True)
    page = opened(block_session)
    assert isinstance(page.content, ShownBody)
    assert set(page.replay.scene.layers()) == {"object", "ground"}
    assert "Press Imagine" in text(page, "drop_verdict")
    assert page.replay.timeline.duration_s == 0


def test_a_drop_is_shown_as_soon_as_it_is_there_and_the_verdict_when_it_is_known(
    opened, mug_session, desk, qtbot, tmp_path
):
    kept = shutil.move(mug_session / "judgement", tmp_path / "judgement")
    page = opened(mug_session)
    drop = page.drop.drop
    assert text(page, "drop_verdict").startswith(f"{drop.n_in} of {drop.n_drop} dropped candies stayed.")
    assert page.replay.timeline.duration_s > 0
    former = page.content
    page.replay.timeline.set_time(0.3)
    shutil.move(kept, mug_session / "judgement")
    desk.jobs.event_received.emit(StageDone(mug_session, "judgement"))
    qtbot.waitUntil(lambda: page.content is not former)
    assert text(page, "drop_verdict").startswith("Open container")
    assert page.replay.timeline.time_s == pytest.approx(0.3)  # whoever looks at the drop is not disturbed


def test_the_wheel_fills_while_pours_are_imagined(opened, mug_session, desk):
    page = opened(mug_session)
    p = np.full((8, 3), np.nan)
    p[2, 1] = 0.5
    thetas, indents = np.arange(8.0), np.array([0.01, 0.02, 0.03])
    desk.jobs.event_received.emit(PoursSoFar(thetas, indents, p))
    assert page.side.wheel.isVisible()
    assert "P 50 %" in page.side.wheel.describe(2, 1)
    assert "not imagined yet" in page.side.wheel.describe(0, 0)
    page.side.wheel.grab()
    page.side.end_pours()
    assert page.side.footprint.isVisible()


def test_pointing_at_a_tilt_in_the_chart_tilts_the_object_and_the_replay_puts_it_back(opened, mug_session):
    page = opened(mug_session)
    page.findChild(QPushButton, "side_page_retention").click()
    chart, scene, retention = page.side.retention, page.replay.scene, page.drop.retention
    QTest.mouseClick(
        chart, Qt.MouseButton.LeftButton, pos=QPoint(round(0.97 * chart.width()), chart.height() // 2)
    )
    assert chart.pointed_rad == pytest.approx(retention.tilt_rad[-1])
    tilted = scene._layers["object"].T_world_layer
    assert np.degrees(np.arccos(tilted[2, 2])) == pytest.approx(np.degrees(retention.tilt_rad[-1]), abs=0.01)
    left = round(retention.worst_share_left[-1] * retention.n_load)
    assert f"{left} of {retention.n_load} candies left" in text(page, "drop_now")
    QTest.keyClick(chart, Qt.Key.Key_Left)
    assert chart.pointed_rad == pytest.approx(retention.tilt_rad[-2])
    page.replay.timeline.set_time(0.1)
    assert chart.pointed_rad is None
    np.testing.assert_allclose(scene._layers["object"].T_world_layer, page.drop.moments.T_world_body(0.1))


@pytest.mark.system
def test_imagining_shows_the_model_then_the_drop_then_the_verdict_and_one_bar(
    opened, block_session, mug_session, desk, qtbot
):
    bar = JobBar(desk.jobs)
    qtbot.addWidget(bar)
    for stage in ("containability", "judgement", "amount", "pouring", "risk"):
        shutil.rmtree(mug_session / stage, ignore_errors=True)
    page = opened(mug_session)
    seen, fractions, left_s, said, filled = [], [], [], set(), []

    def look(job):
        fractions.append(job.fraction)
        left_s.append(job.seconds_left)
        said.add(text(bar, "job_text"))
        seen.append((page.drop is not None, page.drop is not None and page.drop.containability is not None))

    desk.jobs.progressed.connect(look)
    desk.jobs.event_received.connect(
        lambda news: filled.append(int(np.isfinite(news.p).sum())) if isinstance(news, PoursSoFar) else None
    )
    primary(page).click()
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    assert {(False, False), (True, False), (True, True)} <= set(seen)
    assert fractions == sorted(fractions)
    known_s = [one for one in left_s if one is not None]
    assert known_s == sorted(known_s, reverse=True)
    assert filled == list(range(1, 25))
    assert any("Pours" in one and "of 24" in one for one in said)


def test_another_session_leaves_nothing_of_the_one_before(opened, mug_session, desk, tmp_path):
    page = opened(mug_session)
    desk.workspace.open(tmp_path / "new")
    assert page.content is None
    assert page.replay.scene.layers() == ()
    assert page.replay.timeline.duration_s == 0
    assert "candies are dropped" in text(page, "drop_verdict")


@pytest.mark.system
def test_imagined_with_a_high_threshold_a_mug_is_none_and_its_pictures_fill_the_strip(
    opened, mug_session, desk, qtbot
):
    page = opened(mug_session)
    former = page.content
    change(desk, containability__capacity_threshold=0.9, evidence__films=False)
    primary(page).click()
    assert not primary(page).isEnabled()
    qtbot.waitUntil(lambda: page.content is not former and desk.jobs.is_idle)
    assert text(page, "drop_verdict").startswith("Not an open container")
    assert "(containers: over 90" in text(page, "drop_details")
    assert "an open container" in text(page, "drop_reason")
    seen = []

    def count(news):
        if isinstance(news, PictureDrawn):
            seen.append(sum(picture.path is not None for picture in page.pictures.strip.pictures))

    desk.jobs.event_received.connect(count)
    page.pictures.button.click()
    assert page.pictures.strip.pictures[0].caption == "Start"
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    assert seen == [1, 2, 3, 4, 5, 6]
    paths = [picture.path for picture in page.pictures.strip.pictures]
    assert [path.name for path in paths if path.parent.name == "evidence"] == [path.name for path in paths]
    assert all(path.is_file() for path in paths)
    assert not page.pictures.button.isVisible()
