"""Zemax files that other programs ship: other_programs_test.py LENSPROOF FOLDER

LENSPROOF is the built program, FOLDER keeps the files that pip fetched. Each file must read, and its first-order data
must be what rayoptics and Optiland compute of it (other_programs/first_order.json, which says how it was made). Without
pip or a package index this says so and exits with 77 (skipped).

Every glass gets the very index that the other program took for it, because catalogues differ in the last digits, and
some glasses are in nobody's catalogue. What is left to compare is the reading of the file and a paraxial trace, the
same arithmetic in double precision everywhere. Where both programs happen to use equal indices they agree to 1e-13, at
worst to 1e-12 where a back focus is a small difference of long distances; a trace with 50 digits agrees with each as
closely. 1e-9 leaves three decades for other orders of summation, and is finer than any mistake in a digit that could
be made: a curvature read as a float is off by 1e-8 already. A length that should be zero may be off by 1e-12 of the
longest.

Distances count from the file's first surface and its last one before the image, flat surfaces in air included, but not
coordinate breaks.

A file may hold what a reader of centred lenses does not understand (`needs` in first_order.json: mirrors, coordinate
breaks, gratings). Then either the numbers agree, or there are none and a message names what was not understood.
"""
import hashlib, json, pathlib, re, subprocess, sys, tempfile

sys.dont_write_bytecode = True
from other_programs import samples

SKIPPED = 77
TOLERANCE = 1e-9
ROUND_OFF = 1e-12
LENGTHS = ("efl_mm", "bfl_mm", "ffl_mm", "entrance_pupil_z_mm", "exit_pupil_z_mm")

failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)
    print(("ok      " if holds else "FAILED  ") + what)


def with_constant_model_glasses(file, gap_indices, folder):
    """The file, or where it has glasses without a name (___BLANK, n_d, V_d) a copy that states them as constants.

    Programs model the dispersion of such a glass differently, and there is no name to override it by. V_d = 0 is how
    Zemax says that an index holds at every wavelength.
    """
    text, encoding = samples.read_text(file)
    surface = -1
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if line.startswith("SURF"):
            surface += 1
        if line.lstrip().startswith("GLAS ___BLANK "):
            lines[i] = re.sub(r"(GLAS ___BLANK \S+ \S+) \S+ \S+", rf"\g<1> {gap_indices[surface]!r} 0", line)
    if lines == text.splitlines():
        return file
    copy = folder / file.name
    copy.write_text("\n".join(lines) + "\n", encoding=encoding.replace("ISO ", "iso"))
    return copy


def names_a_need(status, said, sample):
    return status in (0, 1, 2) and any(need in said for need in sample["needs"])


def check(program, file, wavelength, indices):
    """Exit status, the parsed JSON or None, and everything that the program said."""
    command = [program, "check", str(file), "--wavelength", repr(wavelength), "--json", "-"]
    for name, index in indices.items():
        command += ["--index", f"{name}={index!r}"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    try:
        result = json.loads(done.stdout)["lenses"][0] if done.returncode in (0, 1) else None
    except (ValueError, LookupError, TypeError):
        result = None
    return done.returncode, result, done.stdout + done.stderr


def disagreements(found, expected):
    """Each length that differs, in words; and the largest relative difference."""
    longest = max((abs(expected[key]) for key in LENGTHS if expected[key] is not None), default=0.0)
    wrong, worst = [], 0.0
    for key in LENGTHS:
        is_value, should = found.get(key), expected[key]
        if is_value is None or should is None:
            if is_value is not should:
                wrong.append(f"{key} is {is_value}, expected {should}")
            continue
        difference = abs(is_value - should)
        if difference > TOLERANCE * abs(should) + ROUND_OFF * longest:
            wrong.append(f"{key} is {is_value!r}, expected {should!r}")
        worst = max(worst, difference / max(abs(should), ROUND_OFF * longest, sys.float_info.min))
    return wrong, worst


def test_numbers(program, name, file, sample, computed, scratch):
    label = f"{name} as {computed['program']}"
    file = with_constant_model_glasses(file, computed["gap_indices"], scratch)
    status, result, said = check(program, file, sample["wavelength_nm"], computed["indices"])
    found = (result or {}).get("computed") or {}
    if sample["needs"] and not found:
        expect(names_a_need(status, said, sample),
               f"{label}: no numbers, but one of {', '.join(sample['needs'])} is named")
        return
    if result is None:
        expect(False, f"{label}: reads; exit status {status}: {said.strip()[:300]}")
        return
    wrong, worst = disagreements(found, computed)
    expect(not wrong, f"{label}: " + ("; ".join(wrong) if wrong else f"agrees to {worst:.0e}"))


def test_sample(program, path, sample, folder, scratch):
    name = path.rsplit("/", 1)[-1]
    version = next(a["version"] for a in samples.ARCHIVES if a["package"] == sample["package"])
    file = folder / f"{sample['package']}-{version}" / path
    if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != sample["sha256"]:
        expect(False, f"{name}: the file is that which first_order.json was computed from")
        return
    for computed in sample["computed"]:
        test_numbers(program, name, file, sample, computed, scratch)
    if not sample["computed"]:
        # A grating or a freeform must be named; a fold that was too much for both programs may also be understood.
        status, _, said = check(program, file, sample["wavelength_nm"], {})
        understood = status in (0, 1) and set(sample["needs"]) <= {"MIRROR", "COORDBRK"}
        expect(understood or names_a_need(status, said, sample),
               f"{name}: one of {', '.join(sample['needs'])} is named")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    try:
        samples.fetch(folder)
    except samples.Unavailable as reason:
        print(f"skipped: the samples could not be fetched: {reason}")
        return SKIPPED
    reference = json.loads((pathlib.Path(__file__).parent / "other_programs" / "first_order.json").read_text())
    with tempfile.TemporaryDirectory() as scratch:
        for path, sample in reference["samples"].items():
            test_sample(program, path, sample, folder, pathlib.Path(scratch))
    print(f"{len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
