"""Reads a lens of lenses/ and its glasses, without a line of the program's own reader."""
import csv, pathlib, tomllib
from dataclasses import dataclass, field

from mpmath import mp, mpf

# In the order in which lenses/glass/README.md says that names are looked up.
GLASS_FILES = ("schott", "schott-obsolete", "ohara", "hoya", "hikari", "cdgm", "materials")


@dataclass
class Surface:
    """z = c r² / (1 + √(1 − (1 + k) c² r²)) + Σ A_j r^j about its vertex; numbers are mpf, lengths mm."""
    c: mpf
    k: mpf
    asphere: list  # of (power of r, coefficient)
    z: mpf  # of the vertex
    semi: mpf
    is_stop: bool
    medium: object  # wavelength_nm → index behind the surface
    n_before: mpf = mpf(1)  # at one wavelength, set by `at_wavelength`
    n_after: mpf = mpf(1)


@dataclass
class Lens:
    name: str
    projection: str
    surfaces: list
    image_z: mpf
    wavelengths: list = field(default_factory=list)

    @property
    def stop(self):
        return next(i for i, surface in enumerate(self.surfaces) if surface.is_stop)


def glass_rows(folder):
    """(catalogue, glass) and glass → its row, the first file winning."""
    rows = {}
    for name in GLASS_FILES:
        lines = (folder / f"{name}.csv").read_text(encoding="utf-8").splitlines()
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            rows.setdefault(row["glass"], row)
            rows.setdefault(f"{row['catalogue']} {row['glass']}", row)
    return rows


def index_formula(row):
    """The index as a function of the wavelength in nm, with all digits of mpmath."""
    a = [mpf(float(word)) for word in row["coefficients"].split()]
    kind = row["formula"]

    def index(wavelength_nm):
        squared = (mpf(wavelength_nm) / 1000) ** 2  # µm²
        if kind == "sellmeier":
            return mp.sqrt(1 + sum(b * squared / (squared - c) for b, c in zip(a[::2], a[1::2])))
        if kind == "schott":
            return mp.sqrt(sum(c * squared ** p for c, p in zip(a, (0, 1, -1, -2, -3, -4))))
        if kind == "power-series":
            return mp.sqrt(sum(c * squared ** (p / 2) for c, p in zip(a[::2], a[1::2])))
        raise NotImplementedError(f"formula {kind} of glass {row['glass']}")

    return index


def d_line_only(n_d, V_d):
    """A medium of which only n_d is stated. With V_d too, no other wavelength can be known without a model."""
    def index(wavelength_nm):
        if V_d is not None and wavelength_nm != 587.5618:
            raise ValueError("n_d and V_d alone give no index at other wavelengths")
        return mpf(n_d)
    return index


def medium_behind(row, glasses):
    if "glass" in row:
        return index_formula(glasses[row["glass"]])
    if "n_d" in row:
        return d_line_only(row["n_d"], row.get("V_d"))
    return lambda wavelength_nm: mpf(1)


def read_lens(file, glass_folder):
    """The doubles that the decimals of the file read as, taken as exact."""
    table = tomllib.loads(pathlib.Path(file).read_text(encoding="utf-8"))
    glasses = glass_rows(glass_folder)
    surfaces, z = [], mpf(0)
    for row in table["surfaces"]:
        radius = mpf(row.get("radius_mm", "inf"))
        surfaces.append(Surface(
            c=mpf(0) if radius == 0 or mp.isinf(radius) else 1 / radius,
            k=mpf(row.get("conic", 0)),
            asphere=[(p, mpf(row[f"A{p}"])) for p in range(1, 21) if f"A{p}" in row],
            z=z, semi=mpf(row["semi_diameter_mm"]), is_stop=row.get("stop", False),
            medium=medium_behind(row, glasses)))
        z += mpf(row["thickness_mm"])
    return Lens(name=table["name"], projection=table.get("projection", "rectilinear"), surfaces=surfaces, image_z=z)


def at_wavelength(lens, wavelength_nm):
    """The lens with its indices there."""
    n, surfaces = mpf(1), []
    for s in lens.surfaces:
        after = s.medium(wavelength_nm)
        surfaces.append(Surface(s.c, s.k, s.asphere, s.z, s.semi, s.is_stop, s.medium, n, after))
        n = after
    return Lens(lens.name, lens.projection, surfaces, lens.image_z)
