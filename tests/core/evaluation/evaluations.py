"""Evaluations that were never run: objects with known Omega or capacity, pours and pictures."""

from __future__ import annotations

import re
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from core.evaluation.comparing import default_parameters
from core.evaluation.evaluation import PICTURES_FOLDER, EvaluatedObject, Evaluation
from core.evaluation.labels import Label
from core.evaluation.trials import Trial

N_DROP, N_POURS, N_POUR = 200, 3, 60


def trial(name: str, label: Label, n_in: int | None, **facts: object) -> Trial:
    """A trial with a threshold of 0.05: N_in of 200, or failed; poured into without a spill."""
    values: dict[str, object] = {
        "seed": 0,
        "variant": "imagination",
        "threshold": 0.05,
        "n_pour": N_POUR,
        "seconds": {"scan": 4.0, "containability": 1.0},
    }
    if n_in is None:
        values["problem"] = "The mesh cannot be read."
    else:
        values |= {"n_drop": N_DROP, "n_in": n_in}
        if n_in / N_DROP > 0.05 and "spilled" not in facts:
            values |= {"spilled": (0,) * N_POURS, "in_cup": (0,) * N_POURS}
    return Trial(name, label, **{**values, **facts})  # type: ignore[arg-type]


def held(name: str, label: Label, share: float, **facts: object) -> Trial:
    """The same judged by its capacity, a share of a convex hull of 400 ml, with a threshold of 0.1."""
    values: dict[str, object] = {
        "threshold": 0.1,
        "capacity_share": share,
        "capacity_candies": 360 * share,
        "capacity_ml": 400 * share,
        "holds_rad": radians(42) if share else 0.0,
        "spilled": (0,) * N_POURS if share > 0.1 else (),
        "in_cup": (0,) * N_POURS if share > 0.1 else (),
    }
    return replace(trial(name, label, 0), **{**values, **facts})  # type: ignore[arg-type]


def two_measures(**facts: object) -> Evaluation:
    """Four objects judged by what they hold, the tray wrongly, and by Omega, the can wrongly."""
    return evaluation_of(
        held("mug", "container", 0.51, p_chosen=0.98, clean_at_least=0.812, n_tries=48),
        held("tray", "container", 0.08),
        held("can", "non-container", 0.02),
        held("ball", "non-container", 0.0),
        trial("mug", "container", 80, variant="omega"),
        trial("tray", "container", 20, variant="omega"),
        trial("can", "non-container", 24, variant="omega", spilled=(9, 9, 9), in_cup=(0, 0, 0)),
        trial("ball", "non-container", 0, variant="omega"),
        **facts,
    )


def evaluation_of(*trials: Trial, **facts: object) -> Evaluation:
    """An evaluation of these trials, whose objects, seeds and variants it takes from them."""
    labels = {one.name: one.label for one in trials}
    values: dict[str, object] = {
        "objects": tuple(EvaluatedObject(name, label) for name, label in labels.items()),
        "source": "scan",
        "seeds": tuple(sorted({one.seed for one in trials})),
        "variants": tuple(dict.fromkeys(one.variant for one in trials)),
        "n_pours": N_POURS,
        "preset": "default",
        "parameters": default_parameters(),
        "versions": {"poursight": "0.1.0", "pybullet": "3.2.7"},
        "seconds": 90.0,
        "workers": 2,
        "trials": trials,
    }
    return Evaluation(**{**values, **facts})  # type: ignore[arg-type]


def small_evaluation(**facts: object) -> Evaluation:
    """Ten labelled objects of one seed: one container and one other misjudged, one spilled, one failed."""
    return evaluation_of(
        trial("mug", "container", 80, p_chosen=1.0, choice=(2, 1)),
        trial("bowl", "container", 120, spilled=(0, 2, 0), in_cup=(0, 0, 1), p_chosen=0.98, choice=(0, 0)),
        trial("vase", "container", 60),
        trial("tray", "container", 8),
        trial("bucket", "container", None),
        trial("can", "non-container", 24, spilled=(50, 60, 58), in_cup=(0, 0, 0)),
        trial("ball", "non-container", 0),
        trial("brick", "non-container", 0),
        trial("spoon", "non-container", 2),
        trial("hammer", "non-container", 8),
        trial("tissue <box>", "ambiguous", 90),
        **facts,
    )


