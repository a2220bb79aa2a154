"""How a view looks: colours, textures, light and the camera's faults, drawn at random."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from core.geometry import AnyArray, FloatArray
from hardware.simulation.depth_camera import shade
from hardware.simulation.world import Hits

Texture = Callable[[FloatArray], FloatArray]
"""Takes points (..., 3) in metres to colours (..., 3) from 0 to 1."""
PLAIN_SHARE = 0.25
"""So many views are painted as the simulated camera paints: the program meets it as well."""


@dataclass(frozen=True)
class Light:
    """Where light comes from, and how much.

    Attributes:
        lamp_m: (3,) where the lamp is.
        ambient, headlight, lamp: shares of the light.
        tint: (3,) its colour.
        gloss: how bright the object's reflection of the lamp is.
        sharpness: exponent of that reflection (Phong).
    """

    lamp_m: FloatArray
    ambient: float
    headlight: float
    lamp: float
    tint: FloatArray
    gloss: float
    sharpness: float


@dataclass(frozen=True)
class Scene:
    """What surrounds a view of an object; none of it tells what the object is."""

    light: Light
    of_object: Texture
    of_table: Texture
    background: FloatArray

    def paint(self, hits: Hits, unit_rays: FloatArray, in_shadow: AnyArray) -> FloatArray:
        """Return the image (H, W, 3), from 0 to 1, of what rays met."""
        light = self.light
        facing = np.einsum("hwk,hwk->hw", hits.normals, unit_rays)
        normals = -np.sign(facing)[..., None] * hits.normals
        to_lamp = light.lamp_m - hits.points_m
        to_lamp /= np.linalg.norm(to_lamp, axis=-1, keepdims=True)
        falls = np.einsum("hwk,hwk->hw", normals, to_lamp)
        lit = falls.clip(0, 1) * ~in_shadow
        mirrored = 2 * falls[..., None] * normals - to_lamp
        glint = (-np.einsum("hwk,hwk->hw", mirrored, unit_rays)).clip(0, 1) ** light.sharpness
        glint *= light.gloss * (lit > 0) * hits.on_object
        shares = light.ambient + light.headlight * np.abs(facing) + light.lamp * lit
        albedo = np.where(
            hits.on_object[..., None], self.of_object(hits.points_m), self.of_table(hits.points_m)
        )
        image = (albedo * shares[..., None] + glint[..., None]) * light.tint
        image[~np.isfinite(hits.distance)] = self.background
        shown: FloatArray = image.clip(0, 1)
        return shown


def drawn_scene(random: np.random.Generator, table_center_m: FloatArray) -> Scene:
    """Draw light, textures and background."""
    side = random.uniform(-1.2, 1.2, 2)
    return Scene(
        Light(
            table_center_m + np.array([*side, random.uniform(0.8, 2.0)]),
            random.uniform(0.12, 0.4),
            random.uniform(0.0, 0.4),
            random.uniform(0.2, 0.7),
            random.uniform(0.85, 1.0, 3),
            random.choice([0.0, random.uniform(0, 0.6)]),
            random.uniform(8, 60),
        ),
        _drawn_texture(random, 0.02),
        _drawn_texture(random, 0.08),
        random.uniform(0, 1, 3),
    )


def painted(
    random: np.random.Generator,
    hits: Hits,
    unit_rays: FloatArray,
    table_center_m: FloatArray,
    shadow: _Shadow,
) -> FloatArray:
    """Return a view (H, W, 3), from 0 to 1: of the simulated camera's own painting or of a drawn scene."""
    if random.random() < PLAIN_SHARE:
        lamp_m = table_center_m + np.array([0.7, -0.5, 1.6])
        return shade(hits, unit_rays, lamp_m - hits.points_m, shadow(lamp_m)).astype(float) / 255
    scene = drawn_scene(random, table_center_m)
    return scene.paint(hits, unit_rays, shadow(scene.light.lamp_m))


_Shadow = Callable[[FloatArray], AnyArray]
"""Takes a lamp (3,) to where (H, W) its light is blocked."""


def with_faults(random: np.random.Generator, image: FloatArray) -> FloatArray:
    """Return an image (H, W, 3) with blur, another exposure and noise, from 0 to 1."""
    from scipy.ndimage import gaussian_filter

    blur_px = random.choice([0.0, random.uniform(0.2, 1.2)])
    blurred = gaussian_filter(image, (blur_px, blur_px, 0)) if blur_px else image
    exposed = blurred * random.uniform(0.8, 1.2) + random.uniform(-0.05, 0.05)
    noisy = exposed + random.normal(0, random.uniform(0, 0.03), image.shape)
    shown: FloatArray = noisy.clip(0, 1)
    return shown


def _drawn_texture(random: np.random.Generator, period_m: float) -> Texture:
    """Draw one colour, or two in stripes, checks, clouds; periods are about `period_m`."""
    first = random.uniform(0.05, 1.0, 3)
    second = (
        np.clip(first * random.uniform(0.5, 1.6), 0, 1) if random.random() < 0.6 else random.uniform(0, 1, 3)
    )
    kind = random.choice(["plain", "plain", "stripes", "checks", "clouds"])
    if kind == "plain":
        return lambda points_m: np.broadcast_to(first, points_m.shape)
    period = period_m * float(np.exp(random.uniform(-0.7, 0.7)))
    axes = np.linalg.qr(random.normal(size=(3, 3)))[0] / period
    phases = random.uniform(0, 2 * np.pi, 3)

    def share(points_m: FloatArray) -> FloatArray:
        waves: FloatArray = np.sin(2 * np.pi * points_m @ axes.T + phases)
        if kind == "stripes":
            return (waves[..., 0] > 0).astype(float)
        if kind == "checks":
            return (waves[..., 0] * waves[..., 1] > 0).astype(float)
        clouds: FloatArray = 0.5 + waves.sum(axis=-1) / 6
        return clouds

    return lambda points_m: first + share(points_m)[..., None] * (second - first)
