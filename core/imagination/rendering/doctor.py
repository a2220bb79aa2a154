"""Which renderer this machine has, found out in a process of its own, which a broken graphics driver may end.

Run as a program with a folder for temporary files, it takes a picture and prints the renderer's name last.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from core.imagination.rendering.camera import aabb_corners, frame
from core.imagination.rendering.scene import EGL, TINY, Scene
from core.scratch import ScratchFolder

_LONGEST_S = 30.0
_DEVICE = re.compile(rb"GL_RENDERER=(.+)")


def renderer_name() -> str:
    """Return what draws the pictures here, such as `EGL, llvmpipe (LLVM 15.0.6, 256 bits)` or `TinyRenderer`.

    The process that finds it out may crash or hang.
    """
    try:
        # The folder is made here, because the other process may not live to remove it.
        with ScratchFolder() as folder:
            probe = subprocess.run(
                [sys.executable, "-m", "core.imagination.rendering.doctor", str(folder)],
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                timeout=_LONGEST_S,
                check=False,
            )
    except (OSError, subprocess.TimeoutExpired):
        return TINY
    if probe.returncode != 0 or EGL.encode() not in probe.stdout.splitlines()[-1:]:
        return TINY
    device = _DEVICE.search(probe.stdout)
    return f"{EGL}, {device[1].decode(errors='replace').strip()}" if device else EGL


def main(folder: Path) -> None:
    """Take a picture and print what drew it; with a broken driver the process ends here."""
    aabb_m = np.array([[0.0, 0.0, 0.0], [0.1, 0.1, 0.1]])
    with Scene(folder, aabb_m, with_egl=True) as scene:
        scene.add_ground(0.0)
        scene.photograph(frame(aabb_corners(*aabb_m), scene.forward, 1.0), 64, 64)
        renderer = scene.renderer
    print("\n" + renderer, flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
