"""A small U-Net with a classification head, run in plain NumPy: no library, the same bits on repeat.

It was trained by `training.appearance` on rendered views. Convolutions are 3 x 3, each followed by a group
norm (Wu and He 2018) and a ReLU; four levels down, three up, with skips (Ronneberger et al. 2015).
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from core.appearance.crops import SIZE_PX, Crop
from core.errors import InputError
from core.files import read_json
from core.resources import RESOURCES

CHANNELS = (16, 24, 32, 48)
"""Of each level, from the finest, which has half the image's resolution."""
GROUP_CHANNELS = 8
NORM_EPSILON = 1e-5
HIDDEN = 32
MAP_CELLS = SIZE_PX // 2
"""Side of the contain map."""
WEIGHTS_FILE = RESOURCES / "appearance" / "weights.npz"
PROVENANCE_FILE = WEIGHTS_FILE.with_name("provenance.json")

_Array = npt.NDArray[np.float32]


def _layers() -> dict[str, tuple[int, ...]]:
    """Shapes of all kernels by name: (3, 3, in, out), and (in, out) of what sees single cells."""
    layers: dict[str, tuple[int, ...]] = {}
    before = 3
    for level, channels in enumerate(CHANNELS):
        layers[f"down{level}"] = (3, 3, before, channels)
        layers[f"same{level}"] = (3, 3, channels, channels)
        before = channels
    for level in reversed(range(len(CHANNELS) - 1)):
        layers[f"up{level}"] = (3, 3, CHANNELS[level + 1] + CHANNELS[level], CHANNELS[level])
    return layers | {
        "hidden": (2 * CHANNELS[-1], HIDDEN),
        "score": (HIDDEN, 1),
        "map": (CHANNELS[0], 1),
    }


LAYERS = _layers()


@dataclass(frozen=True)
class Look:
    """What the network says of one view.

    Attributes:
        score: from 0 to 1: how surely the object is an open container.
        contain: (48, 48) from 0 to 1: how surely each cell of the crop shows surface that contains.
    """

    score: float
    contain: _Array


@dataclass(frozen=True, eq=False)
class Network:
    """The trained network.

    Attributes:
        weights: float32 arrays by name: `LAYER.kernel`, `LAYER.scale`, `LAYER.shift`.
    """

    weights: Mapping[str, _Array]

    @classmethod
    def load(cls, path: Path = WEIGHTS_FILE) -> Network:
        """Read weights, kept with half precision.

        Raises:
            InputError: the file is missing, damaged, or of another network.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                weights = {name: file[name].astype(np.float32) for name in file.files}
        except (OSError, ValueError, KeyError, BadZipFile) as error:
            raise InputError(
                f"The weights {path} cannot be read; make them again with 'make train-appearance'."
            ) from error
        if any(weights.get(f"{name}.kernel", np.empty(0)).shape != shape for name, shape in LAYERS.items()):
            raise InputError(
                f"The weights {path} are of another network; make them again with 'make train-appearance'."
            )
        return cls(weights)

    def look(self, crop: Crop) -> Look:
        """Look at a crop (96, 96, 3), from 0 to 1."""
        x = crop.astype(np.float32) - np.float32(0.5)
        skips = []
        for level in range(len(CHANNELS)):
            x = self._block(f"same{level}", self._block(f"down{level}", x, stride=2))
            skips.append(x)
        pooled = np.concatenate([x.mean(axis=(0, 1)), x.max(axis=(0, 1))])
        score = self._dense("score", np.maximum(self._dense("hidden", pooled), 0))
        for level in reversed(range(len(CHANNELS) - 1)):
            finer = x.repeat(2, axis=0).repeat(2, axis=1)
            x = self._block(f"up{level}", np.concatenate([finer, skips[level]], axis=-1))
        return Look(float(_sigmoid(score)[0]), _sigmoid(self._dense("map", x))[..., 0])

    def _dense(self, name: str, x: _Array) -> _Array:
        answer: _Array = x @ self.weights[f"{name}.kernel"] + self.weights[f"{name}.shift"]
        return answer

    def _block(self, name: str, x: _Array, stride: int = 1) -> _Array:
        y = _convolved(x, self.weights[f"{name}.kernel"], stride)
        groups = y.reshape(-1, y.shape[-1] // GROUP_CHANNELS, GROUP_CHANNELS)
        mean = groups.mean(axis=(0, 2), keepdims=True)
        variance = groups.var(axis=(0, 2), keepdims=True)
        normed = ((groups - mean) / np.sqrt(variance + np.float32(NORM_EPSILON))).reshape(y.shape)
        active: _Array = np.maximum(normed * self.weights[f"{name}.scale"] + self.weights[f"{name}.shift"], 0)
        return active


def _convolved(x: _Array, kernel: _Array, stride: int) -> _Array:
    """Correlate (H, W, C) with a kernel (3, 3, C, D), a border of zeros around: one matrix product."""
    windows = np.lib.stride_tricks.sliding_window_view(
        np.pad(x, ((1, 1), (1, 1), (0, 0))), kernel.shape[:2], axis=(0, 1)
    )[::stride, ::stride]
    columns = windows.transpose(0, 1, 3, 4, 2).reshape(-1, int(np.prod(kernel.shape[:3])))
    answer: _Array = columns @ kernel.reshape(-1, kernel.shape[-1])
    image: _Array = answer.reshape(*windows.shape[:2], -1)
    return image


def _sigmoid(x: _Array) -> _Array:
    share: _Array = np.float32(0.5) * (np.float32(1) + np.tanh(np.float32(0.5) * x))
    return share


@lru_cache(maxsize=1)
def shipped_network() -> Network:
    """Return the network that the program ships.

    Raises:
        InputError: its weights cannot be used.
    """
    return Network.load()


def held_out_accuracy() -> float:
    """Return the share of views of objects held out of its families that the shipped network judges rightly.

    Raises:
        SessionError: what its training wrote down cannot be read.
    """
    return float(read_json(PROVENANCE_FILE)["held_out"]["held_out_accuracy"])


def weights_digest(path: Path = WEIGHTS_FILE) -> str:
    """Return what distinguishes these weights from others.

    Raises:
        InputError: they cannot be read.
    """
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    except OSError as error:
        raise InputError(f"The weights {path} cannot be read ({error.strerror}).") from error
