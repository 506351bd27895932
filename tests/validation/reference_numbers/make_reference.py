"""make_reference.py [LENS…]: writes the reference numbers beside it; README.md says what they are."""
import json, pathlib, sys

sys.dont_write_bytecode = True
from mpmath import mp, mpf

import areas, exact_rays, third_order
from prescription import at_wavelength, read_lens

mp.dps = 50
HERE = pathlib.Path(__file__).resolve().parent
LENSES = HERE.parents[2] / "lenses"
F, D, C = 486.1327, 587.5618, 656.2725

# Fields in degrees; the last one of `seidel_deg` is what the third order is for. Where a table states n_d and V_d alone,
# there is only d.
CASES = {
    "tessar": {"fields": [0, 8, 16, 24], "wavelengths": [D, F, C], "seidel_deg": 24},
    "petzval": {"fields": [0, 4, 8, 12], "wavelengths": [D, F, C], "seidel_deg": 12},
    "double-gauss-lowenthal": {"fields": [0, 5, 10, 13], "wavelengths": [D, F, C], "seidel_deg": 13},
    "triplet-cooke": {"fields": [0, 7, 14, 20], "wavelengths": [D, F, C], "seidel_deg": 20},
    "muller-fisheye": {"fields": [0, 20, 40, 60, 74], "wavelengths": [D, F, C], "seidel_deg": 20},
    "fisheye-220": {"fields": [0, 30, 60, 90, 105], "wavelengths": [D], "seidel_deg": 30},
    "conic-aspheres": {"fields": [0, 7, 14, 20], "wavelengths": [D, F, C], "seidel_deg": 20},
}
RAY_DIRECTIONS = {"near": 500.0, "far": 1e8}  # object distances besides infinity, mm


def number(x):
    """The double next to x, which JSON writes with the digits that tell it from its neighbours."""
    x = float(x)
    return int(x) if x == int(x) and abs(x) < 1e9 else x


def numbers(xs):
    return [number(x) for x in xs]


def lens_file(name):
    own = HERE / f"{name}.toml"
    return own if own.exists() else LENSES / f"{name}.toml"


def ray_entry(lens, wavelength, origin, direction):
    """A ray as the program gets it, in doubles, and all that it meets."""
    origin, direction = numbers(origin), numbers(direction)
    traced = exact_rays.trace(lens.surfaces, origin, direction)
    entry = {"wavelength_nm": wavelength, "origin": origin, "direction": direction, "status": traced.status,
             "clipped": None if traced.clipped is None else traced.clipped + 1,
             "surfaces": [numbers([*h.p, *h.d, h.path]) for h in traced.hits]}
    if traced.status == "ok":
        point, path = exact_rays.at_plane(traced.last, lens.image_z)
        entry["image"] = numbers([point[0], point[1], path])
    return entry


def beam_origin(chief, a, b):
    """The chief ray's start moved across it by (a, b) mm, 20 mm (or more) in front of the lens along it."""
    (p, d), back = chief, 20
    return [p[0] + a - back * d[0], p[1] + b * d[2] - back * d[1], p[2] - b * d[1] - back * d[2]]


def rays_of(case, lenses, chiefs, radius):
    """Chief, meridional and skew rays; from near and far points; and some that end."""
    entries = []
    for f in case["fields"]:
        chief = chiefs[f, D]
        entries.append(ray_entry(lenses[D], D, beam_origin(chief, 0, 0), chief[1]))
    wavelengths = case["wavelengths"]
    f = case["fields"][-2]
    for i, (a, b) in enumerate([(0, 0.4), (0, -0.4), (0.4, 0), (0.3, 0.25), (-0.2, -0.35)]):
        w = wavelengths[(i + 1) % len(wavelengths)]
        chief = chiefs[f, w]
        entries.append(ray_entry(lenses[w], w, beam_origin(chief, a * radius, b * radius), chief[1]))
    for distance in RAY_DIRECTIONS.values():
        f = case["fields"][1]
        slope = mp.tan(mp.radians(f))
        chief = chiefs[f, D][0]
        point = [mpf(0), chief[1] - slope * (distance + chief[2]), mpf(-distance)]
        for a, b in ((0, 0), (0.3, 0.4)):
            aim = [chief[0] + a * radius, chief[1] + b * radius, chief[2]]
            entries.append(ray_entry(lenses[D], D, point, [q - p for p, q in zip(point, aim)]))
    return entries


