"""Rays as arrays: given, and traced."""
from __future__ import annotations

import weakref
from dataclasses import dataclass, field
from typing import Optional, Tuple, Union

import numpy as np

from .errors import InputError

STATUS_NAMES = ("ok", "missed", "clipped", "total-internal-reflection", "stopped", "evanescent")

_LANES = 16  # of the widest packets, and
_ALIGNMENT = 64  # bytes
_GIVEN = ("x_mm", "y_mm", "z_mm", "dx", "dy", "dz")
_MOST_WAVELENGTHS = 65536


def _array(value, name):
    """A column of doubles where it lies: NumPy's, or of whatever speaks the buffer protocol or DLPack. Numbers of
    another type are converted."""
    if not hasattr(value, "__array_interface__") and hasattr(value, "__dlpack__"):
        value = np.from_dlpack(value)
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"rays: {name} is {type(value).__name__}, expected numbers ({error})") from None


@dataclass(frozen=True)
class Rays:
    """Rays in lens space, a column a quantity; a single number stands for all. Directions have any length but 0. Columns
    may be any that NumPy can look at without a copy: arrays with strides, other libraries' by DLPack."""

    x_mm: np.ndarray
    y_mm: np.ndarray
    z_mm: np.ndarray
    dx: np.ndarray
    dy: np.ndarray
    dz: np.ndarray
    wavelength_nm: Union[np.ndarray, float, None] = None  # None: the lens's reference

    @classmethod
    def of(cls, origins_mm, directions, wavelength_nm=None) -> "Rays":
        """From arrays of n × 3, whose columns are looked at where they lie."""
        origins_mm, directions = _array(origins_mm, "origins_mm"), _array(directions, "directions")
        for name, array in (("origins_mm", origins_mm), ("directions", directions)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise InputError(f"rays: {name} has shape {array.shape}, expected (n, 3)")
        return cls(*origins_mm.T, *directions.T, wavelength_nm)

    def columns(self) -> Tuple[np.ndarray, ...]:
        """The six, of one length."""
        given = [_array(getattr(self, name), name) for name in _GIVEN]
        for name, column in zip(_GIVEN, given):
            if column.ndim > 1:
                raise InputError(f"rays: {name} has shape {column.shape}, expected one dimension")
        lengths = {column.size for column in given if column.ndim == 1}
        if len(lengths) > 1:
            told = ", ".join(f"{name}: {column.size}" for name, column in zip(_GIVEN, given) if column.ndim == 1)
            raise InputError(f"rays: columns are of different lengths ({told})")
        length = lengths.pop() if lengths else 1
        return tuple(np.broadcast_to(column, (length,)) for column in given)


@dataclass(frozen=True)
class TracedRays:
    """Where each ray was on the last surface that it reached, and which way it went from there. Arrays of `trace`'s own,
    which `out=` of another call may fill anew."""

    x_mm: np.ndarray
    y_mm: np.ndarray
    z_mm: np.ndarray
    dx: np.ndarray
    dy: np.ndarray
    dz: np.ndarray
    optical_path_mm: np.ndarray
    transmittance: np.ndarray
    status: np.ndarray  # of STATUS_NAMES, as numbers
    surface: np.ndarray  # that last one, from 1
    image_z_mm: float
    _whole: Tuple[np.ndarray, ...] = field(repr=False)  # the first eight with what fills their last packets

    def __len__(self):
        return self.x_mm.size

    @property
    def ok(self) -> np.ndarray:
        """Which rays passed the whole lens."""
        return self.status == 0

    def at_z(self, z_mm: float) -> Tuple[np.ndarray, np.ndarray]:
        """x and y in mm where the rays meet a plane; NaN of those that did not pass."""
        distance = (z_mm - self.z_mm) / np.where(self.ok & (self.dz != 0), self.dz, np.nan)
        return self.x_mm + distance * self.dx, self.y_mm + distance * self.dy

    def at_image(self) -> Tuple[np.ndarray, np.ndarray]:
        """The same on the lens's image plane."""
        return self.at_z(self.image_z_mm)

    def to_dict(self) -> dict:
        """The columns by their names, statuses in words."""
        columns = {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return {**columns, "status": np.array(STATUS_NAMES)[self.status]}

    def plot(self, axes=None):
        """Where the rays meet the image plane."""
        from .plots import plot_spot

        return plot_spot(self, axes)


class _Spare:
    """Memory of a result that is gone, for the next of its size: what the system gives anew it clears first, for a tenth
    of the time that tracing into it takes. One block, of 256 MiB at most."""

    MOST_BYTES = 256 << 20

    def __init__(self):
        self.blocks = []

    def keep(self, block):
        if block.nbytes <= self.MOST_BYTES:
            self.blocks[:] = [block]

    def take(self, size):
        """Bytes that lie in a row, which come back when nothing looks at them any more."""
        try:
            block = self.blocks.pop()  # another thread may have
        except IndexError:
            block = None
        if block is None or block.nbytes != size:
            block = np.empty(size, np.uint8)
        # Behind a memoryview, or views of it would hold the block itself.
        looked_at = np.frombuffer(memoryview(block), np.uint8)
        weakref.finalize(looked_at, self.keep, block).atexit = False
        return looked_at


_spare = _Spare()


def _empty(rays, image_z_mm):
    """Columns that packets can be written to: aligned, filled up to whole ones, and not at equal places in their pages."""
    padded = -(-rays // _LANES) * _LANES + _LANES
    sizes = [8 * padded] * 8 + [2 * rays, rays]
    memory = _spare.take(sum(sizes) + _ALIGNMENT)
    ends = np.cumsum([-memory.__array_interface__["data"][0] % _ALIGNMENT, *sizes])
    types = [np.float64] * 8 + [np.int16, np.uint8]
    *whole, surface, status = (memory[begin:end].view(kind) for begin, end, kind in zip(ends, ends[1:], types))
    return TracedRays(*(column[:rays] for column in whole), status, surface, image_z_mm, tuple(whole))


def _wavelengths(wavelength_nm, reference_nm, rays) -> Tuple[list, Optional[np.ndarray]]:
    """The wavelengths, and which of them each ray has."""
    if wavelength_nm is None:
        return [reference_nm], None
    given = _array(wavelength_nm, "wavelength_nm")
    if given.ndim == 0 or given.size == 1:
        return [float(given.reshape(()))], None
    if given.shape != (rays,):
        raise InputError(f"rays: wavelength_nm has shape {given.shape}, expected ({rays},)")
    wavelengths, which = np.unique(given, return_inverse=True)
    if wavelengths.size > _MOST_WAVELENGTHS:
        raise InputError(f"rays: wavelength_nm has {wavelengths.size} values, expected at most {_MOST_WAVELENGTHS}")
    return wavelengths.tolist(), which.astype(np.uint16)


def trace(loaded, rays: Rays, reverse, clip, threads, out) -> TracedRays:
    given = rays.columns()
    size = given[0].size
    wavelengths, which = _wavelengths(rays.wavelength_nm, loaded.reference_wavelength_nm(), size)
    for value in wavelengths:
        if not 0 < value < np.inf:
            raise InputError(f"rays: wavelength_nm is {value}, expected a number above 0")
    if out is None:
        out = _empty(size, loaded.image_z_mm())
    elif len(out) != size:
        raise InputError(f"out: holds {len(out)} rays, expected {size}")
    loaded.trace(list(given), [*out._whole, out.status, out.surface], wavelengths, which, reverse, clip, threads)
    np.add(out.surface, 1, out=out.surface)
    return out
