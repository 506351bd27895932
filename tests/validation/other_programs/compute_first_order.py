"""Computes first_order.json, what rayoptics and Optiland say of the lens files that programs ship.

    python3 -m venv build/programs
    build/programs/bin/pip install rayoptics==0.9.8 optiland==0.6.3 opticalglass==1.1.1
    build/programs/bin/python tests/validation/other_programs/compute_first_order.py

Run by hand when a version changes; the tests read its result. Each program reads each file with its own reader and its
own glasses, at the file's primary wavelength, and traces its own paraxial rays. What differs from asking for the
program's ready numbers, and why:

- rayoptics starts rays from an infinite object 1e10 mm away, which costs its pupils eight digits, and measures its exit
  pupil from where the image is, not where the file puts it; here the pupils come from its two rays of unit height and
  unit slope. Its reference wavelength is the middle one, here the file's primary one. It knows no stop at surface 1.
- Optiland measures from the image plane, here from the last surface by the same rays. It ignores UNIT, rayoptics only
  notes it; inches become millimetres here.
- A glass that its catalogues do not have, rayoptics replaces by a similar one or by n_d 1.5; Optiland by the file's n_d
  and V_d. So each program's indices stand beside its numbers, and a comparison takes these very indices.
- A coordinate break is no surface here, so that both measure from the same vertex. Both follow the axis through tilts
  without their astigmatism.

- What the pupil's diameter, the fields and the primary wavelength are is said as each program reads them. Fields are
  angles of the chief rays that it traces, absolute values, each once; where the file states angles, these with x and y
  put together.
- Where a program reads a file otherwise than the file says, `reasons` names it, by quantity: decided by hand from the
  file's records, in VERDICTS and the functions beside it. `without` says why a program has no numbers.

Lengths are in mm: the entrance pupil and the front focal point from the file's surface 1, the exit pupil and the rear
focal point from its last surface before the image, dummies included; positive towards +z. null is at infinity.
"""
import hashlib, json, logging, math, pathlib, re, shutil, sys, tempfile, warnings
from importlib.metadata import version

import numpy as np

sys.dont_write_bytecode = True
import sample_tables, samples

HERE = pathlib.Path(__file__).parent
FOLDER = HERE.parents[2] / "build" / "other_programs"
QUANTITIES = ("wavelength_nm", "efl_mm", "entrance_pupil_diameter_mm", "f_number", "fields_deg")
LENGTHS = ("efl_mm", "bfl_mm", "ffl_mm", "entrance_pupil_z_mm", "exit_pupil_z_mm")


# All by the end of a file's path. What a program reads otherwise than the file says, so that its numbers say nothing:
NO_RADII = "takes S lines for curvatures where no RDM says so; with these radii the lens would be of 0.02 mm"
NO_CURVATURES = "takes S lines for radii where no RDM says so; with these curvatures the lens would be of 0.2 mm"
MISREAD = {
    ("codev_files/cooke_triplet.seq", "rayoptics"): NO_RADII,
    ("codev_files/fno_fields.seq", "rayoptics"): NO_RADII,
    ("codev_files/mirror.seq", "rayoptics"): NO_RADII,
    ("codev/tests/landscape_lens.seq", "optiland"): NO_CURVATURES,
    ("codev/tests/singlet.seq", "optiland"): NO_CURVATURES,
    ("codev/tests/test.seq", "optiland"): NO_CURVATURES,
    ("Fiber_Coupling.ZMX", "optiland"): "takes N15 for another material, of index 0.471",
    ("ZMXFILES/LENS.ZMX", "optiland"): "the file is an empty one, with no glass and an aperture of 0",
}
# A quantity by program and file: why, and what the file says where no other program does.
CUT = "opens the stop past the file's own rim on it"
FLOA = "does not know FLOA, and takes a diameter of 1"
AXIS = "measures along the tilted path; along the first surface's axis it is another"
NO_IMAGE = "takes the last S line for the image; without SI the image is another surface behind it"
PLANE = "takes the paraxial image height where the image surface stands, which is not where the paraxial image is"
ANGLES = "divides the angle of the largest image height, not its tangent, between the others"
THIN = "has thin lenses that do not image the stop into its paraxial pupil"
SLOPE = "takes OBNA for the paraxial slope; it is a sine"


def paraxial_angles(*heights, efl):
    """The axis, and the angles of points this high in the focal plane."""
    return [0.0, *(math.degrees(math.atan(height / efl)) for height in heights)]