def ended_rays(lens):
    """One ray each that misses, that is totally reflected and that meets a rim, where a coarse search finds one."""
    found = {}
    first = lens.surfaces[0]
    for tilt in range(0, 86, 5):
        for step in range(-60, 61):
            height = first.semi * step / 20
            d = [mpf(step) / 400, mp.sin(mp.radians(tilt)), mp.cos(mp.radians(tilt))]
            origin = numbers([height / 7 - 30 * d[0], height - 30 * d[1], -30 * d[2]])
            with mp.workdps(20):
                traced = exact_rays.trace(lens.surfaces, origin, numbers(d))
            what = (traced.status, len(traced.hits))
            if traced.status != "ok" and traced.hits and traced.status not in found:
                found[traced.status] = (origin, d, what)
            if traced.status == "ok" and traced.clipped is not None and "clipped" not in found:
                found["clipped"] = (origin, d, what)
            if len(found) == 3:
                break
    return [ray_entry(lens, D, origin, d) for origin, d, _ in found.values()]


def fans_of(lenses, chiefs, f, radius):
    """Rays across the beam of one field; ex, ey from the chief ray, in the image plane."""
    lens, chief = lenses[D], chiefs[f, D]
    y0 = exact_rays.at_plane(exact_rays.trace(lens.surfaces, *chief).last, lens.image_z)[0][1]
    fans = []
    for fan in "ts":
        for step in (-4, -3, -2, -1, 1, 2, 3, 4):
            offset = number(radius * step / 8)
            a, b = (0, offset) if fan == "t" else (offset, 0)
            origin = numbers(beam_origin(chief, a, b))
            traced = exact_rays.trace(lens.surfaces, origin, numbers(chief[1]))
            if traced.status != "ok":
                continue
            p = exact_rays.at_plane(traced.last, lens.image_z)[0]
            fans.append({"fan": fan, "offset_mm": offset, "origin": origin, "error_mm": numbers([p[0], p[1] - y0])})
    return {"field_deg": f, "wavelength_nm": D, "direction": numbers(chief[1]), "chief_y_mm": number(y0), "points": fans}


def projected(projection, field):
    return {"rectilinear": mp.tan(field), "equidistant": field, "equisolid": 2 * mp.sin(field / 2),
            "stereographic": 2 * mp.tan(field / 2), "orthographic": mp.sin(field)}[projection]


class FieldRows:
    """What `analyze` says of each field and wavelength."""

    def __init__(self, case, lenses, chiefs, first):
        self.case, self.lenses, self.chiefs, self.first = case, lenses, chiefs, first
        self.pupil = float(first[D]["entrance_pupil_diameter_mm"])
        reference = case["wavelengths"][0]
        self.paraxial_image_z = lenses[reference].surfaces[-1].z + first[reference]["bfl_mm"]
        self.beams = {w: areas.Beamlens(lens) for w, lens in lenses.items()}
        self.axial = {}
        self.worst = 0.0  # relative difference of the two last rules of any quadrature

    def exit_pupil_distance(self, f, w, last):
        """From the exit pupil, where the real chief ray crosses the axis, to its image point along it; signed."""
        lens = self.lenses[w]
        if f == 0:
            return lens.image_z - lens.surfaces[-1].z - self.first[w]["exit_pupil_z_mm"]
        point, _ = exact_rays.at_plane(last, lens.image_z)
        return point[1] / last.d[1]

    def areas_at(self, f, w, chief, last):
        beam = self.beams[w]
        image = [float(x) for x in exact_rays.at_plane(last, self.lenses[w].image_z)[0]]
        extents = [self.pupil, 5 * self.pupil, 25 * self.pupil]
        region = areas.Region(beam, areas.incoming_beam(beam, *chief), 1, extents)
        if region.centre is None:
            return {"vignetting": 0, "relative_illumination": 0}
        area, error_a = region.area()
        centroid, rms, error_s = areas.spot(beam, region, image[1])
        waves, error_w = areas.wavefront_rms(beam, region, image, float(self.exit_pupil_distance(f, w, last)), w)
        cone = areas.Region(beam, areas.cones_of(beam, float(self.reference_y)), -1, [1.0])
        solid, error_i = cone.area()
        self.worst = max(self.worst, error_a, error_i, error_s, error_w)
        self.axial.setdefault(w, (area, solid))
        return {"beam_area_mm2": area, "projected_solid_angle_sr": solid, "vignetting": area / self.axial[w][0],
                "relative_illumination": solid / self.axial[w][1], "spot_rms_um": 1000 * rms,
                "spot_centroid_y_mm": centroid, "wavefront_rms_waves": waves}

    def row(self, f, w):
        lens, chief = self.lenses[w], self.chiefs[f, w]
        traced = exact_rays.trace(lens.surfaces, *chief)
        point, _ = exact_rays.at_plane(traced.last, lens.image_z)
        y = point[1]
        foci = exact_rays.coddington(lens.surfaces, traced)
        close = exact_rays.close_ray_foci(lens.surfaces, *chief)
        for one, other in zip(foci, close):
            assert abs(one - other) < mpf("1e-20") * abs(one), "Coddington against close rays"
        to_plane = [traced.last.p[2] + t * traced.last.d[2] - lens.image_z for t in foci]
        row = {"field_deg": f, "wavelength_nm": w, "clipped": None if traced.clipped is None else traced.clipped + 1,
               "front": numbers([*chief[0], *chief[1]]), "chief_ray_height_mm": number(y),
               "lateral_colour_um": number(1000 * (y - self.reference_height(f, w, y))),
               "tangential_focus_mm": number(to_plane[0]), "sagittal_focus_mm": number(to_plane[1])}
        if f:
            ideal = projected(lens.projection, mp.radians(f))
            if not (lens.projection == "rectilinear" and f >= 90):
                in_focus, _ = exact_rays.at_plane(traced.last, self.paraxial_image_z)
                row["distortion_percent"] = number(100 * (in_focus[1] / (self.first[w]["efl_mm"] * ideal) - 1))
        row.update({k: number(v) for k, v in self.areas_at(f, w, chief, traced.last).items()})
        return row

    def reference_height(self, f, w, y):
        if w == self.case["wavelengths"][0]:
            self.reference_y = y
        return self.reference_y

    def rows(self):
        rows = []
        for f in self.case["fields"]:
            for w in self.case["wavelengths"]:
                rows.append(self.row(f, w))
        return rows


