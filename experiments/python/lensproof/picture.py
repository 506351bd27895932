"""Rendered pictures as arrays."""
from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from typing import Dict, Optional

import numpy as np

from ._command import native
from .errors import InputError


@dataclass(frozen=True)
class Picture:
    """A render's numbers, those of its EXR: rows from the top, 32-bit floats."""

    rgb: np.ndarray  # height × width × 3, linear, 1 = saturation
    variance: Optional[np.ndarray] = None  # of the three
    spectral: Optional[np.ndarray] = None  # height × width × layers: film irradiance, W·m⁻²·nm⁻¹
    spectral_nm: Optional[np.ndarray] = None  # the layers' wavelengths
    samples: Optional[np.ndarray] = None  # how many each pixel has had
    features: Dict[str, np.ndarray] = field(default_factory=dict)  # "Z" (mm), "albedo.R", …, with features=True
    passes: Dict[str, "Picture"] = field(default_factory=dict)  # each class of light by itself, with passes=…
    metadata: Dict[str, str] = field(default_factory=dict)

    @classmethod
    def load(cls, file) -> "Picture":
        """An EXR that `render` or `merge` wrote."""
        file = os.fspath(file)
        parts = {}
        metadata = {}
        for index, (name, channels, width, height, is_whole, attributes) in enumerate(native().exr_parts(file)):
            numbers = np.empty(height * width * len(channels), np.uint32)
            native().read_exr_part(file, index, numbers)
            array = numbers if is_whole else numbers.view(np.float32)
            parts[name] = (channels, array.reshape(height, width, len(channels)))
            if index == 0:
                metadata = attributes
        if "rgb" not in parts:
            raise InputError(f'{file}: has no part "rgb", expected a picture that lensproof rendered')
        names = [name for name in metadata.get("lensproof:passes", "").split(",") if name]
        passes = {name: cls._of(parts, name + ".", {}, {}) for name in names}
        return cls._of(parts, "", passes, metadata)

    @classmethod
    def _of(cls, parts, prefix, passes, metadata):
        def part(name):
            return parts.get(prefix + name, ((), None))

        layers, spectral = part("spectral")
        counts, numbers = part("samples")
        channels, features = part("features")
        return cls(
            rgb=part("rgb")[1],
            variance=part("variance")[1],
            spectral=spectral,
            spectral_nm=np.array([_nanometres(name) for name in layers]) if spectral is not None else None,
            samples=numbers[..., list(counts).index("samples")] if numbers is not None else None,
            features={name: features[..., i] for i, name in enumerate(channels)},
            passes=passes,
            metadata=metadata,
        )

    @property
    def standard_error(self) -> np.ndarray:
        """Of each number of `rgb`."""
        return np.sqrt(self.variance)

    def srgb(self, exposure_ev: float = 0.0) -> np.ndarray:
        """As a screen shows it: 8 bits, the curve of sRGB, cut off at saturation."""
        linear = np.clip(self.rgb * 2.0**exposure_ev, 0.0, 1.0)
        encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        return (255.0 * encoded + 0.5).astype(np.uint8)

    def plot(self, axes=None, exposure_ev=0.0):
        """The picture."""
        from .plots import plot_picture

        return plot_picture(self, axes, exposure_ev)


def _nanometres(channel):
    """ "S0.550,5nm" is 550.5: spectral EXR (Fichet, Pacanowski and Wilkie 2021)."""
    return float(re.search(r"(\d+(?:[.,]\d+)?)nm$", channel)[1].replace(",", "."))
