"""A matrix product uses one processor, in the program and in what it starts (decision 0043)."""

import os
import subprocess
import sys

from core.workers import usable_processors

PRODUCT = "a = np.ones((600, 600)); a @ a; print(len(os.listdir('/proc/self/task')))"


def threads_after(imports: str, **environment: str) -> int:
    """How many threads a fresh interpreter has after a large product."""
    known = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    done = subprocess.run(
        [sys.executable, "-c", f"import os; {imports}; import numpy as np; {PRODUCT}"],
        env=known | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return int(done.stdout)


def test_the_program_multiplies_with_one_thread():
    assert threads_after("import app.cli") == 1
    assert threads_after("import app.gui.main") == threads_after(
        "import app.gui.main", OPENBLAS_NUM_THREADS="1"
    )


def test_whoever_wants_more_threads_gets_them():
    wanted = min(2, usable_processors())  # it takes no more than there are processors
    assert threads_after("import app.cli", OPENBLAS_NUM_THREADS="2") == wanted
