"""Random faults at random times of a pour, through the real driver: `make pour-faults`.

After each fault: the time until the arm is at rest, what was raised, whether anything continued by itself,
and whether it recovered and backed off. Every tenth time a whole pour follows.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from core.session.pour_runs import PourRun
from tests.hardware.pouring.rig import Rig, driver_pid

LINES = {
    "protective stop": (),
    "emergency stop": ("emergency release",),
    "program stop": (),
    "program pause": (),
    "power off": (),
    "link drop": (),
    "link silent": ("link restore",),
    "stick 1 2 3 4 5 6": ("unstick",),
    "driver killed": (),
    "driver frozen": (),
}
SIGNALS = {"driver killed": signal.SIGKILL, "driver frozen": signal.SIGSTOP}
WHOLE_POUR_EVERY = 10


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--speed-up", type=float, default=4.0)
    args = parser.parse_args()
    chance = random.Random(args.seed)
    rest_s: list[float] = []
    kinds: Counter[str] = Counter()
    failures: list[str] = []
    with tempfile.TemporaryDirectory() as folder, Rig(Path(folder), args.speed_up) as rig:
        for k in range(args.number):
            fault = chance.choice(list(LINES))
            try:
                rested, kind = one_fault(rig, fault, chance.random(), k % WHOLE_POUR_EVERY == 0)
            except Exception as error:
                failures.append(f"{k}: {fault}: {error!r}")
                print(failures[-1], flush=True)
                break
            rest_s.append(rested)
            kinds[f"{fault} -> {kind}"] += 1
            print(f"{k}: {fault}: at rest after {rested:.3f} s, {kind}", flush=True)
    print(f"\n{len(rest_s)} faults, {len(failures)} failures; the arm was at rest within {max(rest_s):.3f} s")
    print(f"(median {np.median(rest_s):.3f} s, {sum(s > 0.5 for s in rest_s)} over 0.5 s)")
    for name, number in sorted(kinds.items()):
        print(f"  {number:4d}  {name}")


def one_fault(rig: Rig, fault: str, share: float, is_whole_pour_after: bool) -> tuple[float, str]:
    """Return the time until the arm was at rest, and the kind of error."""
    thread = rig.pour_in_background()
    time.sleep(share * thread.fresh.plan.duration_s / rig.speed_up)
    if fault in SIGNALS:
        os.kill(driver_pid(), SIGNALS[fault])
    else:
        rig.controller.command(fault)
    rested_s = rig.seconds_to_rest()
    thread.join(20)
    assert not thread.is_alive(), "the pour neither ended nor raised"
    before = rig.joints_rad
    for line in LINES[fault]:
        rig.controller.command(line)
    time.sleep(0.2)
    assert not rig.is_moving and np.abs(rig.joints_rad - before).max() < 1e-4, "it continued by itself"
    run = PourRun.load(rig.pouring.last_run)
    assert run.is_done or run.events[-1]["kind"] == "stopped", "the session does not record what happened"
    rig.pouring.recover()
    if rig.pouring.is_interrupted:
        rig.pouring.back_off(rig.pouring.plan_back_off())
    assert rig.is_home
    if is_whole_pour_after:
        assert PourRun.load(rig.pouring.carry_out(rig.pouring.plan())).is_done
    return rested_s, type(thread.error).__name__


if __name__ == "__main__":
    main()
