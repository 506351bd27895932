"""Lens files that other programs ship: other_programs_test.py LENSPROOF FOLDER [TABLE]

LENSPROOF is the built program, FOLDER keeps the files that pip fetched; TABLE is written if given, as Markdown (.md) or
CSV. Each file must read, and its first-order data, f-number, fields and primary wavelength must be what rayoptics and
Optiland make of it (other_programs/first_order.json, which says how it was made). Archives that pip cannot fetch are
left out, and then this exits with 77 (skipped) if all else holds.

Every glass gets the very index that the other program took for it, because catalogues differ in the last digits, and
some glasses are in nobody's catalogue. What is left to compare is the reading of the file and a paraxial trace, the
same arithmetic in double precision everywhere. Where both programs happen to use equal indices they agree to 1e-13, at
worst to 1e-12 where a back focus is a small difference of long distances; a trace with 50 digits agrees with each as
closely. 1e-9 leaves three decades for other orders of summation, and is finer than any mistake in a digit that could
be made: a curvature read as a float is off by 1e-8 already. A length that should be zero may be off by 1e-12 of the
longest.

F-number, entrance pupil, fields and wavelength are held to 1e-4: rayoptics has infinity 1e10 mm away, which alone costs
up to 1e-7, and aims its chief rays to 1e-5. A program that reads one of them otherwise than the file says has a named
reason in first_order.json; then the number is the other program's, or what the reason says instead. The f-number is
taken without a sign, and in files with mirrors so are all lengths behind the first vertex: both programs give a lone
concave mirror a negative focal length, here it is positive, as a lens's of the same use; and where the axis is folded,
here it is unfolded and goes on along +z.

Distances count from the file's first surface and its last one before the image, flat surfaces in air included, but not
coordinate breaks.

A file may hold what a reader of centred lenses does not understand (`needs` in first_order.json: mirrors, gratings).
Then either the numbers agree, or there are none and a message names what was not understood. Of some (UNDERSTOOD) no
program has numbers, but ours.
"""
import csv, hashlib, json, pathlib, subprocess, sys, tempfile

sys.dont_write_bytecode = True
from other_programs import sample_tables, samples

SKIPPED = 77
TOLERANCE = 1e-9
ROUND_OFF = 1e-12
LENGTHS = ("efl_mm", "bfl_mm", "ffl_mm", "entrance_pupil_z_mm", "exit_pupil_z_mm")
SIGNED_BY_CONVENTION = ("efl_mm", "bfl_mm", "exit_pupil_z_mm")  # in files with mirrors
# Mirrors of power off the axis, which a first order along one axis says nothing of: rayoptics and Optiland leave tilts
# out, here distances are those along the first surface's axis.
OFF_AXIS = ("HoO-V2C18Ex46.zmx", "HoO-V2C18Ex66.zmx", "HoO-V2C18Ex66NEW.zmx", "dec_test.seq")
UNDERSTOOD = {"MIRROR", "COORDBRK", "DGRATING", "DIF", "QED_TYPE", "C79-80", "FusedSilica"}
SETTINGS_TOLERANCE = 1e-4
FIELD_ROUND_OFF_DEG = 1e-7
SETTINGS = ("wavelength_nm", "efl_mm", "entrance_pupil_diameter_mm", "f_number", "fields_deg")
COLUMNS = ("package", "file", "read", "analysed", "against rayoptics and Optiland")


