"""Draw the learning curves that `train` kept.

Usage: python -m training.appearance.curves CURVES.csv OUT.png
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

_SIZE_IN, _DPI = (7.2, 2.8), 110


def draw(curves: Path, out: Path) -> None:
    """Draw losses to the left, and what is right of the held-out members to the right."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    with curves.open(newline="") as file:
        rows = list(csv.DictReader(file))
    epochs = [int(row["epoch"]) for row in rows]
    figure, (left, right) = plt.subplots(1, 2, figsize=_SIZE_IN, layout="constrained")
    for axes, names in (
        (left, ("loss", "held_out_loss")),
        (right, ("held_out_accuracy", "held_out_auc", "held_out_map_overlap")),
    ):
        for name in names:
            axes.plot(epochs, [float(row[name]) for row in rows], marker="o", label=name.replace("_", " "))
        axes.set_xlabel("epoch")
        axes.set_xticks(epochs)
        axes.grid(alpha=0.3)
        axes.legend()
    right.set_ylim(0, 1)
    left.set_ylim(bottom=0)
    out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(out, dpi=_DPI)


if __name__ == "__main__":
    draw(Path(sys.argv[1]), Path(sys.argv[2]))
