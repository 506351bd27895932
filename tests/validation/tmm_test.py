"""Thin films against another program: tmm_test.py LENSPROOF FOLDER

LENSPROOF is the built program, FOLDER keeps what pip fetched: tmm (Byrnes, arXiv:1603.02720), which multiplies transfer
matrices of forward and backward waves where lensproof multiplies matrices of tangential fields. Without pip or a package
index this says so and exits with 77 (skipped).

What is compared is what `lensproof coatings FILE --on INDEX --angles … --wavelengths … --json -` prints: reflectance,
transmittance and absorptance of s and p, from air and from the glass, beyond the critical angle too. Stacks are random:
1 to 12 layers, indices 0.1 to 5, two of three layers absorbing, κ from 1e-6 to 4; a metal among them leaves light of no
use behind it, which both have to say alike.

Both compute in double precision. A power is a product of some ten operations a layer on complex numbers, so that
rounding leaves 12 · 10 · 1e-16, and some ten times that where waves all but cancel: 1e-12.
"""
import itertools, json, math, pathlib, random, subprocess, sys, tempfile, warnings

sys.dont_write_bytecode = True
from fetched import fetch

SKIPPED = 77
PACKAGES = ("tmm==0.2.0", "numpy==1.26.4")
SUBSTRATES = 6
STACKS = 8  # on each
WAVELENGTHS_NM = (405.0, 550.0, 700.0)
ANGLES_DEG = (0.0, 17.3, 41.0, 56.7, 75.0, 89.0)
TOLERANCE = 1e-12


def random_stack(chance):
    """(n, κ, thickness in nm) from air to glass."""
    def layer():
        kappa = 0.0 if chance.random() < 1 / 3 else 10.0 ** chance.uniform(-6.0, math.log10(4.0))
        return chance.uniform(0.1, 5.0), kappa, 10.0 ** chance.uniform(0.0, 2.7)
    return [layer() for _ in range(chance.randint(1, 12))]


def powers_said(program, stacks, substrate, folder):
    """Of each stack, by (wavelength, angle, side): s and p as `coatings` prints them."""
    files = []
    for i, stack in enumerate(stacks):
        layers = ",\n".join(f"  {{ n = {n!r}, k = {k!r}, thickness_nm = {d!r} }}" for n, k, d in stack)
        files.append(folder / f"stack{i}.toml")
        files[-1].write_text(f'name = "stack"\nsource = "made up for a test"\nlayers = [\n{layers}\n]\n')
    listed = lambda values: ",".join(repr(value) for value in values)
    done = subprocess.run([program, "coatings", *map(str, files), "--on", repr(substrate), "--angles",
                           listed(ANGLES_DEG), "--wavelengths", listed(WAVELENGTHS_NM), "--json", "-"],
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        raise RuntimeError(f"lensproof coatings ended with {done.returncode}: {done.stderr.strip()}")
    return [{(at["wavelength_nm"], at["angle_deg"], at["from"]): at for at in coating["powers"]}
            for coating in json.loads(done.stdout)["coatings"]]


def powers_by_tmm(polarisation, stack, substrate, wavelength, angle_deg, side):
    import tmm
    indices = [1.0, *(complex(n, k) for n, k, _ in stack), substrate]
    thicknesses = [math.inf, *(d for _, _, d in stack), math.inf]
    if side == "glass":
        indices.reverse()
        thicknesses.reverse()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = tmm.coh_tmm(polarisation, indices, thicknesses, math.radians(angle_deg), wavelength)
    return {"reflectance": float(found["R"]), "transmittance": float(found["T"]),
            "absorptance": 1.0 - float(found["R"]) - float(found["T"])}


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    reason = fetch(folder, PACKAGES, dependencies=False)
    if reason:
        print(f"skipped: the package could not be fetched: {reason}")
        return SKIPPED
    chance = random.Random(2016)
    worst, compared, absorbing, total, failures = 0.0, 0, 0, 0, 0
    for _ in range(SUBSTRATES):
        substrate, stacks = chance.uniform(1.3, 2.1), [random_stack(chance) for _ in range(STACKS)]
        with tempfile.TemporaryDirectory() as scratch:
            all_said = powers_said(program, stacks, substrate, pathlib.Path(scratch))
        for stack, said in zip(stacks, all_said, strict=True):
            assert len(said) == 2 * len(WAVELENGTHS_NM) * len(ANGLES_DEG)
            for ((wavelength, angle, side), at), polarisation in itertools.product(said.items(), "sp"):
                expected = powers_by_tmm(polarisation, stack, substrate, wavelength, angle, side)
                off = max(abs(at[polarisation][key] - value) for key, value in expected.items())
                worst, compared = max(worst, off), compared + 1
                absorbing += expected["absorptance"] > 0.1
                total += side == "glass" and substrate * math.sin(math.radians(angle)) > 1.0
                if not off <= TOLERANCE:
                    failures += 1
                    print(f"FAILED  {stack} on {substrate!r}, {wavelength} nm, {angle} deg from {side}, "
                          f"{polarisation}: {at[polarisation]}, tmm has {expected}: off by {off:.1e}")
    print(f"{compared} cases ({absorbing} that absorb more than a tenth, {total} beyond the critical angle): "
          f"R, T and A agree to {worst:.1e}; {failures} failed")
    return 0 if failures == 0 and absorbing > compared / 4 and total > compared / 10 else 1


if __name__ == "__main__":
    sys.exit(main())