def check_float_rays(case, entries, lenses):
    """The largest distance, mm, of the quadrature's float64 rays from the exact ones at the image plane."""
    worst = 0.0
    for e in entries:
        if e["status"] != "ok" or e["clipped"] is not None or abs(e["origin"][2]) > 1e4:
            continue
        beam = areas.Beamlens(lenses[e["wavelength_nm"]])
        norm = float(mp.sqrt(sum(mpf(x) ** 2 for x in e["direction"])))
        _, p, d, _ = beam.trace([[x] for x in e["origin"]], [[x / norm] for x in e["direction"]])
        s = (beam.image_z - p[2][0]) / d[2][0]
        worst = max(worst, *(abs(p[i][0] + s * d[i][0] - e["image"][i]) for i in (0, 1)))
    return worst


def make(name):
    case = CASES[name]
    lens = read_lens(lens_file(name), LENSES / "glass")
    lenses = {w: at_wavelength(lens, w) for w in case["wavelengths"]}
    first = {w: third_order.first_order(lenses[w]) for w in case["wavelengths"]}
    chiefs = {(f, w): exact_rays.ChiefAiming(lenses[w]).at_field(mp.radians(f))
              for f in case["fields"] for w in case["wavelengths"]}
    dispersion = lambda i: (0, 0)
    if F in lenses and C in lenses:
        f_side, c_side = lenses[F].surfaces, lenses[C].surfaces
        dispersion = lambda i: (f_side[i].n_before - c_side[i].n_before, f_side[i].n_after - c_side[i].n_after)
    invariant, sums = third_order.seidel(lenses[D], mp.radians(case["seidel_deg"]), dispersion)
    radius = first[D]["entrance_pupil_diameter_mm"] / 2
    entries = rays_of(case, lenses, chiefs, radius)
    ends = ended_rays(lenses[D])
    rows = FieldRows(case, lenses, chiefs, first)
    result = {
        "lens": name, "image_z_mm": number(lens.image_z), "fields_deg": case["fields"],
        "wavelengths_nm": case["wavelengths"],
        "indices": {str(w): numbers(s.n_after for s in lenses[w].surfaces) for w in lenses},
        "paraxial": {str(w): {k: number(v) for k, v in data.items()} for w, data in first.items()},
        "seidel": {"field_deg": case["seidel_deg"], "lagrange_invariant_mm": number(invariant),
                   "has_colour": F in lenses, "surfaces": [numbers(r) for r in sums],
                   "total": numbers(sum(column) for column in zip(*sums))},
        "rays": entries + ends,
        "fan": fans_of(lenses, chiefs, case["fields"][-2], radius),
        "fields": rows.rows(),
    }
    print(f"{name}: quadratures {rows.worst:.0e}, float64 rays {check_float_rays(case, entries, lenses):.0e} mm, "
          f"ended {[(e['status'], e['clipped']) for e in ends]}", flush=True)
    return result


def compact(result):
    """JSON with a line for each ray, surface and row."""
    return json.dumps(result, separators=(",", ":"), ensure_ascii=False).replace("},{", "},\n{").replace(
        '],"', '],\n"').replace("]],[[", "]],\n[[") + "\n"


def main():
    for name in sys.argv[1:] or CASES:
        (HERE / f"{name}.json").write_text(compact(make(name)))


if __name__ == "__main__":
    main()
