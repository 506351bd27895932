"""check_against_others.py [FOLDER]: this folder's methods against numbers that others computed.

FOLDER holds the Tessar of ../shared/optics_reference (by default the one beside the repository), traced by others with
50 digits; without it that part is left out. With rayoptics 0.9.8 installed, its first order and third-order sums are
compared as well. Prints the largest differences, which README.md quotes.
"""
import dataclasses, json, logging, pathlib, sys, warnings

sys.dont_write_bytecode = True
warnings.simplefilter("ignore")
logging.disable(logging.CRITICAL)
from mpmath import mp, mpf

import areas, exact_rays, third_order
from make_reference import C, D, F, HERE, LENSES, lens_file
from prescription import at_wavelength, read_lens

NAMES = {"efl_mm": "efl", "bfl_mm": "bfl", "ffl_mm": "ffl", "entrance_pupil_z_mm": "entrance_pupil_z",
         "entrance_pupil_diameter_mm": "entrance_pupil_diameter", "exit_pupil_z_mm": "exit_pupil_z_from_last",
         "exit_pupil_diameter_mm": "exit_pupil_diameter", "f_number": "f_number"}


class Worst(dict):
    """The largest difference of each kind."""

    def see(self, kind, found, expected, relative=False):
        size = abs(float(expected)) if relative and expected else 1.0
        self[kind] = max(self.get(kind, 0.0), abs(float(found - mpf(expected))) / size)

    def __str__(self):
        return ", ".join(f"{kind} {value:.1e}" for kind, value in self.items())


def index_differences(short, long):
    return lambda i: (short.surfaces[i].n_before - long.surfaces[i].n_before,
                      short.surfaces[i].n_after - long.surfaces[i].n_after)


def with_indices(lens, indices):
    n = mpf(1)
    for surface, index in zip(lens.surfaces, indices):
        surface.n_before, surface.n_after = n, mpf(index)
        n = surface.n_after
    return lens


def compare_first_and_third_order(worst, reference, lenses):
    for name, lens in lenses.items():
        data = third_order.first_order(lens)
        for ours, theirs in NAMES.items():
            worst.see("first order (relative)", data[ours], reference["paraxial"][name][theirs], True)
    _, sums = third_order.seidel(lenses["d"], mp.radians(24), index_differences(lenses["F"], lenses["C"]))
    for row, expected in zip(sums, reference["seidel"]["per_surface"]):
        for value, key in zip(row, ("S1", "S2", "S3", "S4", "S5", "CL", "CT")):
            worst.see("Seidel and colour sums (mm)", value, expected[key])


def compare_rays(worst, reference, lenses):
    for ray in reference["rays"]["rays"]:
        traced = exact_rays.trace(lenses[ray["wavelength"]].surfaces, ray["origin"], ray["direction"])
        for hit, expected in zip(traced.hits, ray["surfaces"]):
            for value, key in zip([*hit.p, *hit.d, hit.path], ("x", "y", "z", "L", "M", "N", "opl")):
                worst.see("rays (mm)", value, expected[key])
    for row in reference["chief_rays"]["rows"]:
        lens = lenses[row["wavelength"]]
        chief = exact_rays.ChiefAiming(lens).at_field(mp.radians(mpf(row["field_deg"])))
        traced = exact_rays.trace(lens.surfaces, *chief)
        worst.see("chief rays (mm)", exact_rays.at_plane(traced.last, lens.image_z)[0][1], row["y_nominal"])
        if row.get("astigmatic_focus"):
            foci = [traced.last.p[2] + t * traced.last.d[2] for t in exact_rays.coddington(lens.surfaces, traced)]
            for focus, key in zip(foci, ("z_tangential", "z_sagittal")):
                worst.see("foci (mm)", focus, row["astigmatic_focus"][key])


def compare_areas(worst, reference, lens, every=4):
    plane = mpf(reference["image_planes"]["paraxial_d"]["z"])
    lens = dataclasses.replace(lens, image_z=plane)
    beam = areas.Beamlens(lens)
    rows = zip(reference["vignetting"]["rows"], reference["relative_illumination"]["rows"])
    for incoming, outgoing in list(rows)[::every]:
        chief = exact_rays.ChiefAiming(lens).at_field(mp.radians(mpf(incoming["field_deg"])))
        region = areas.Region(beam, areas.incoming_beam(beam, *chief), 1, [25.0])
        if region.centre is None:
            worst.see("beam areas (relative)", 0, incoming["area_perp"])
            continue
        worst.see("beam areas (relative)", mpf(region.area()[0]), incoming["area_perp"], True)
        height = float(exact_rays.at_plane(exact_rays.trace(lens.surfaces, *chief).last, plane)[0][1])
        cone = areas.Region(beam, areas.cones_of(beam, height), -1, [1.0])
        worst.see("solid angles (relative)", mpf(cone.area()[0]), outgoing["projected_solid_angle"], True)


