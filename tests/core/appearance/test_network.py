from time import process_time

import numpy as np
import pytest

from core.appearance.network import LAYERS, MAP_CELLS, WEIGHTS_FILE, Network, shipped_network
from core.errors import InputError
from tests.awake import in_time
from tests.core.appearance.looks import drawn_network

CHECK_FILE = WEIGHTS_FILE.with_name("check.npz")


def crop(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((96, 96, 3), dtype=np.float32)


def direct(x: np.ndarray, kernel: np.ndarray, stride: int) -> np.ndarray:
    """A convolution by its definition."""
    padded = np.pad(x.astype(float), ((1, 1), (1, 1), (0, 0)))
    rows, columns = (range(0, size, stride) for size in x.shape[:2])
    return np.array(
        [[np.einsum("ijc,ijcd->d", padded[r : r + 3, c : c + 3], kernel) for c in columns] for r in rows]
    )


@pytest.mark.parametrize("stride", [1, 2])
def test_a_convolution_is_what_its_definition_says(stride):
    from core.appearance.network import _convolved

    random = np.random.default_rng(1)
    x = random.normal(size=(8, 6, 5)).astype(np.float32)
    kernel = random.normal(size=(3, 3, 5, 4)).astype(np.float32)
    assert _convolved(x, kernel, stride) == pytest.approx(direct(x, kernel, stride), abs=1e-4)


def test_the_same_crop_gives_the_same_bits():
    network = drawn_network()
    first, again = network.look(crop(0)), network.look(crop(0).copy())
    assert first.score == again.score
    assert first.contain.tobytes() == again.contain.tobytes()
    assert first.contain.shape == (MAP_CELLS, MAP_CELLS)
    assert network.look(crop(1)).score != first.score


def test_the_shipped_network_is_the_one_that_was_trained():
    """`check.npz` holds held-out views and what JAX, which trained it, says of them with the kept weights."""
    with np.load(CHECK_FILE, allow_pickle=False) as known:
        for color, contain, score in zip(known["color"], known["contain"], known["score"], strict=True):
            look = shipped_network().look(color.astype(np.float32) / 255)
            assert look.score == pytest.approx(float(score), abs=2e-3)
            assert np.abs(look.contain - contain).max() < 5e-3


def test_the_weights_are_small_and_a_view_costs_little():
    assert WEIGHTS_FILE.stat().st_size < 2e6
    network = shipped_network()
    network.look(crop(0))
    began_s = process_time()
    for seed in range(5):
        network.look(crop(seed))
    in_time(process_time() - began_s, 5 * 0.5, "processor time of five views")


def test_what_is_no_network_is_refused_in_a_sentence(tmp_path):
    path = tmp_path / "weights.npz"
    with pytest.raises(InputError, match=r"cannot be read; make them again with 'make train-appearance'"):
        Network.load(path)
    path.write_bytes(b"PK\x03\x04 no archive")
    with pytest.raises(InputError, match="cannot be read"):
        Network.load(path)
    np.savez(path, **{f"{name}.kernel": np.zeros(shape)[..., :-1] for name, shape in LAYERS.items()})
    with pytest.raises(InputError, match="of another network"):
        Network.load(path)
