"""Computes first_order.json, what rayoptics and Optiland say of the Zemax files that they ship.

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

Lengths are in mm: the entrance pupil and the front focal point from the file's surface 1, the exit pupil and the rear
focal point from its last surface before the image, dummies included; positive towards +z. null is at infinity.
"""
import hashlib, json, logging, math, pathlib, re, shutil, sys, tempfile, warnings
from importlib.metadata import version

sys.dont_write_bytecode = True
import samples

HERE = pathlib.Path(__file__).parent
FOLDER = HERE.parents[2] / "build" / "other_programs"
LENGTHS = ("efl_mm", "bfl_mm", "ffl_mm", "entrance_pupil_z_mm", "exit_pupil_z_mm")
MM_PER_UNIT = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "METER": 1000.0}


def read_table(text):
    """What a comparison needs to know about a file: its surfaces, unit and primary wavelength (nm)."""
    surfaces, wavelengths, primary, unit = [], {}, 1, "MM"
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "SURF":
            surfaces.append({"type": "STANDARD", "glass": None, "stop": False})
        elif words[0] == "UNIT":
            unit = words[1]
        elif words[0] == "WAVM":
            wavelengths[int(words[1])] = 1000 * float(words[2])
        elif words[0] == "PWAV":
            primary = int(words[1])
        elif words[0] == "TYPE":
            surfaces[-1]["type"] = words[1]
        elif words[0] == "GLAS":
            surfaces[-1]["glass"] = words[1]
        elif words[0] == "STOP":
            surfaces[-1]["stop"] = True
    return surfaces, wavelengths[primary], MM_PER_UNIT[unit]


def axis_crossing(height, slope):
    return -height / slope if slope != 0 else math.inf


def with_rayoptics(file, surfaces, wavelength):
    from rayoptics.parax.firstorder import compute_principle_points
    from rayoptics.zemax import zmxread
    model, _ = zmxread.read_lens_file(file)
    sequence, region = model["seq_model"], model["optical_spec"]["wvls"]
    region.reference_wvl = region.wavelengths.index(wavelength)
    stop = next(i for i, surface in enumerate(surfaces) if surface["stop"])
    sequence.stop_surface = stop
    model.update_model()
    if sequence.central_wavelength() != wavelength or len(sequence.ifcs) != len(surfaces):
        raise RuntimeError("rayoptics has other wavelengths or surfaces than the file")

    first_order = model["analysis_results"]["parax_data"].fod
    n_object, n_image = sequence.z_dir[0] * sequence.central_rndx(0), sequence.z_dir[-1] * sequence.central_rndx(-1)
    unit_height, unit_slope, _ = compute_principle_points(sequence.path(wl=wavelength), sequence.overall_length(),
                                                          n_object, n_image)
    last = max(i for i, surface in enumerate(surfaces[:-1]) if surface["type"] != "COORDBRK")
    ray = lambda i, ybar, ubar: [ybar * unit_height[i][k] + ubar * unit_slope[i][k] for k in (0, 1)]
    chief = ray(last, -unit_slope[stop][0], unit_height[stop][0])
    afocal = first_order.power == 0
    return [abs(gap.medium.rindex(wavelength)) for gap in sequence.gaps], {
        "efl_mm": math.inf if afocal else first_order.efl,
        "bfl_mm": axis_crossing(*ray(last, 1, 0)[:2]),
        "ffl_mm": math.inf if afocal else first_order.ffl,
        "entrance_pupil_z_mm": unit_slope[stop][0] / unit_height[stop][0],
        "exit_pupil_z_mm": 0.0 if stop == last else axis_crossing(*chief)}


def with_optiland(file, surfaces, wavelength):
    from optiland.fileio import load_zemax_file
    optic = load_zemax_file(str(file))
    kept = [i for i, surface in enumerate(surfaces) if surface["type"] != "COORDBRK"]
    if not math.isclose(1000 * optic.primary_wavelength, wavelength) or optic.surfaces.num_surfaces != len(kept):
        raise RuntimeError("Optiland has another wavelength or other surfaces than the file")
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
    return gaps, {
        "efl_mm": float(paraxial.f2()), "bfl_mm": axis_crossing(*last(parallel)), "ffl_mm": float(paraxial.F1()),
        "entrance_pupil_z_mm": float(paraxial.EPL()),
        "exit_pupil_z_mm": 0.0 if stop == len(kept) - 2 else axis_crossing(*last(chief))}


PROGRAMS = {"rayoptics": with_rayoptics, "optiland": with_optiland}
# Paraxial rays through these would be of the base surface alone: no program's number says anything about the file.
BEYOND_PARAXIAL = {"DGRATING", "QED_TYPE"}


def compute(package, file, scratch):
    text, encoding = samples.read_text(file)
    surfaces, wavelength, unit = read_table(text)
    beyond_centred = {surface["type"] for surface in surfaces} - {"STANDARD", "EVENASPH"}
    if any(surface["glass"] == "MIRROR" for surface in surfaces):
        beyond_centred.add("MIRROR")
    sample = {"package": package, "sha256": hashlib.sha256(file.read_bytes()).hexdigest(), "encoding": encoding,
              "wavelength_nm": round(wavelength, 9), "needs": sorted(beyond_centred), "computed": []}
    for program, computing in PROGRAMS.items():
        if beyond_centred & BEYOND_PARAXIAL:
            continue
        try:
            # From a copy: rayoptics writes a file about the glasses that it did not find beside the lens's.
            gaps, data = computing(pathlib.Path(shutil.copy(file, scratch)), surfaces, wavelength)
        except Exception as error:  # whatever keeps a program from reading its own sample
            print(f"{program} has no numbers for {file.name}: {type(error).__name__}: {str(error)[:150]}",
                  file=sys.stderr)
            continue
        indices = {}
        for surface, index in zip(surfaces, gaps):
            if surface["glass"] not in (None, "MIRROR", "___BLANK"):
                if indices.setdefault(surface["glass"], index) != index:
                    raise RuntimeError(f"{program}: {surface['glass']} has two indices in {file.name}")
        sample["computed"].append(
            {"program": program, "indices": indices, "gap_indices": gaps,
             **{key: data[key] * unit if math.isfinite(data[key]) else None for key in LENGTHS}})
    return sample


def main():
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    samples.fetch(FOLDER)
    result = {"programs": {name: version(name) for name in ("rayoptics", "optiland", "opticalglass")}, "samples": {}}
    with tempfile.TemporaryDirectory() as scratch:
        for archive in samples.ARCHIVES:
            place = FOLDER / f"{archive['package']}-{archive['version']}"
            for file in sorted(place.rglob("*")):
                if file.is_file():
                    result["samples"][str(file.relative_to(place))] = compute(archive["package"], file, scratch)
    text = json.dumps(result, indent=1)
    text = re.sub(r"\[[^\[\]{}]*\]", lambda numbers: " ".join(numbers[0].split()), text)  # a list on one line
    (HERE / "first_order.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