VERDICTS = {
    ("zemax_files/lens2.zmx", "rayoptics", "entrance_pupil_diameter_mm"): (CUT, 2 * 6.75),
    ("zemax_files/lens2.zmx", "optiland", "entrance_pupil_diameter_mm"): (CUT, 2 * 6.75),
    ("zmax_49270.zmx", "rayoptics", "entrance_pupil_diameter_mm"): (CUT, 2 * 1.25),
    ("zmax_49270.zmx", "optiland", "entrance_pupil_diameter_mm"): (CUT, 2 * 1.25),
    ("lens_floa.zmx", "rayoptics", "entrance_pupil_diameter_mm"): (FLOA, 2 * 20.23652285518699),
    ("lens_floa.zmx", "rayoptics", "fields_deg"): ("keeps a second field of its own beside the file's one", [0.0]),
    ("lens_floa.zmx", "optiland", "entrance_pupil_diameter_mm"):
        ("takes DIAM, a semi-diameter, for the stop's diameter", 2 * 20.23652285518699),
    ("codev/tests/tilt_test.seq", "rayoptics", "exit_pupil_z_mm"): (AXIS, -200 - 100 * math.sqrt(0.5)),
    ("codev/tests/tilt_test.seq", "optiland", "exit_pupil_z_mm"): (AXIS, -200 - 100 * math.sqrt(0.5)),
    ("codev/tests/dec_rev_tilt_test.seq", "rayoptics", "exit_pupil_z_mm"): (AXIS, -9 - 2.82842712 * math.sqrt(2)),
    ("codev/tests/dec_rev_tilt_test.seq", "optiland", "exit_pupil_z_mm"): (AXIS, -9 - 2.82842712 * math.sqrt(2)),
    ("codev/tests/test.seq", "rayoptics", "bfl_mm"): (NO_IMAGE, 110.65893889728046 - 10),
    ("codev/tests/test.seq", "rayoptics", "exit_pupil_z_mm"): (NO_IMAGE, -2.3035760187603613 - 10),
    # The object is 100 mm off, its image 1 mm high: 1/m = (100 + ffl) / efl. The stop is surface 1.
    ("codev/tests/singlet.seq", "rayoptics", "fields_deg"):
        (PLANE, paraxial_angles((100 - 12.88284833464449) / 100, efl=13.105460925614661)),
    ("paraboloid_f8.seq", "rayoptics", "fields_deg"): (ANGLES,),
    ("US05331467-1.zmx", "rayoptics", "fields_deg"): (PLANE, paraxial_angles(14, 21, efl=999.6387665280338)),
    ("US05331467-1.zmx", "optiland", "fields_deg"): (PLANE, paraxial_angles(14, 21, efl=999.6369653778445)),
    ("US05331467-1_asm.roa", "rayoptics", "fields_deg"): (PLANE, paraxial_angles(14, 21, efl=999.6387665280338)),
    ("singlet_f5.roa", "rayoptics", "fields_deg"):
        (PLANE, paraxial_angles((100 - 12.88284833464449) / 100, efl=13.105460925614661)),
    ("telephoto.roa", "rayoptics", "fields_deg"): (PLANE, paraxial_angles(2, efl=49.847126174629764)),
    ("cell_phone_camera.roa", "rayoptics", "fields_deg"):
        (f"{ANGLES}; {PLANE}", paraxial_angles(0.7071 * 3.5, 3.5, efl=5.555070373138434)),
    ("cell_phone_camera_old.roa", "rayoptics", "fields_deg"):
        (f"{ANGLES}; {PLANE}", paraxial_angles(2.47485, 3.5, efl=5.5870725027251655)),
    ("US007277232_Example04P.roa", "rayoptics", "fields_deg"):
        (ANGLES, paraxial_angles(0.707 * 14.2, 14.2, efl=18.499984343786203)),
    ("Example04P_hikari_glasses.roa", "rayoptics", "fields_deg"):
        (f"{ANGLES}; {PLANE}", paraxial_angles(0.707 * 14.2, 14.2, efl=19.249347121134132)),
    # The object of half that magnification, as far from the paraxial pupil as rayoptics itself has it.
    ("thin_triplet.roa", "rayoptics", "fields_deg"):
        (THIN, paraxial_angles(2 / 0.5, efl=17.22446549861915 + 3.6520037425064817)),
    ("US05831776-1.zmx", "rayoptics", "entrance_pupil_diameter_mm"): (SLOPE,),
    ("US05831776-1.zmx", "rayoptics", "fields_deg"): ("sends its chief ray past the stop's centre by 0.5 mm",),
}
# What our own reader names where it refuses a file for another reason than a surface that is beyond centred lenses.
REFUSALS = {("ZMXFILES/LENS.ZMX",): ["neither an aperture nor the stop's size is stated"],
            ("zemax/tests/ASL5040-UV-Zemax(ZMX).zmx",): ["C79-80"],  # the maker's own name of fused silica
            ("specifications/ASL5040-UV-Zemax(ZMX).zmx",): ["FusedSilica"]}