def against_shared(folder):
    for model in ("const", "catalog"):
        reference = json.loads((folder / f"tessar_brendel_100__{model}.json").read_text())
        table = read_lens(lens_file("tessar"), LENSES / "glass")
        lenses = {}
        for name, wavelength in reference["index_model"]["wavelengths_nm"].items():
            lens = at_wavelength(table, wavelength)
            given = [s["n_after"][name] for s in reference["surfaces"]]
            lenses[name] = with_indices(lens, given) if model == "const" else lens
        worst = Worst()
        compare_first_and_third_order(worst, reference, lenses)
        compare_rays(worst, reference, lenses)
        compare_areas(worst, reference, lenses["d"])
        print(f"Tessar, {model}: {worst}")


def rayoptics_model(lenses, field_deg, pupil):
    """The lens in rayoptics, its media with this folder's indices at F, d and C; from an object at infinity."""
    from rayoptics.elem import profiles
    from rayoptics.environment import FieldSpec, OpticalModel, PupilSpec, WvlSpec

    class Medium:
        def __init__(self, indices):
            self.indices = indices

        def name(self):
            return "given"

        def catalog_name(self):
            return "given"

        def rindex(self, wavelength):
            return self.indices[wavelength]

        def calc_rindex(self, wavelength):
            return self.indices[wavelength]

    model = OpticalModel()
    sequence, specs = model["seq_model"], model["optical_spec"]
    specs["pupil"] = PupilSpec(specs, key=["object", "epd"], value=float(pupil))
    specs["fov"] = FieldSpec(specs, key=["object", "angle"], value=field_deg, flds=[0.0, 1.0], is_relative=True)
    specs["wvls"] = WvlSpec([(F, 1.0), (D, 1.0), (C, 1.0)], ref_wl=1)
    model.radius_mode = False
    sequence.gaps[0].thi = 1e10
    rows = lenses[D].surfaces
    for i, s in enumerate(rows):
        next_z = rows[i + 1].z if i + 1 < len(rows) else lenses[D].image_z
        sequence.add_surface([float(s.c), float(next_z - s.z)])
        sequence.gaps[sequence.cur_surface].medium = Medium(
            {w: float(lens.surfaces[i].n_after) for w, lens in lenses.items()})
        interface = sequence.ifcs[sequence.cur_surface]
        if s.k or s.asphere:
            terms = dict(s.asphere)
            interface.profile = profiles.EvenPolynomial(c=float(s.c), cc=float(s.k), coefs=[
                float(terms.get(p, 0)) for p in range(2, max(terms, default=4) + 2, 2)])
        if s.is_stop:
            sequence.set_stop()
    model.update_model()
    return model


def against_rayoptics(name, field_deg):
    """Without terms of r², which rayoptics leaves out of a vertex's curvature (and so out of its first order)."""
    from rayoptics.parax.thirdorder import compute_third_order
    table = read_lens(lens_file(name), LENSES / "glass")
    for surface in table.surfaces:
        surface.asphere = [term for term in surface.asphere if term[0] != 2]
    lenses = {w: at_wavelength(table, w) for w in (F, D, C)}
    data = third_order.first_order(lenses[D])
    _, sums = third_order.seidel(lenses[D], mp.radians(field_deg), index_differences(lenses[F], lenses[C]))
    model = rayoptics_model(lenses, field_deg, data["entrance_pupil_diameter_mm"])
    first = model["analysis_results"]["parax_data"].fod
    worst = Worst()
    worst.see("focal length (relative)", mpf(first.efl), data["efl_mm"], True)
    worst.see("back focus (relative)", mpf(first.bfl), data["bfl_mm"], True)
    found = compute_third_order(model)
    for i, row in enumerate(sums):
        parts = [found.loc[label] for label in (f"{i + 1}", f"{i + 1}.asp") if label in found.index]
        for k in range(5):
            largest = max(abs(r[k]) for r in sums)
            worst.see("Seidel sums (of the largest)", mpf(float(sum(p.iloc[k] for p in parts))) / largest,
                      row[k] / largest)
    print(f"rayoptics, {name}: {worst}")


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parents[3] / "shared" / "optics_reference"
    if folder.is_dir():
        against_shared(folder)
    try:
        import rayoptics
    except ImportError:
        return
    against_rayoptics("double-gauss-lowenthal", 13.0)
    against_rayoptics("conic-aspheres", 20.0)


if __name__ == "__main__":
    main()
