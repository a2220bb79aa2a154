"""The whole of it, in workers, as the program does it."""

from __future__ import annotations

import re
import subprocess
from io import BytesIO

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from core.errors import Cancelled, SessionError, StageError
from core.imagination.rendering.doctor import renderer_name
from core.imagination.rendering.drop_view import still_moments
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.films import encode, film_moments
from core.imagination.rendering.render import render_evidence
from core.parameters import apply_settings
from core.progress import Reporter
from core.workers import WorkerPool

STILLS = [
    f"drop_{n}_{name}.png"
    for n, name in enumerate(("start", "falling", "settled", "rotated", "pushed", "end"), 1)
]


class Listener(Reporter):
    def __init__(self) -> None:
        super().__init__()
        self.warnings: list[str] = []

    def warn(self, sentence: str) -> None:
        self.warnings.append(sentence)


def render(story, pool, reporter=None, **settings):
    parameters = apply_settings(story.parameters, {f"evidence.{name}": on for name, on in settings.items()})
    return render_evidence(
        story.surface,
        story.cup,
        parameters,
        story.containability,
        story.grid,
        story.choice,
        pool,
        reporter or Reporter(),
    )


@pytest.fixture(scope="module")
def temporary_folder(tmp_path_factory):
    """Where the workers, which inherit the environment, put their temporary files; no screen is needed."""
    folder = tmp_path_factory.mktemp("temporary")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", str(folder))
        patch.setattr("tempfile.tempdir", str(folder))
        patch.delenv("DISPLAY", raising=False)
        yield folder


@pytest.fixture(scope="module")
def pool(temporary_folder):
    with WorkerPool(2) as workers:
        yield workers


@pytest.fixture(scope="module")
def evidence(story, pool):
    return render(story, pool)


def picture(evidence, name):
    return np.asarray(Image.open(BytesIO(evidence.files[name])).convert("RGB")).astype(int)


def left_in(folder):
    return [path for path in folder.iterdir() if path.name.startswith("poursight")]


def count_blue_and_orange(pixels):
    red, green, blue = np.moveaxis(pixels, -1, 0)
    return int((blue > red + 90).sum()), int(((red > blue + 90) & (red > green + 40)).sum())


def film_facts(content, folder):
    path = folder / "film.mp4"
    path.write_bytes(content)
    said = subprocess.run([imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path)], capture_output=True, text=True)
    frames = imageio_ffmpeg.count_frames_and_secs(str(path))[0]
    return said.stderr, frames


def test_all_pictures_and_films_are_there_and_no_file_is_left(evidence, temporary_folder):
    assert sorted(evidence.files) == sorted([*STILLS, "pours.png", "drop.mp4", "pour.mp4"])
    assert evidence.renderer in ("EGL", "TinyRenderer")
    assert left_in(temporary_folder) == []


@pytest.mark.parametrize("name", STILLS)
def test_a_still_shows_kept_and_lost_candies_on_a_light_ground(evidence, name):
    pixels = picture(evidence, name)
    assert pixels.shape == (480, 640, 3)
    blue, orange = count_blue_and_orange(pixels[:440])
    assert blue > 300
    assert orange > 100
    assert np.median(pixels) > 200


def test_the_sheet_has_a_tile_for_each_pour_and_frames_the_chosen_one(evidence):
    pixels = picture(evidence, "pours.png")
    assert pixels.shape[1] > 6 * 320
    assert pixels.shape[0] > 4 * 240
    row, column = np.argwhere((pixels == (0, 102, 209)).all(axis=2)).mean(axis=0) / pixels.shape[:2]
    assert 2 / 4 < row < 3 / 4  # the third direction, in the left half
    assert 1 / 6 < column < 2 / 6


