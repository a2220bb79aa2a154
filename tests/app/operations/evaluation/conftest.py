import os
import subprocess
import sys
from contextlib import contextmanager

import pytest


@contextmanager
def running_cluster(workers):
    """`poursight cluster` as people start it: yields the process and the scheduler's address."""
    words = [sys.executable, "-m", "app.cli", "cluster", "--workers", str(workers), "--port", "0"]
    process = subprocess.Popen(
        words,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        start_new_session=True,
    )
    try:
        process.stdout.readline()
        command = process.stdout.readline().split()
        yield process, command[-1]
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="session")
def cluster_address():
    """A scheduler with two workers."""
    with running_cluster(2) as (_, address):
        yield address
