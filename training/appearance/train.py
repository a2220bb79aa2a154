"""Train the network on rendered examples, and keep weights, learning curves and provenance.

Usage: python -m training.appearance.train EXAMPLES.npz OUT [--epochs N] [--seed S] [--depth]
    [--leave-out KIND ...]

With --depth the network also sees nearness: for comparison, the program runs networks of colours only. With
--leave-out nothing is learnt from some kinds, and their development objects are held out instead.
"""

from __future__ import annotations

import argparse
import csv
import json
import platform
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax

from training.appearance.model import Weights, forward, initial_weights
from training.appearance.split import split

_BATCH = 16
_RATE, _DECAY = 2e-3, 1e-4
_MAP_WEIGHT, _OVERLAP_WEIGHT, _RARITY = 2.0, 1.0, 2.0
"""Of the map's losses against the score's, and of cells that contain against others. One cell in nine does:
plain cross entropy was content for six epochs with maps below one half everywhere."""
_N_CHECKED = 6
"""Views kept with the network's answers, so that the NumPy network can be held against this one."""


@dataclass(frozen=True)
class Epoch:
    """A row of the learning curves; held out are members of the same families, not learnt from."""

    epoch: int
    seconds: float
    loss: float
    held_out_loss: float
    held_out_accuracy: float
    held_out_auc: float
    held_out_map_overlap: float


