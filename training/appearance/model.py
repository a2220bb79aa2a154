"""The network of `core.appearance.network` in JAX, whose gradients train it."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from core.appearance.network import CHANNELS, GROUP_CHANNELS, LAYERS, NORM_EPSILON

Weights = dict[str, jax.Array]


def initial_weights(seed: int, n_inputs: int = 3) -> Weights:
    """Draw weights after He et al. 2015; norms begin as 1 and 0, the last layers small.

    Args:
        seed: of the drawing.
        n_inputs: channels of the images: 3 colours, and a fourth for the variant that sees depth.
    """
    random = np.random.default_rng(seed)
    weights: dict[str, np.ndarray] = {}
    first = LAYERS["down0"]
    for name, shape in (LAYERS | {"down0": (*first[:2], n_inputs, first[3])}).items():
        fan_in = int(np.prod(shape[:-1]))
        is_last = name in ("map", "score")
        size = 0.1 if is_last else 1.0
        weights[f"{name}.kernel"] = size * random.normal(0, np.sqrt(2 / fan_in), shape)
        weights[f"{name}.shift"] = np.zeros(shape[-1])
        if name not in ("map", "score", "hidden"):
            weights[f"{name}.scale"] = np.ones(shape[-1])
    return {name: jnp.asarray(value, jnp.float32) for name, value in weights.items()}


def forward(weights: Weights, images: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the logits of map (N, 48, 48) and score (N,) of images (N, 96, 96, 3 or 4), from 0 to 1."""
    x = images - 0.5
    skips = []
    for level in range(len(CHANNELS)):
        x = _block(weights, f"down{level}", x, stride=2)
        x = _block(weights, f"same{level}", x)
        skips.append(x)
    pooled = jnp.concatenate([x.mean(axis=(1, 2)), x.max(axis=(1, 2))], axis=-1)
    hidden = jax.nn.relu(pooled @ weights["hidden.kernel"] + weights["hidden.shift"])
    score = hidden @ weights["score.kernel"] + weights["score.shift"]
    for level in reversed(range(len(CHANNELS) - 1)):
        x = jnp.concatenate([x.repeat(2, axis=1).repeat(2, axis=2), skips[level]], axis=-1)
        x = _block(weights, f"up{level}", x)
    logits = x @ weights["map.kernel"] + weights["map.shift"]
    return logits[..., 0], score[..., 0]


def _block(weights: Weights, name: str, x: jax.Array, stride: int = 1) -> jax.Array:
    y = jax.lax.conv_general_dilated(
        x,
        weights[f"{name}.kernel"],
        (stride, stride),
        ((1, 1), (1, 1)),
        dimension_numbers=("NHWC", "HWIO", "NHWC"),
    )
    n, height, width, channels = y.shape
    groups = y.reshape(n, height * width, channels // GROUP_CHANNELS, GROUP_CHANNELS)
    mean = groups.mean(axis=(1, 3), keepdims=True)
    variance = ((groups - mean) ** 2).mean(axis=(1, 3), keepdims=True)
    normed = ((groups - mean) / jnp.sqrt(variance + NORM_EPSILON)).reshape(y.shape)
    return jax.nn.relu(normed * weights[f"{name}.scale"] + weights[f"{name}.shift"])
