"""Six pictures of the drop."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.imagination.recording import Recording
from core.imagination.rendering.drop_view import open_drop, phase
from core.imagination.rendering.evidence import Evidence, show_early
from core.imagination.rendering.labels import BAR_PX, to_png, with_caption
from core.imagination.rendering.scene import Picture
from core.imagination.results import Containability
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.workers import report_fraction

_SUPERSAMPLING = 2


def render_drop_stills(
    folder: Path,
    surface: TriangleMesh,
    containability: Containability,
    parameters: Parameters,
    size_px: tuple[int, int],
    with_egl: bool,
    early: Path | None = None,
) -> Evidence:
    """Return PNGs (width, height `size_px`) named `drop_1_start.png` to `drop_6_end.png`.

    Call it in a worker; `folder` takes temporary files, `early` each picture as soon as it is drawn.
    """
    width, height = size_px[0], size_px[1] - BAR_PX
    moments = still_moments(containability.recording, parameters)
    files = {}
    with open_drop(folder, surface, containability, parameters, width / height, with_egl) as view:
        for index, (name, moment) in enumerate(moments.items()):
            report_fraction(index / len(moments))
            large = view.shoot(moment, _SUPERSAMPLING * width, _SUPERSAMPLING * height)
            time_s = float(containability.recording.time_s[moment])
            caption = f"{time_s:.2f} s   {_words(name, time_s, containability, parameters)}"
            file = f"drop_{index + 1}_{name}.png"
            files[file] = to_png(with_caption(reduced(large), caption))
            show_early(early, file, files[file])
        return Evidence(files, view.scene.renderer)


def still_moments(recording: Recording, parameters: Parameters) -> dict[str, int]:
    """Pick the recorded moment of each still."""
    settings = parameters.containability
    settled_s = settings.drop_s
    pushes_s = settled_s + 2 * settings.rotation_s
    times_s = {
        "start": 0.0,
        "falling": _mostly_fallen_s(recording, settled_s),
        "settled": settled_s,
        "rotated": settled_s + settings.rotation_s / 4,
        "pushed": pushes_s + 0.9 * settings.translation_s,
        "end": float(recording.time_s[-1]),
    }
    return {name: int(np.abs(recording.time_s - time_s).argmin()) for name, time_s in times_s.items()}


def reduced(picture: Picture) -> Picture:
    """Halve a picture, which smooths its edges."""
    height, width = picture.shape[:2]
    blocks = picture.reshape(
        height // _SUPERSAMPLING, _SUPERSAMPLING, width // _SUPERSAMPLING, _SUPERSAMPLING, 3
    )
    smooth: Picture = (blocks.sum(axis=(1, 3), dtype=np.uint16) // _SUPERSAMPLING**2).astype(np.uint8)
    return smooth


def _mostly_fallen_s(recording: Recording, settled_s: float) -> float:
    """When the candies that stay on the object have three quarters of their fall behind them, on average."""
    until = int(np.abs(recording.time_s - settled_s).argmin())
    heights = recording.positions_m[: until + 1, :, 2]
    landed = heights[:, np.isfinite(heights[-1])]
    if landed.shape[1] == 0:
        return settled_s / 4
    mean = landed.mean(axis=1)
    return float(recording.time_s[np.abs(mean - (0.25 * mean[0] + 0.75 * mean[-1])).argmin()])


def _words(name: str, time_s: float, containability: Containability, parameters: Parameters) -> str:
    if name == "start":
        return f"start: {containability.n_drop} candies"
    if name == "settled":
        return name
    if name == "end":
        return f"end: {containability.n_in} of {containability.n_drop} kept"
    return phase(parameters.containability, time_s)
