"""A small scan to be written and then spoiled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.geometry import look_at
from core.progress import Reporter
from core.scan import Intrinsics, RgbdFrame, Scan, write_scan

HEIGHT, WIDTH = 12, 16


class Listener(Reporter):
    """Keeps what it is told."""

    def __init__(self) -> None:
        super().__init__()
        self.warnings: list[str] = []
        self.steps: list[tuple[str, float, float]] = []

    def warn(self, sentence: str) -> None:
        self.warnings.append(sentence)

    def progress(self, stage: str, done: float, total: float) -> None:
        self.steps.append((stage, done, total))


@pytest.fixture
def listener() -> Listener:
    return Listener()


@pytest.fixture
def small_scan() -> Scan:
    random = np.random.default_rng(0)
    frames = tuple(
        RgbdFrame(
            name=f"frame-{index:06d}",
            color=random.integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8),
            depth_m=(random.integers(350, 2000, (HEIGHT, WIDTH)) / 1000).astype(np.float32),
            T_base_camera=look_at([0.5 * np.cos(index), 0.5 * np.sin(index), 0.6], [0.0, 0.0, 0.1]),
        )
        for index in range(4)
    )
    return Scan(frames, Intrinsics(13.1, 13.2, 7.9, 6.1), platform_height_m=0.0815)


@pytest.fixture
def folder(small_scan: Scan, tmp_path: Path) -> Path:
    """A folder with the small scan in the authors' layout."""
    write_scan(small_scan, tmp_path)
    return tmp_path