@dataclass(frozen=True)
class Examples:
    """Views (N, 96, 96, 3 or 4) and maps (N, 48, 48) of 255, and whether each is of a container."""

    color: np.ndarray
    contain: np.ndarray
    is_container: np.ndarray

    def of(self, chosen: np.ndarray) -> Examples:
        """Return some of them."""
        return Examples(self.color[chosen], self.contain[chosen], self.is_container[chosen])

    def batch(self) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Return them as the loss wants them, from 0 to 1."""
        images, maps = (jnp.asarray(one, jnp.float32) / 255 for one in (self.color, self.contain))
        return images, maps, jnp.asarray(self.is_container, jnp.float32)


def losses(weights: Weights, images: jax.Array, maps: jax.Array, labels: jax.Array) -> jax.Array:
    """Return the loss: cross entropies of map and score, and what the maps of containers lack of overlap."""
    map_logits, score_logits = forward(weights, images)
    map_loss = ((1 + (_RARITY - 1) * maps) * optax.sigmoid_binary_cross_entropy(map_logits, maps)).mean()
    score_loss = optax.sigmoid_binary_cross_entropy(score_logits, labels).mean()
    return score_loss + _MAP_WEIGHT * map_loss + _OVERLAP_WEIGHT * _missed(map_logits, maps)


def _missed(map_logits: jax.Array, maps: jax.Array) -> jax.Array:
    """One minus the soft overlap of Dice, the mean over the views in which something contains."""
    found = jax.nn.sigmoid(map_logits)
    both, either = (one.sum(axis=(1, 2)) for one in (found * maps, found + maps))
    is_there = maps.sum(axis=(1, 2)) > 0
    return (is_there * (1 - 2 * both / (either + 1))).sum() / jnp.maximum(is_there.sum(), 1)


def train(
    examples: Path, out: Path, n_epochs: int, seed: int, *, sees_depth: bool, leave_out: Sequence[str] = ()
) -> None:
    """Train, writing weights and curves after each epoch."""
    with np.load(examples, allow_pickle=False) as file:
        known = {name: file[name] for name in file.files}
    images = known["color"]
    if sees_depth:
        images = np.concatenate([images, known["nearness"][..., None]], axis=-1)
    every = Examples(images, known["contain"], known["is_container"])
    learnt, held_out = map(every.of, split(known, leave_out))
    random = np.random.default_rng(seed)
    n_steps = n_epochs * (len(learnt.color) // _BATCH)
    optimizer = optax.chain(
        optax.clip_by_global_norm(1.0),
        optax.adamw(
            optax.warmup_cosine_decay_schedule(0, _RATE, n_steps // 20, n_steps), weight_decay=_DECAY
        ),
    )
    weights = initial_weights(seed, images.shape[-1])
    state = optimizer.init(weights)
    step = jax.jit(partial(_step, optimizer))
    began_s, curves = time.perf_counter(), []
    out.mkdir(parents=True, exist_ok=True)
    for epoch in range(1, n_epochs + 1):
        found = []
        for batch in _batches(learnt, random):
            weights, state, loss = step(weights, state, *batch.batch())
            found.append(float(loss))
        row = Epoch(
            epoch, round(time.perf_counter() - began_s, 1), float(np.mean(found)), *_judged(weights, held_out)
        )
        curves.append(row)
        print(row, flush=True)
        _write_weights(out / "weights.npz", weights)
        _write_curves(out / "curves.csv", curves)
    _write_check(out / "check.npz", held_out)
    facts = {
        "examples": {
            "seed": int(known["seed"]),
            "members": int(known["n_members"]),
            "views_learnt": len(learnt.color),
            "views_held_out": len(held_out.color),
            "kinds": sorted(set(known["kind"].tolist())),
        },
        "seed": seed,
        "sees_depth": sees_depth,
        "left_out": list(leave_out),
        "epochs": n_epochs,
        "batch": _BATCH,
        "rate": _RATE,
        "weight_decay": _DECAY,
        "parameters": sum(int(one.size) for one in weights.values()),
        "seconds": curves[-1].seconds,
        "versions": {
            "jax": jax.__version__,
            "optax": optax.__version__,
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
        "held_out": asdict(curves[-1]),
    }
    (out / "provenance.json").write_text(json.dumps(facts, indent=1) + "\n")


def _step(
    optimizer: optax.GradientTransformation, weights: Weights, state: Any, *batch: jax.Array
) -> tuple[Weights, Any, jax.Array]:
    loss, gradient = jax.value_and_grad(losses)(weights, *batch)
    updates, state = optimizer.update(gradient, state, weights)
    return optax.apply_updates(weights, updates), state, loss


def _batches(examples: Examples, random: np.random.Generator) -> Iterator[Examples]:
    """All examples once, in another order, mirrored, colours exchanged."""
    order = random.permutation(len(examples.color))
    for start in range(0, len(order) - _BATCH + 1, _BATCH):
        one = examples.of(order[start : start + _BATCH])
        channels = [*random.permutation(3), *range(3, one.color.shape[-1])]
        color, contain = one.color[..., channels], one.contain
        if random.random() < 0.5:
            color, contain = color[:, :, ::-1], contain[:, :, ::-1]
        yield Examples(color, contain, one.is_container)


def _judged(weights: Weights, examples: Examples) -> tuple[float, float, float, float]:
    """Return loss, accuracy at 0.5, AUC, and the overlap (IoU) of maps with those of containers."""
    found, scores, maps = [], [], []
    for start in range(0, len(examples.color), _BATCH):
        batch = examples.of(np.arange(start, min(start + _BATCH, len(examples.color)))).batch()
        map_logits, score_logits = _forward(weights, batch[0])
        found.append(float(_losses(weights, *batch)) * len(batch[0]))
        scores.append(np.asarray(score_logits))
        maps.append(np.asarray(map_logits) > 0)
    score, contain, truth = np.concatenate(scores), np.concatenate(maps), examples.contain > 127
    is_container = examples.is_container
    ranks = np.argsort(np.argsort(score)) + 1
    n, m = int(is_container.sum()), int((~is_container).sum())
    auc = (ranks[is_container].sum() - n * (n + 1) / 2) / (n * m)
    both = (contain & truth)[is_container].sum() / max((contain | truth)[is_container].sum(), 1)
    return (
        sum(found) / len(examples.color),
        float(((score > 0) == is_container).mean()),
        float(auc),
        float(both),
    )


_forward, _losses = jax.jit(forward), jax.jit(losses)


def _write_weights(path: Path, weights: Weights) -> None:
    """Keep them with half precision."""
    kept: dict[str, Any] = {name: np.asarray(one, np.float16) for name, one in weights.items()}
    np.savez(path, **kept)


def _write_curves(path: Path, curves: list[Epoch]) -> None:
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, list(asdict(curves[0])), lineterminator="\n")
        table.writeheader()
        table.writerows({key: round(value, 4) for key, value in asdict(one).items()} for one in curves)


def _write_check(path: Path, held_out: Examples) -> None:
    """Keep some views with the answers of the weights as they are kept, so with half precision."""
    with np.load(path.with_name("weights.npz"), allow_pickle=False) as file:
        kept = {name: jnp.asarray(file[name], jnp.float32) for name in file.files}
    chosen = held_out.of(np.linspace(0, len(held_out.color) - 1, _N_CHECKED).astype(int))
    map_logits, score_logits = forward(kept, chosen.batch()[0])
    np.savez_compressed(
        path,
        color=chosen.color,
        contain=np.asarray(jax.nn.sigmoid(map_logits)),
        score=np.asarray(jax.nn.sigmoid(score_logits)),
    )


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("examples", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--epochs", type=int, default=14)
    parser.add_argument("--seed", type=int, default=23)
    parser.add_argument("--depth", action="store_true")
    parser.add_argument("--leave-out", nargs="+", default=[], metavar="KIND")
    given = parser.parse_args()
    train(
        given.examples,
        given.out,
        given.epochs,
        given.seed,
        sees_depth=given.depth,
        leave_out=given.leave_out,
    )


if __name__ == "__main__":
    main()