class Misread(Exception):
    """The program has something else than the file."""


def axis_crossing(height, slope):
    return -height / slope if slope != 0 else math.inf


def oblique_angle(x, y):
    """Degrees between the axis and a direction whose projections lie at these angles."""
    return math.degrees(math.atan(math.hypot(math.tan(math.radians(x)), math.tan(math.radians(y)))))


def distinct(angles):
    found = []
    for angle in sorted(abs(angle) for angle in angles):
        if not found or angle - found[-1] > 1e-9:
            found.append(round(angle, 12))
    return found


def read_with_rayoptics(file):
    from rayoptics.codev import cmdproc
    from rayoptics.gui import roafile
    from rayoptics.zemax import zmxread
    if file.suffix.lower() == ".roa":
        return roafile.open_roa(file)
    return (zmxread.read_lens_file if file.suffix.lower() == ".zmx" else cmdproc.read_lens)(file)[0]


def rayoptics_fields(model, wavelength):
    from rayoptics.raytr import trace
    view = model["optical_spec"]["fov"]
    if view.key == ("object", "angle"):
        return distinct(oblique_angle(field.x, field.y) for field in view.fields)
    angles = []
    for field in view.fields:
        ray = trace.trace_base(model, [0.0, 0.0], field, wavelength)[0]
        angles.append(math.degrees(math.acos(min(1.0, abs(ray[0][1][2])))) if field.x or field.y else 0.0)
    return distinct(angles)


def with_rayoptics(file, table):
    from rayoptics.parax.firstorder import compute_principle_points
    surfaces, wavelength = table["surfaces"], table["wavelength_nm"]
    model = read_with_rayoptics(file)
    sequence, region = model["seq_model"], model["optical_spec"]["wvls"]
    as_read = region.central_wvl
    region.reference_wvl = next(i for i, each in enumerate(region.wavelengths) if math.isclose(each, wavelength))
    stop = next(i for i, each in enumerate(surfaces) if each["stop"])
    sequence.stop_surface = stop
    model.update_model()
    if not math.isclose(sequence.central_wavelength(), wavelength) or len(sequence.ifcs) != len(surfaces):
        raise Misread("has other wavelengths or surfaces than the file")
    wavelength = sequence.central_wavelength()

    first_order = model["analysis_results"]["parax_data"].fod
    n_object, n_image = sequence.z_dir[0] * sequence.central_rndx(0), sequence.z_dir[-1] * sequence.central_rndx(-1)
    unit_height, unit_slope, _ = compute_principle_points(sequence.path(wl=wavelength), sequence.overall_length(),
                                                          n_object, n_image)
    last = max(i for i, each in enumerate(surfaces[:-1]) if each["type"] != "COORDBRK")
    ray = lambda i, ybar, ubar: [ybar * unit_height[i][k] + ubar * unit_slope[i][k] for k in (0, 1)]
    chief = ray(last, -unit_slope[stop][0], unit_height[stop][0])
    afocal = first_order.power == 0
    return [abs(gap.medium.rindex(wavelength)) for gap in sequence.gaps], {
        "efl_mm": math.inf if afocal else float(first_order.efl),
        "bfl_mm": axis_crossing(*ray(last, 1, 0)[:2]),
        "ffl_mm": math.inf if afocal else first_order.ffl,
        "entrance_pupil_z_mm": unit_slope[stop][0] / unit_height[stop][0],
        "exit_pupil_z_mm": 0.0 if stop == last else axis_crossing(*chief)}, {
        "wavelength_nm": as_read, "entrance_pupil_diameter_mm": 2 * abs(float(first_order.enp_radius)),
        "fields_deg": rayoptics_fields(model, wavelength)}


def read_with_optiland(file):
    from optiland.fileio import load_codev_file, load_optiland_file, load_zemax_file
    reading = {".zmx": load_zemax_file, ".seq": load_codev_file, ".json": load_optiland_file}
    return reading[file.suffix.lower()](str(file))


