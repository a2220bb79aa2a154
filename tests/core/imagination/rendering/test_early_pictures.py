"""Pictures that can be looked at before the others are done."""

from __future__ import annotations

from core.imagination.rendering.evidence import show_early
from core.imagination.rendering.render import render_evidence
from core.parameters import apply_settings
from core.progress import Reporter
from core.workers import WorkerPool


class Watcher(Reporter):
    """Counts the pictures in a folder whenever there is progress."""

    def __init__(self, folder):
        super().__init__()
        self._folder = folder
        self.counts = []

    def progress(self, stage, done, total):
        self.counts.append(len(list(self._folder.glob("*.png"))))


def test_stills_come_one_by_one_and_are_those_of_the_evidence(story, tmp_path):
    parameters = apply_settings(story.parameters, {"evidence.films": False})
    watcher = Watcher(tmp_path)
    with WorkerPool(1) as pool:
        evidence = render_evidence(
            story.surface, None, parameters, story.containability, None, None, pool, watcher, tmp_path
        )
    early = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert early == evidence.files
    assert watcher.counts[-1] == 6
    assert any(0 < count < 6 for count in watcher.counts)


def test_a_picture_is_there_whole_or_not_at_all(tmp_path):
    show_early(tmp_path, "one.png", b"picture")
    assert [path.name for path in tmp_path.iterdir()] == ["one.png"]
    show_early(None, "one.png", b"nobody waits")