@pytest.mark.parametrize(("name", "seconds"), [("drop.mp4", 1.5), ("pour.mp4", 0.5)])
def test_a_film_plays_in_browsers_in_real_time(evidence, tmp_path, name, seconds):
    said, frames = film_facts(evidence.files[name], tmp_path)
    assert re.search(r"h264.*yuv420p.*640x480", said)
    rate_hz = float(re.search(r"([\d.]+) fps", said)[1])
    assert frames / rate_hz == pytest.approx(seconds + 1, abs=0.1)  # the last picture is held for a second
    assert evidence.files[name].index(b"moov") < evidence.files[name].index(b"mdat")  # plays while loading
    assert len(evidence.files[name]) < 1_000_000


def test_evidence_is_saved_and_loaded(evidence, tmp_path):
    evidence.save(tmp_path)
    assert Evidence.load(tmp_path) == evidence
    (tmp_path / "drop.mp4").unlink()
    with pytest.raises(SessionError, match=r"drop\.mp4"):
        Evidence.load(tmp_path)


def test_only_what_is_wanted_is_made(story, pool):
    assert sorted(render(story, pool, films=False).files) == sorted([*STILLS, "pours.png"])
    assert render(story, pool, films=False, renders=False) == Evidence({}, "")


def test_pictures_are_the_same_every_time(story, pool, evidence):
    again = render(story, pool, films=False)
    assert all(again.files[name] == evidence.files[name] for name in again.files)


def test_an_object_that_is_no_container_has_pictures_of_the_drop_only(story, pool):
    parameters = apply_settings(story.parameters, {"evidence.films": False})
    drop = render_evidence(
        story.surface, None, parameters, story.containability, None, None, pool, Reporter()
    )
    assert sorted(drop.files) == STILLS


def test_it_stops_when_asked(story, pool):
    reporter = Reporter()
    reporter.cancel()
    with pytest.raises(Cancelled):
        render(story, pool, reporter)


def test_a_broken_graphics_driver_costs_time_but_no_picture(story, monkeypatch, tmp_path, temporary_folder):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_DIRS", str(tmp_path))
    monkeypatch.setenv("EGL_PLATFORM", "none")
    monkeypatch.setenv("LIBGL_DRIVERS_PATH", str(tmp_path))
    assert renderer_name() == "TinyRenderer"
    listener = Listener()
    parameters = apply_settings(story.parameters, {"evidence.films": False})
    with WorkerPool(2) as pool:
        drawn = render_evidence(
            story.surface, None, parameters, story.containability, None, None, pool, listener
        )
    assert drawn.renderer == "TinyRenderer"
    assert left_in(temporary_folder) == []
    assert len(listener.warnings) == 1
    blue, orange = count_blue_and_orange(picture(drawn, "drop_6_end.png")[:440])
    assert blue > 300
    assert orange > 100


def test_the_renderer_is_named_for_the_doctor():
    assert renderer_name().startswith(("EGL", "TinyRenderer"))


def test_the_six_moments_are_in_order(story):
    moments = list(still_moments(story.containability.recording, story.parameters).values())
    assert moments == sorted(moments)
    assert moments[0] == 0


def test_slow_motion_is_drawn_less_often(story):
    recording = story.containability.recording
    moments = film_moments(recording, 24, calm_from_s=0.5)
    assert moments[:12] == list(range(12))
    assert moments[12:18] == [12, 12, 14, 14, 16, 16]
    assert moments[-1] == len(recording.time_s) - 1
    assert film_moments(recording, 24, calm_from_s=float("inf"))[:37] == list(range(37))


def test_ffmpeg_says_what_it_disliked(tmp_path):
    odd = [np.zeros((31, 33, 3), dtype=np.uint8)] * 3
    with pytest.raises(StageError, match="films=false"):
        encode(tmp_path, odd, (33, 31), 24)
    assert list(tmp_path.iterdir()) == []


def test_a_failing_picture_ends_ffmpeg(tmp_path):
    def pictures():
        yield np.zeros((32, 32, 3), dtype=np.uint8)
        raise StageError("no picture")

    with pytest.raises(StageError, match="no picture"):
        encode(tmp_path, pictures(), (32, 32), 24)
    assert list(tmp_path.iterdir()) == []