def chief_ray_to(optic, height):
    """The angle of the ray through the stop's centre that meets the image at this height, degrees. Optiland's own real
    image heights are those of rays through the paraxial entrance pupil."""
    from optiland.rays import RealRays
    from scipy.optimize import fsolve
    positions = np.ravel(optic.surfaces.positions)
    start = positions[0] if math.isfinite(positions[0]) else positions[1] - 1
    pupil = float(np.ravel(optic.paraxial.EPL())[0])

    def misses(unknown):
        y, slope = unknown
        cosine = 1 / math.hypot(1, slope)
        optic.surfaces.trace(RealRays(0.0, y, start, 0.0, slope * cosine, cosine, 1.0, optic.primary_wavelength))
        at = lambda i: float(np.ravel(optic.surfaces.y[i])[0])
        return [at(optic.surfaces.stop_index), at(-1) - height]

    slope = math.tan(math.radians(5))
    best = fsolve(misses, [-slope * (pupil - start), slope], xtol=1e-12)
    if max(map(abs, misses(best))) > 1e-8:
        raise Misread(f"no chief ray to {height}")
    return math.degrees(math.atan(abs(best[1])))


def optiland_fields(optic):
    kind, fields = type(optic.fields.field_definition).__name__, optic.fields.fields
    if "Angle" in kind:
        return distinct(oblique_angle(float(field.x), float(field.y)) for field in fields)
    if "RealImage" in kind:
        heights = [math.hypot(float(field.x), float(field.y)) for field in fields]
        return distinct(chief_ray_to(optic, height) if height else 0.0 for height in heights)
    angles = []
    for x, y in optic.fields.get_field_coords():
        rays = optic.ray_tracer.ray_generator.generate_rays(x, y, 0.0, 0.0, optic.primary_wavelength)
        angles.append(math.degrees(math.acos(min(1.0, abs(float(rays.N[0]))))) if x or y else 0.0)
    return distinct(angles)


def with_optiland(file, table):
    surfaces, wavelength = table["surfaces"], table["wavelength_nm"]
    optic = read_with_optiland(file)
    kept = [i for i, each in enumerate(surfaces) if each["type"] != "COORDBRK"]
    if not math.isclose(1000 * optic.primary_wavelength, wavelength) or optic.surfaces.num_surfaces != len(kept):
        raise Misread("has another wavelength or other surfaces than the file")
    paraxial = optic.paraxial
    stop = optic.surfaces.stop_index
    positions = optic.surfaces.build_paraxial_path().axial_positions.reshape(-1, 1)
    parallel = paraxial.trace_generic(1.0, 0.0, positions[1] - 1, optic.primary_wavelength)
    chief = paraxial.trace_generic(0.0, 0.1, positions[stop], optic.primary_wavelength, skip=stop + 1)
    last = lambda rays: [float(values[-2][0]) for values in rays]
    # Optiland takes a coordinate break out of the row; the gap behind it has the index of the one before.
    index_behind = dict(zip(kept, (abs(float(n)) for n in optic.surfaces.n(optic.primary_wavelength).ravel())))
    gaps = []
    for i in range(len(surfaces) - 1):
        gaps.append(index_behind.get(i, gaps[-1] if gaps else 1.0))
    number = lambda value: float(np.ravel(value)[0])
    return gaps, {
        "efl_mm": number(paraxial.f2()), "bfl_mm": axis_crossing(*last(parallel)), "ffl_mm": number(paraxial.F1()),
        "entrance_pupil_z_mm": number(paraxial.EPL()),
        "exit_pupil_z_mm": 0.0 if stop == len(kept) - 2 else axis_crossing(*last(chief))}, {
        "wavelength_nm": 1000 * optic.primary_wavelength,
        "entrance_pupil_diameter_mm": abs(number(paraxial.EPD())), "fields_deg": optiland_fields(optic)}


PROGRAMS = {"rayoptics": with_rayoptics, "optiland": with_optiland}
# Paraxial rays through these would be of the base surface alone: no program's number says anything about the file.
BEYOND_PARAXIAL = {"DGRATING", "QED_TYPE", "DIF"}


def of_file(verdicts, path, *key):
    """The verdict on the file of that path, or None."""
    return next((verdict for (name, *rest), verdict in verdicts.items() if path.endswith(name) and rest == [*key]),
                None)


