"""The commands that are no lens's own."""
from __future__ import annotations

import os
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Union

from . import results
from ._command import native, run
from ._typed import Result, members, parsed
from .errors import InputError
from .picture import Picture


@dataclass(frozen=True)
class Render(Result):
    """Of `render`: the picture, and what the run says of itself (`to_dict`)."""

    picture: Picture
    scene: str
    lens: str
    model: str
    samples_per_pixel: float
    relative_error: float

    def plot(self, axes=None, exposure_ev=0.0):
        """The picture."""
        return self.picture.plot(axes, exposure_ev)


def data_root() -> Path:
    """The folder that holds what ships: lenses/, experiments/scenes/, …"""
    return Path(native().data_root())


def _several(values):
    return [values] if isinstance(values, (str, bytes, os.PathLike, Result)) else list(values)


def _places(values, stack):
    """Files of what commands take: paths as they are, profiles written to a folder that goes with `stack`."""
    places = []
    for value in values:
        if isinstance(value, results.Profile):
            place = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="lensproof-"))) / "profile.json"
            value.save(place)
            value = place
        elif isinstance(value, Result):
            raise InputError(f"a {type(value).__name__} is no input here, expected a path, a Lens or a Profile")
        places.append(os.fspath(value))
    return places


def check(*lenses, **options) -> results.Check:
    """What is wrong with prescriptions; `.ok` where no finding is an error."""
    return results.Check.of(run("check", *lenses, **options))


def render(scene, output=None, **options) -> Render:
    """Renders a scene file. `output`: an EXR to keep, a PNG beside it; else both are gone when this returns, and the
    arrays stay. Options of `render`: samples, noise, time_s, passes, model, features=True, …"""
    with tempfile.TemporaryDirectory(prefix="lensproof-") as folder:
        place = os.fspath(output) if output is not None else os.path.join(folder, "picture.exr")
        status, json = run("render", scene, output=place, **options)
        data = {name: value for name, value in parsed(json).items() if name != "picture"}
        found = members(Render, data)
        return Render(**{**found, "json": json, "status": status, "picture": Picture.load(data.get("exr", place))})


def measure(images, chart=None, **options) -> results.Profile:
    """What pictures of a chart (paths, or folders of them) say of the lens that took them."""
    return results.Profile.of(run("measure", *_several(images), chart=chart, **options))


def compare(a, b=None, **options) -> Union[results.Comparison, results.MeasuredComparison]:
    """Two profiles, a lens and a profile, or two pictures; with measured="lensfun:MODEL", a lens and photographs of its
    product. `.ok` where every limit that was asked for holds."""
    with ExitStack() as stack:
        places = _places([a] if b is None else [a, b], stack)
        kind = results.Comparison if options.get("measured") is None else results.MeasuredComparison
        return kind.of(run("compare", *places, **options))


def fit(profiles, lens, **options) -> results.Fit:
    """What is otherwise in a lens than its prescription says, by profiles measured of it."""
    with ExitStack() as stack:
        return results.Fit.of(run("fit", *_places(_several(profiles), stack), lens=lens, **options))


def plan(scene, tolerance, **options) -> results.Plan:
    """Which of the lens's effects a scene needs at a tolerance: "0.5px,0.02ev,1de", or "visible"."""
    return results.Plan.of(run("plan", scene, tolerance=tolerance, **options))


def tradeoff(scene, **options) -> results.Tradeoff:
    """What each model of the scene's camera gets wrong, and what it costs."""
    return results.Tradeoff.of(run("tradeoff", scene, **options))