def large_evaluation(
    folder: Path, n_seeds: int = 5, n_variants: int = 5, seed: int = 1, with_pictures: bool = True
) -> Evaluation:
    """45 objects like the real ones, drawn at random, with pictures in the folder."""
    rng = np.random.default_rng(seed)
    labels: list[Label] = ["container"] * 19 + ["non-container"] * 22 + ["ambiguous"] * 4
    objects = tuple(
        EvaluatedObject(
            f"{label[:3]}_object_{k:02d}",
            label,
            ["mug", "tool", "fruit", "baking tin"][k % 4],
            is_restricted=k % 3 == 0,
            is_calibration=k % 4 == 0,
            n_container=int(rng.integers(3, 6)) if label == "container" else int(rng.integers(0, 3)),
            n_asked=5,
        )
        for k, label in enumerate(labels)
    )
    means = {one.name: _mean_share(one.label, rng) for one in objects}
    variants = ("imagination", "fixed-theta", "convex-parts", "no-perturbation", "threshold-0")[:n_variants]
    trials = [
        _random_trial(one, means[one.name], number, variant, rng)
        for variant in variants
        for one in objects
        for number in range(n_seeds)
    ]
    for one in trials:
        if with_pictures and one.picture and one.variant == variants[0]:
            draw_picture(folder / PICTURES_FOLDER / one.picture, one)
    parameters = default_parameters() | {"reconstruction.voxel_m": 0.0031}
    return replace(
        evaluation_of(*trials, parameters=parameters, seconds=4321.0),
        objects=objects,
        versions={"poursight": "0.1.0", "numpy": "2.4.6", "pybullet": "3.2.7", "open3d": "0.20.0"},
    )


def titles_of(chart: str) -> list[str]:
    """The tooltips of a chart."""
    return re.findall("<title>(.*?)</title>", chart)


def draw_picture(path: Path, one: Trial) -> None:
    """A picture of a size and detail like those of a trial."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(one.n_in)
    image = Image.new("RGB", (320, 240), (242, 243, 239))
    draw = ImageDraw.Draw(image)
    for _ in range(1500):
        x, y = rng.normal((160, 120), (40, 30))
        tone = int(120 + 100 * rng.random())
        draw.polygon([(x, y), (x + 6, y + 2), (x + 3, y + 7)], fill=(tone, tone - 8, tone - 22))
    for _ in range(one.n_in // 4):
        x, y = rng.normal((160, 110), (25, 12))
        draw.ellipse((x, y, x + 7, y + 5), fill=(46, 125, 80), outline=(20, 66, 40))
    image.save(path)


def _mean_share(label: Label, rng: np.random.Generator) -> float:
    if label == "non-container":
        return float(rng.choice([0, 0, 0, 0, 0.002, 0.01, 0.03, 0.06]))
    return float(rng.uniform(0.1, 0.6)) if label == "container" else float(rng.uniform(0, 0.3))


def _random_trial(
    one: EvaluatedObject, mean: float, seed: int, variant: str, rng: np.random.Generator
) -> Trial:
    threshold = 0.0 if variant == "threshold-0" else 0.05
    n_in = int(rng.binomial(308, mean))
    facts: dict[str, object] = {}
    if rng.random() < 0.004:
        n_in_or_none = None
        facts["problem"] = "The scan sees no surface above the platform; place the object in the crop box."
    else:
        n_in_or_none = n_in
        facts |= {"n_drop": 308, "picture": f"{one.name}.{seed}.{variant}.png"}
        if n_in / 308 > threshold:
            spilled = tuple(int(k) for k in rng.poisson(0.02 if one.label == "container" else 40, N_POURS))
            facts |= {"spilled": spilled, "in_cup": (0,) * N_POURS, "p_chosen": 0.99, "choice": (1, 1)}
            facts["seconds"] = {
                "mesh": 0.02,
                "scan": float(rng.uniform(4, 7)),
                "collision": 0.4,
                "containability": float(rng.uniform(0.5, 3)),
                "pouring": float(rng.uniform(3, 9)),
                "outcome": float(rng.uniform(2, 4)),
            }
    return trial(
        one.name,
        one.label,
        n_in_or_none,
        **{"spilled": (), **facts, "seed": seed, "variant": variant, "threshold": threshold},
    )