def reasons_for(program, path, table, data):
    """What the program reads otherwise than the file says, by quantity."""
    reasons = {}
    if not math.isclose(data["wavelength_nm"], table["wavelength_nm"]):
        reasons["wavelength_nm"] = {"why": "takes the middle one of the list, the file names another",
                                    "instead": round(table["wavelength_nm"], 9)}
    if program == "rayoptics" and table["fields"] == 1 and data["fields_deg"] == [0.0, 1.0]:
        reasons["fields_deg"] = {"why": "keeps a second field of its own beside the file's one", "instead": [0.0]}
    for quantity in {**dict.fromkeys(LENGTHS), **dict.fromkeys(QUANTITIES)}:
        verdict = of_file(VERDICTS, path, program, quantity)
        if verdict is not None:
            reasons[quantity] = dict(zip(("why", "instead"), verdict))
    if "entrance_pupil_diameter_mm" in reasons and data["f_number"] is not None:
        reasons["f_number"] = dict(reasons["entrance_pupil_diameter_mm"])
        if "instead" in reasons["f_number"]:
            reasons["f_number"]["instead"] = abs(data["efl_mm"]) / reasons["f_number"]["instead"]
    return reasons


def compute_with(program, path, file, table, scratch):
    # From a copy: rayoptics writes a file about the glasses that it did not find beside the lens's.
    gaps, lengths, read = PROGRAMS[program](pathlib.Path(shutil.copy(file, scratch)), table)
    indices = {}
    for each, index in zip(table["surfaces"], gaps):
        if each["glass"] not in (None, "MIRROR", "___BLANK"):
            if indices.setdefault(each["glass"], index) != index:
                raise Misread(f"{each['glass']} has two indices")
    unit = table["unit_mm"]
    diameter = read["entrance_pupil_diameter_mm"] * unit
    efl = lengths["efl_mm"] * unit
    data = {**{key: lengths[key] * unit if math.isfinite(lengths[key]) else None for key in LENGTHS},
            "wavelength_nm": round(read["wavelength_nm"], 9), "entrance_pupil_diameter_mm": diameter,
            "f_number": abs(efl) / diameter if math.isfinite(efl) and diameter > 0 else None,
            "fields_deg": read["fields_deg"] if table["fields"] != 0 else None}
    return {"program": program, "indices": indices, "gap_indices": gaps, **data,
            "reasons": reasons_for(program, path, table, data)}


def compute(package, path, file, scratch):
    text, encoding = samples.read_text(file)
    table = sample_tables.read_table(file, text)
    beyond_centred = {each["type"] for each in table["surfaces"]} - {"STANDARD", "EVENASPH"}
    if any(each["glass"] == "MIRROR" for each in table["surfaces"]):
        beyond_centred.add("MIRROR")
    sample = {"package": package, "sha256": hashlib.sha256(file.read_bytes()).hexdigest(), "encoding": encoding,
              "wavelength_nm": round(table["wavelength_nm"], 9),
              "needs": sorted(beyond_centred) + (of_file(REFUSALS, path) or []), "computed": [], "without": {}}
    for program in PROGRAMS:
        misread = of_file(MISREAD, path, program)
        if misread is None and (program, file.suffix) in (("rayoptics", ".json"), ("optiland", ".roa")):
            misread = "reads no such file"
        if misread is None and beyond_centred & BEYOND_PARAXIAL:
            misread = "what the surface does to rays is beyond its paraxial trace"
        if misread is None:
            try:
                sample["computed"].append(compute_with(program, path, file, table, scratch))
            except Exception as error:  # whatever keeps a program from reading its own sample
                misread = f"fails: {type(error).__name__}: {' '.join(str(error).split())[:90]}"
        if misread is not None:
            sample["without"][program] = misread
            print(f"{program} has no numbers for {file.name}: {misread}", file=sys.stderr)
    return sample


def main():
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    samples.fetch(FOLDER)
    result = {"programs": {name: version(name) for name in ("rayoptics", "optiland", "opticalglass")}, "samples": {}}
    with tempfile.TemporaryDirectory() as scratch:
        for archive in samples.ARCHIVES:
            place = samples.place_of(archive, FOLDER)
            for file in sorted(place.rglob("*")):
                if file.is_file():
                    path = str(file.relative_to(place))
                    result["samples"][path] = compute(archive["package"], path, file, scratch)
    text = json.dumps(result, indent=1)
    text = re.sub(r"\[[^\[\]{}]*\]", lambda numbers: " ".join(numbers[0].split()), text)  # a list on one line
    (HERE / "first_order.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
