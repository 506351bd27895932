"""A lens, and what it does."""
from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Optional, Sequence, Tuple

import numpy as np

from . import results
from ._command import native, run, words
from .rays import Rays, TracedRays, trace


@dataclass(frozen=True)
class PointImage:
    """The image of a point: intensity in units of the peak of a perfect lens with the same pupil, rows from low y."""

    field_deg: float
    half_width_um: float  # from the middle to the outer edge of the outermost pixels
    intensity: np.ndarray
    strehl: float
    remark: str  # why there is none

    @property
    def pixel_um(self) -> float:
        return 2.0 * self.half_width_um / len(self.intensity)

    def to_dict(self) -> dict:
        return dict(vars(self))

    def plot(self, axes=None):
        from .plots import plot_point_image

        return plot_point_image(self, axes)


@dataclass(frozen=True)
class Mtf:
    """Modulation against spatial frequency at one field, and that of the same pupil without aberration."""

    field_deg: float
    frequency_per_mm: np.ndarray
    tangential: np.ndarray
    sagittal: np.ndarray
    limit_tangential: np.ndarray
    limit_sagittal: np.ndarray
    remark: str  # "by rays", or why there is none

    def to_dict(self) -> dict:
        return dict(vars(self))

    def plot(self, axes=None):
        from .plots import plot_mtf

        return plot_mtf(self, axes)


@dataclass(frozen=True)
class Lens:
    """A prescription, and what it is looked at for. `Lens.load` makes one."""

    path: str
    options: dict = field(default_factory=dict)
    _loaded: Any = field(default=None, repr=False, compare=False)

    @classmethod
    def load(cls, path, **options) -> "Lens":
        """A prescription file, or the name of a lens that ships, with the options of `analyze` that say how it is looked
        at: f_number, focus_mm, image_distance_mm, fields_deg, wavelengths_nm, reference_wavelength_nm, zoom, coating,
        index, glass_catalogue, best_focus, focus_frequency_per_mm, rings."""
        path = os.fspath(path)
        return cls(path, options, native().LoadedLens([*words("analyze", options), "--", path]))

    def with_options(self, **options) -> "Lens":
        """The same lens, looked at otherwise."""
        return Lens.load(self.path, **{**self.options, **options})

    def __fspath__(self) -> str:
        return self.path

    @property
    def name(self) -> str:
        return self._loaded.name()

    @property
    def image_z_mm(self) -> float:
        """The image plane, from the first vertex."""
        return self._loaded.image_z_mm()

    @property
    def fields_deg(self) -> Tuple[float, ...]:
        return tuple(self._loaded.fields_deg())

    @property
    def wavelengths_nm(self) -> Tuple[float, ...]:
        return tuple(self._loaded.wavelengths_nm())

    @property
    def reference_wavelength_nm(self) -> float:
        return self._loaded.reference_wavelength_nm()

    def analyze(self, **options) -> results.Analysis:
        """First-order data, Seidel sums, and over the field distortion, foci, light, spots and wavefront."""
        return results.Analysis.of(run("analyze", self.path, **{**self.options, **options}))

    def ghosts(self, **options) -> results.Ghosts:
        """The reflections that reach the sensor; options of `ghosts`: source_deg, strongest, reflections, …"""
        return results.Ghosts.of(run("ghosts", self.path, **{**self.options, **options}))

    def trace(self, rays: Rays, *, reverse=False, clip=True, threads=0, out: Optional[TracedRays] = None) -> TracedRays:
        """Traces rays, each with the bits that `lensproof trace` gives. They are read where they lie, and each is
        written once, into arrays of the result; into those of `out`, an earlier one of as many rays, where that is
        given. `reverse`: from the sensor outwards; `clip=False` follows rays past rims."""
        return trace(self._loaded, rays, reverse, clip, threads, out)

    def psf(self, **options) -> Tuple[PointImage, ...]:
        """The point image of each field, of all wavelengths together."""
        lens = self.with_options(**options) if options else self
        images = []
        for field_deg, size, half_width_um, intensity, strehl, remark in lens._loaded.psfs():
            pixels = np.frombuffer(intensity).reshape(size, size)
            images.append(PointImage(field_deg, half_width_um, pixels, strehl, remark))
        return tuple(images)

    def mtf(self, frequencies_per_mm: Sequence[float] = (), **options) -> Tuple[Mtf, ...]:
        """The MTF of each field, of all wavelengths together; without frequencies, at those that `analyze --plots`
        shows."""
        lens = self.with_options(**options) if options else self
        found = lens._loaded.mtfs([float(one) for one in frequencies_per_mm])
        return tuple(Mtf(deg, *map(np.frombuffer, curves), remark) for deg, *curves, remark in found)
