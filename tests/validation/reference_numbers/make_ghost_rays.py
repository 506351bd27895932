"""make_ghost_rays.py: rays along ghosts as Optiland's multi-sequence tracing has them, into ghost_rays.json beside this.

    python3 -m venv build/programs
    build/programs/bin/pip install optiland==0.6.3 mpmath numpy
    build/programs/bin/python tests/validation/reference_numbers/make_ghost_rays.py

Random pairs of surfaces of six lenses, at d; of random rays over the front those that stay within every rim. Optiland
gets the same surfaces and the same indices, rounded to doubles.
"""
import json, math, pathlib, random, sys, warnings

sys.dont_write_bytecode = True
warnings.simplefilter("ignore")
import numpy as np
from optiland.materials import IdealMaterial
from optiland.optic import Optic
from optiland.rays import RealRays
from optiland.sequences import SequencedSurfaceGroup

from make_reference import D, HERE, LENSES, lens_file
from prescription import at_wavelength, read_lens

NAMES = ["tessar", "petzval", "double-gauss-lowenthal", "triplet-cooke", "muller-fisheye", "fisheye-220"]
GHOSTS, RAYS, TRIED = 10, 4, 2000


def optic(lens):
    built = Optic()
    add = built.surfaces.add
    add(index=0, thickness=np.inf)
    rows = lens.surfaces
    for i, s in enumerate(rows):
        next_z = rows[i + 1].z if i + 1 < len(rows) else lens.image_z
        add(index=i + 1, radius=float(1 / s.c) if s.c else np.inf, conic=float(s.k), thickness=float(next_z - s.z),
            material=IdealMaterial(n=float(s.n_after)), is_stop=s.is_stop)
    add(index=len(rows) + 1)
    return built


def steps_along(pair, count):
    """Optiland's steps, its object being surface 0 and its image count + 1."""
    first, second = pair
    return [*range(1, first), (first, "reflect"), *range(first - 1, second, -1), (second, "reflect"),
            *range(second + 1, count + 2)]


def rays_along(base, lens, pair, rng):
    semi = [float(s.semi) for s in lens.surfaces]
    reach = semi[0]
    starts = []
    for _ in range(TRIED):
        x, y = (rng.uniform(-reach, reach) for _ in range(2))
        direction = np.array([rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), 1.0])
        direction /= np.linalg.norm(direction)
        starts.append([*(np.array([x, y, 0.0]) - 20.0 * direction / direction[2]), *direction])
    steps = steps_along(pair, len(semi))
    group = SequencedSurfaceGroup(base.surfaces.surfaces, steps)
    out = group.trace(RealRays(*np.array(starts).T, np.ones(TRIED), np.full(TRIED, D / 1000)))
    inside = np.isfinite(out.x) & np.isfinite(out.y)
    for step, x, y in zip(steps, group.x, group.y):
        index = step[0] if isinstance(step, tuple) else step
        if index <= len(semi):
            inside &= np.hypot(x, y) <= 0.999 * semi[index - 1]
    return [{"ray": starts[i], "image_mm": [float(out.x[i]), float(out.y[i])]} for i in np.flatnonzero(inside)[:RAYS]]


def main():
    lenses = []
    for seed, name in enumerate(NAMES):
        rng = random.Random(seed)
        lens = at_wavelength(read_lens(lens_file(name), LENSES / "glass"), D)
        base = optic(lens)
        pairs = [(a, b) for a in range(2, len(lens.surfaces) + 1) for b in range(1, a)
                 if all(lens.surfaces[i - 1].n_before != lens.surfaces[i - 1].n_after for i in (a, b))]
        rng.shuffle(pairs)
        ghosts = []
        for pair in pairs:
            rays = rays_along(base, lens, pair, rng)
            if rays and len(ghosts) < GHOSTS:
                ghosts.append({"surfaces": pair, "rays": rays})
        print(name, len(ghosts), sum(len(g["rays"]) for g in ghosts))
        lenses.append({"lens": name, "ghosts": ghosts})
    text = json.dumps({"program": "Optiland 0.6.3", "wavelength_nm": D, "lenses": lenses})
    (HERE / "ghost_rays.json").write_text(text.replace('{"surfaces"', '\n{"surfaces"') + "\n")


if __name__ == "__main__":
    main()