def run(program, command, file, indices, *options):
    """Exit status, the parsed JSON or None, and everything that the program said."""
    line = [program, command, str(file), "--json", "-", *options]
    for name, index in indices.items():
        line += ["--index", f"{name}={index!r}"]
    done = subprocess.run(line, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    try:
        result = json.loads(done.stdout) if done.returncode in (0, 1) else None
    except ValueError:
        result = None
    return done.returncode, result, done.stdout + done.stderr


def check(program, file, wavelength, indices):
    status, result, said = run(program, "check", file, indices, "--wavelength", repr(wavelength))
    return status, (result or {}).get("lenses", [None])[0], said


def analyze(program, file, indices):
    """Exit status, the numbers of SETTINGS or None, and everything that the program said."""
    status, result, said = run(program, "analyze", file, indices, "--rings", "2", "--threads", "1")
    if result is None:
        return status, None, said
    paraxial = result["paraxial"]
    return status, {
        "wavelength_nm": result["reference_wavelength_nm"], "efl_mm": paraxial["efl_mm"],
        "entrance_pupil_diameter_mm": paraxial["entrance_pupil_diameter_mm"],
        "f_number": None if paraxial["f_number"] is None else abs(paraxial["f_number"]),
        "fields_deg": sorted({abs(field["field_deg"]) for field in result["fields"]})}, said


def with_constant_glasses(file, gap_indices, folder):
    """The file, or where it has glasses that have no name to override a copy with constants in their place: programs
    model the dispersion of such a glass differently."""
    text, encoding = samples.read_text(file)
    changed = sample_tables.with_constants(file, text, gap_indices)
    if changed.split() == text.split():
        return file
    copy = folder / file.name
    copy.write_text(changed, encoding=encoding.replace("ISO ", "iso"))
    return copy


def names_a_need(status, said, sample):
    return status in (0, 1, 2) and any(need.lower() in said.lower() for need in sample["needs"])


def without_signs(numbers):
    return {key: abs(value) if key in SIGNED_BY_CONVENTION and value is not None else value
            for key, value in numbers.items()}


def length_disagreements(found, expected):
    """Each length that differs, in words. What a reason says instead stands for the program's number."""
    expected = {**expected, **{key: each["instead"] for key, each in expected["reasons"].items() if "instead" in each}}
    longest = max((abs(expected[key]) for key in LENGTHS if expected[key] is not None), default=0.0)
    wrong = []
    for key in LENGTHS:
        is_value, should = found.get(key), expected[key]
        if is_value is None or should is None:
            if is_value is not should:
                wrong.append(f"{key} is {is_value}, expected {should}")
        elif abs(is_value - should) > max(TOLERANCE * abs(should), ROUND_OFF * longest):
            wrong.append(f"{key} is {is_value!r}, expected {should!r}")
    return wrong


def is_close(found, expected):
    if isinstance(expected, list) and isinstance(found, list):
        return len(found) == len(expected) and all(
            abs(a - b) <= SETTINGS_TOLERANCE * abs(b) + FIELD_ROUND_OFF_DEG for a, b in zip(found, expected))
    if found is None or expected is None:
        return found is expected
    return abs(found - expected) <= SETTINGS_TOLERANCE * abs(expected)


def setting_disagreements(found_by, computed):
    """What differs from a program's numbers for no reason, and the reasons of what differs for one. found_by: what was
    found with each program's indices."""
    wrong, reasons = [], []
    agrees = {(each["program"], key): is_close(found_by[each["program"]][key], each[key])
              for each in computed for key in SETTINGS}
    for each in computed:
        found = found_by[each["program"]]
        for key in SETTINGS:
            if agrees[each["program"], key] or (key == "fields_deg" and each[key] is None):
                continue
            reason = each["reasons"].get(key)
            says_otherwise = reason is not None and (
                is_close(found[key], reason["instead"]) if "instead" in reason
                else any(agrees[other["program"], key] for other in computed))
            if says_otherwise:
                reasons.append((reason["why"], each["program"], key))
            else:
                wrong.append(f"{key} as {each['program']} is {found[key]}, expected {each[key]}")
    return wrong, reasons


def message(said, file):
    """What the program refused a file for, without its name."""
    text = said.strip().splitlines()[-1].removeprefix("lensproof: ").replace(str(file), "").lstrip(": ")
    return text if len(text) <= 110 else text[:107] + "..."


def in_words(reasons):
    """Each reason once, with the programs and the quantities that it is for."""
    for why in dict.fromkeys(why for why, _, _ in reasons):
        programs, keys = (" and ".join(dict.fromkeys(each[i] for each in reasons if each[0] == why)) for i in (1, 2))
        yield f"{keys}: {programs} {why}"


class Outcome:
    """What came of a file: a row of the table."""

    def __init__(self, package, name):
        self.package, self.name = package, name
        self.read = self.analysed = "no"
        self.wrong, self.reasons, self.held = [], [], False
        self.without = ""

    def row(self):
        if self.wrong:
            verdict = "FAILED: " + "; ".join(self.wrong)
        elif self.held:
            verdict = "; ".join(["agrees", *in_words(self.reasons)])
        else:
            verdict = self.without
        return [self.package, self.name, self.read, self.analysed, verdict]


def test_sample(program, path, sample, place, scratch):
    outcome = Outcome(sample["package"], path.rsplit("/", 1)[-1])
    file = place / path
    if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != sample["sha256"]:
        outcome.wrong.append("the file is not that which first_order.json was computed from")
        return outcome
    _, result, said = check(program, file, sample["wavelength_nm"], {})
    outcome.read = "yes" if result is not None else message(said, file)
    status, plain, said = analyze(program, file, {})
    outcome.analysed = "yes" if plain is not None else message(said, file)
    if outcome.name in OFF_AXIS:
        outcome.without = "not compared: its mirrors of power stand off the axis"
        return outcome
    if not sample["computed"]:
        understood = plain is not None and set(sample["needs"]) <= UNDERSTOOD
        if not understood and not names_a_need(status, said, sample):
            outcome.wrong.append(f"one of {', '.join(sample['needs']) or 'no needs'} is named")
        outcome.without = "no numbers: " + "; ".join(f"{who} {why}" for who, why in sample["without"].items())
        return outcome
    found_by = {}
    for computed in map(without_signs, sample["computed"]) if "MIRROR" in sample["needs"] else sample["computed"]:
        as_program = computed["program"]
        constant = with_constant_glasses(file, computed["gap_indices"], scratch)
        indices = computed["indices"] if file.suffix.lower() == ".zmx" else {}
        status, result, said = check(program, constant, sample["wavelength_nm"], indices)
        numbers = (result or {}).get("computed") or {}
        if "MIRROR" in sample["needs"]:
            numbers = without_signs(numbers)
        if numbers:
            outcome.wrong += [f"{each} as {as_program}" for each in length_disagreements(numbers, computed)]
        elif not names_a_need(status, said, sample):
            outcome.wrong.append(f"no numbers as {as_program}: {message(said, constant)}")
        status, found, said = analyze(program, constant, indices)
        if found is not None:
            found_by[as_program] = without_signs(found) if "MIRROR" in sample["needs"] else found
        elif not names_a_need(status, said, sample):
            outcome.wrong.append(f"no analysis as {as_program}: {message(said, constant)}")
    compared = [without_signs(each) if "MIRROR" in sample["needs"] else each
                for each in sample["computed"] if each["program"] in found_by]
    wrong, outcome.reasons = setting_disagreements(found_by, compared)
    outcome.wrong += wrong
    outcome.held = bool(compared)
    outcome.without = "refused: one of " + ", ".join(sample["needs"]) + " is named"
    return outcome


def write_table(outcomes, file):
    rows = [outcome.row() for outcome in outcomes]
    with file.open("w", newline="", encoding="utf-8") as out:
        if file.suffix == ".md":
            for row in [COLUMNS, ["---"] * len(COLUMNS), *rows]:
                out.write("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |\n")
        else:
            csv.writer(out).writerows([COLUMNS, *rows])


def fetch(folder):
    """The archives that are there, and why others are not."""
    there, missing = [], []
    for archive in samples.ARCHIVES:
        try:
            samples.fetch(folder, [archive])
            there.append(archive)
        except samples.Unavailable as reason:
            missing.append(f"{archive['package']} {archive['version']}: {reason}")
    return {each["package"]: samples.place_of(each, folder) for each in there}, missing


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    places, missing = fetch(folder)
    reference = json.loads((pathlib.Path(__file__).parent / "other_programs" / "first_order.json").read_text())
    outcomes = []
    with tempfile.TemporaryDirectory() as scratch:
        for path, sample in reference["samples"].items():
            if sample["package"] in places:
                outcome = test_sample(program, path, sample, places[sample["package"]], pathlib.Path(scratch))
                print(" | ".join(outcome.row()), flush=True)
                outcomes.append(outcome)
    if len(sys.argv) > 3:
        write_table(outcomes, pathlib.Path(sys.argv[3]))
    for reason in missing:
        print(f"left out: its samples could not be fetched: {reason}")
    failed = sum(bool(outcome.wrong) for outcome in outcomes)
    count = lambda holds: sum(map(holds, outcomes))
    print(f"{len(outcomes)} files: {count(lambda o: o.read == 'yes')} read, "
          f"{count(lambda o: o.analysed == 'yes')} analysed, {count(lambda o: o.held and not o.wrong)} agreeing, "
          f"{count(lambda o: o.analysed != 'yes')} refused, {failed} failed")
    return 1 if failed else SKIPPED if missing else 0


if __name__ == "__main__":
    sys.exit(main())
