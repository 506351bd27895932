"""lensproof: a reference spectral lens and scene tracer, and the validation suite around it, from Python.

Lengths in mm, angles in degrees, wavelengths in nm, and names say so. Keywords are the command line's options
(`f_number=4` is `--f-number 4`), results hold what its JSON says, and the very bytes of it (`.json`).
"""
from .commands import Render, check, compare, data_root, fit, measure, plan, render, tradeoff
from .errors import InputError, LensproofError
from .lens import Lens, Mtf, PointImage
from .picture import Picture
from .rays import STATUS_NAMES, Rays, TracedRays

__all__ = [
    "STATUS_NAMES", "InputError", "Lens", "LensproofError", "Mtf", "Picture", "PointImage", "Rays", "Render",
    "TracedRays", "check", "compare", "data_root", "fit", "measure", "plan", "render", "tradeoff",
]
