# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of 8 bits as NumPy arrays, and the curves between codes and light."""
import numpy as np
from PIL import Image


def read(path):
    """Codes from 0 to 1."""
    with Image.open(path) as picture:
        if picture.mode not in ("L", "RGB"):
            raise ValueError(f"{path}: {picture.mode} is not 8 bits of grey or colour")
        return np.asarray(picture, float) / 255


def write(path, codes, quality=None):
    """PNG, or JPEG of a quality without colour subsampling; codes beyond 0 to 1 are clipped."""
    picture = Image.fromarray(np.rint(255 * np.clip(codes, 0, 1)).astype(np.uint8))
    if quality is None:
        picture.save(path)
    else:
        picture.save(path, quality=quality, subsampling=0)


def srgb_light(codes):
    return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def srgb_codes(light):
    light = np.clip(light, 0, None)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def dithered(codes, seed):
    """Spread evenly over the interval of light that a code stands for: codes that were rounded once do not show twice."""
    return codes + (np.random.default_rng(seed).random(codes.shape) - 0.5) / 255
