"""Which renderer this machine has, found out where a broken graphics driver does no harm."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile

from core.imagination.rendering.scene import EGL, TINY

_LONGEST_S = 30.0
_DEVICE = re.compile(rb"GL_RENDERER=(.+)")


def renderer_name() -> str:
    """Say what draws the pictures here, such as `EGL, llvmpipe (LLVM 15.0.6, 256 bits)` or `TinyRenderer`.

    Asked in a process of its own, which may crash or hang.
    """
    try:
        # The folder is made here, because the other process may not live to remove it.
        with tempfile.TemporaryDirectory(prefix="poursight-") as folder:
            probe = subprocess.run(
                [sys.executable, "-m", "core.imagination.rendering.probe", folder],
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
