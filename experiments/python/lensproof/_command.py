"""The command line in this process: options from keywords, its JSON back."""
import json as _json
import math
import os

from .errors import InputError, LensproofError

# Keywords whose unit the command line leaves to its help.
_FLAGS = {
    "fields_deg": "fields", "wavelengths_nm": "wavelengths", "reference_wavelength_nm": "reference-wavelength",
    "wavelength_nm": "wavelength", "focus_mm": "focus", "image_distance_mm": "image-distance",
    "focus_frequency_per_mm": "focus-frequency", "image_circle_mm": "image-circle", "pixel_pitch_um": "pixel-pitch",
    "focal_length_mm": "focal-length", "focus_positions_mm": "focus-positions", "time_s": "time",
    "largest_picture_mib": "largest-picture", "reference_band_nm": "reference-band", "image_centre_px": "image-centre",
}
# Options that are given again for each of their values; others take a list between commas.
_REPEATED = {"index", "glass-catalogue", "flat-field", "edge"}
_LEFT_OUT = {"untrusted": "which shuts a process off for good: use the command line", "json": "which is what comes back"}


def native():
    """The native part, loaded where it is first used: with the libraries behind it, for meshes and fits, it is most of
    what there is to load."""
    from . import _lensproof

    return _lensproof


def _text(value, command):
    if isinstance(value, float):
        # `compare` spells it as C does.
        return ("inf" if command == "compare" else "infinity") if math.isinf(value) and value > 0 else repr(value)
    return os.fspath(value) if isinstance(value, os.PathLike) else str(getattr(value, "item", lambda: value)())


def _values(value, command):
    if isinstance(value, dict):
        return [f"{key}={_text(one, command)}" for key, one in value.items()]
    if isinstance(value, (str, bytes, os.PathLike)) or not hasattr(value, "__iter__"):
        return [_text(value, command)]
    return [_text(one, command) for one in value]


def words(command, options):
    """The command line's words for keywords: f_number=4 is --f-number=4, fields_deg=[0, 10] is --fields=0,10,
    features=True is --features, and None and False are nothing."""
    found = []
    for key, value in options.items():
        flag = _FLAGS.get(key, key.replace("_", "-"))
        if flag in _LEFT_OUT:
            raise InputError(f"{key}: no option here, {_LEFT_OUT[flag]}")
        if value is None or value is False:
            continue
        if value is True:
            found.append(f"--{flag}")
        elif flag in _REPEATED:
            found += [f"--{flag}={one}" for one in _values(value, command)]
        else:
            found.append(f"--{flag}={','.join(_values(value, command))}")
    return found


def run(command, *operands, **options):
    """Runs `lensproof COMMAND OPERAND… --OPTION…` in this process. Returns its exit status (0, or 1 where a check does
    not hold) and the bytes that `--json -` writes. Raises InputError (status 2) and LensproofError (3)."""
    line = [command, *words(command, options), "--quiet", "--json=-", "--", *map(os.fspath, operands)]
    status, json, message = native().command(line)
    if status == 2:
        raise InputError(message)
    if status not in (0, 1):
        raise LensproofError(message or f"lensproof {command} ended with status {status}")
    return status, json


def parsed(json):
    return _json.loads(json) if json.strip() else {}
