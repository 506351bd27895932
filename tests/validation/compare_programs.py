"""compare_programs.py LENSPROOF [BENCHMARK]: this project against rayoptics and Optiland, on the same rays.

    python3 -m venv build/programs
    build/programs/bin/pip install rayoptics==0.9.8 optiland==0.6.3 mpmath numpy
    build/programs/bin/python tests/validation/compare_programs.py build/release/experiments/lensproof \\
        build/release/tests/benchmarks/lensproof_benchmark

Writes the tables of README.md beside it, between its two marks; without BENCHMARK only that of agreement. Every
program gets the same surfaces, the same indices (d) and the same rays, as points and unit vectors in double
precision, and follows them past rims. What is true of each ray is computed with 50 digits (reference_numbers). Run by
hand, on one core; one to two minutes.
"""
import json, logging, math, os, pathlib, random, re, subprocess, sys, tempfile, time, warnings

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "reference_numbers"))
warnings.simplefilter("ignore")
logging.disable(logging.CRITICAL)
import numpy as np
from mpmath import mp, mpf

import exact_rays, third_order
from make_reference import D, LENSES, lens_file
from prescription import at_wavelength, read_lens

mp.dps = 50
CASES = {"tessar": 24, "double-gauss-lowenthal": 13, "muller-fisheye": 72, "fisheye-220": 105, "conic-aspheres": 20}
LAUNCHES = {"∞": math.inf, "500 mm": 500.0, "1e8 mm": 1e8}
RAYS = 250


# The rays and what is true of them.

def aimed_rays(lens, largest_deg, distance, spread, seed):
    """Rays around chief rays of random fields, over a disc of `spread` times the entrance pupil."""
    rng = random.Random(seed)
    radius = float(third_order.first_order(lens)["entrance_pupil_diameter_mm"]) / 2 * spread
    aiming = exact_rays.ChiefAiming(lens)
    rays = []
    for _ in range(RAYS // 10):
        field = math.radians(rng.uniform(0, largest_deg if math.isinf(distance) else min(largest_deg, 60)))
        (p, d) = [[float(x) for x in v] for v in aiming.at_field(mpf(field))]
        for _ in range(10):
            r, turn = radius * math.sqrt(rng.random()), rng.uniform(0, 2 * math.pi)
            a, b = r * math.cos(turn), r * math.sin(turn)
            if math.isinf(distance):
                start = [p[0] + a - 20 * d[0], p[1] + b * d[2] - 20 * d[1], p[2] - b * d[1] - 20 * d[2]]
                direction = d
            else:
                start = [0.0, p[1] - math.tan(field) * (distance + p[2]), -distance]
                direction = [p[0] + a - start[0], p[1] + b - start[1], p[2] - start[2]]
            length = math.sqrt(sum(x * x for x in direction))
            rays.append((start, [x / length for x in direction]))
    return rays


def truth(lens, rays):
    """For each ray: (status, x, y at the image plane, within every rim, never backwards)."""
    results = []
    for start, direction in rays:
        traced = exact_rays.trace(lens.surfaces, start, direction)
        onwards = all(hit.s >= 0 for hit in traced.hits)
        if traced.status == "ok":
            point, _ = exact_rays.at_plane(traced.last, lens.image_z)
            results.append(("ok", float(point[0]), float(point[1]), traced.clipped is None, onwards))
        else:
            results.append((traced.status, 0.0, 0.0, False, onwards))
    return results


# The programs. Each returns (status or "nan", x, y) for every ray.

class Lensproof:
    name = "lensproof"

    def __init__(self, program):
        self.program = program

    def build(self, lens, name):
        self.lens = str(lens_file(name))

    def trace_file(self, rays):
        """What the command writes."""
        with tempfile.TemporaryDirectory() as scratch:
            file = pathlib.Path(scratch) / "rays.csv"
            file.write_text("id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\n" + "".join(
                ",".join([str(i), *(repr(x) for x in (*p, *d)), repr(D)]) + "\n" for i, (p, d) in enumerate(rays)))
            done = subprocess.run([self.program, "trace", self.lens, "--rays", str(file), "--no-clip", "--threads", "1"],
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True)
        return done.stdout

    def trace(self, rays):
        last = {}
        for line in self.trace_file(rays).splitlines()[1:]:
            cells = line.split(",")
            last[int(cells[0])] = cells
        results = []
        for i in range(len(rays)):
            surface, x, y, status = last[i][1], float(last[i][2]), float(last[i][3]), last[i][10]
            results.append(("ok" if surface == "image" else status, x, y))
        return results


class RayOptics:
    name = "rayoptics 0.9.8"

    def build(self, lens, name):
        from rayoptics.elem import profiles, surface
        none = (np.identity(3), np.zeros(3))
        self.path = [[surface.Surface(), None, none, 1.0, 1]]
        rows = lens.surfaces
        for i, s in enumerate(rows):
            if s.asphere:
                # Its first coefficient is that of r².
                terms = dict(s.asphere)
                shape = profiles.EvenPolynomial(c=float(s.c), cc=float(s.k), coefs=[
                    float(terms.get(p, 0)) for p in range(2, max(terms) + 2, 2)])
            elif s.k:
                shape = profiles.Conic(c=float(s.c), cc=float(s.k))
            else:
                shape = profiles.Spherical(c=float(s.c))
            next_z = rows[i + 1].z if i + 1 < len(rows) else lens.image_z
            gap = (np.identity(3), np.array([0.0, 0.0, float(next_z - s.z)]))
            self.path.append([surface.Surface(profile=shape), None, gap, float(s.n_after), 1])
        self.path.append([surface.Surface(), None, none, 1.0, 1])

    def trace(self, rays):
        from rayoptics.raytr.raytrace import trace_raw
        from rayoptics.raytr.traceerror import TraceMissedSurfaceError, TraceTIRError
        results = []
        for p, d in rays:
            try:
                ray, _, _ = trace_raw(iter(self.path), np.array(p), np.array(d), D, intersect_obj=False)
                results.append(("ok", ray[-1][0][0], ray[-1][0][1]))
            except TraceMissedSurfaceError:
                results.append(("missed", 0, 0))
            except TraceTIRError:
                results.append(("total-internal-reflection", 0, 0))
        return results


class Optiland:
    name = "Optiland 0.6.3"

    def build(self, lens, name):
        from optiland.materials import IdealMaterial
        from optiland.optic import Optic
        self.optic = Optic()
        add = self.optic.surfaces.add
        add(index=0, thickness=np.inf)
        rows = lens.surfaces
        for i, s in enumerate(rows):
            next_z = rows[i + 1].z if i + 1 < len(rows) else lens.image_z
            kind = {}
            if s.asphere:
                terms = dict(s.asphere)
                kind = {"surface_type": "even_asphere",
                        "coefficients": [float(terms.get(p, 0)) for p in range(2, max(terms) + 2, 2)]}
            add(index=i + 1, radius=float(1 / s.c) if s.c else np.inf, conic=float(s.k),
                thickness=float(next_z - s.z), material=IdealMaterial(n=float(s.n_after)), is_stop=s.is_stop, **kind)
        add(index=len(rows) + 1)

    def trace_columns(self, columns):
        from optiland.rays import RealRays
        count = columns.shape[1]
        return self.optic.surfaces.trace(RealRays(*columns, np.ones(count), np.full(count, D / 1000)), record=False)

    def trace(self, rays):
        out = self.trace_columns(np.array([[*p, *d] for p, d in rays]).T)
        return [("ok" if math.isfinite(x + y) else "nan", x, y) for x, y in zip(out.x, out.y)]


def agreement(programs):
    """Rows of the first table: lens, launch, rays, and for each program the largest distance at the image plane."""
    rows, ends = [], {program.name: {"named": 0, "misnamed": 0, "nan": 0, "a point": 0} for program in programs}
    ended = 0
    for seed, (name, largest) in enumerate(CASES.items()):
        lens = at_wavelength(read_lens(lens_file(name), LENSES / "glass"), D)
        for program in programs:
            program.build(lens, name)
        for launch, distance in LAUNCHES.items():
            rays = aimed_rays(lens, largest, distance, 1.0, seed)
            true = truth(lens, rays)
            passing = [i for i, t in enumerate(true) if t[0] == "ok" and t[3]]
            cells = []
            for program in programs:
                found = program.trace(rays)
                lost = sum(found[i][0] != "ok" for i in passing)
                worst = max(math.hypot(found[i][1] - true[i][1], found[i][2] - true[i][2])
                            for i in passing if found[i][0] == "ok")
                cells.append(f"{worst:.0e}" + (f", {lost} lost" if lost else ""))
            rows.append([name, launch, str(len(passing)), *cells])
        # Rays far beyond the rims: those that miss or are totally reflected, having gone forwards until there.
        rays = aimed_rays(lens, largest, math.inf, 6.0, seed + 100)
        true = truth(lens, rays)
        ending = [i for i, t in enumerate(true) if t[0] != "ok" and t[4]]
        ended += len(ending)
        for program in programs:
            found = program.trace(rays)
            for i in ending:
                kind = {"nan": "nan", "ok": "a point", true[i][0]: "named"}.get(found[i][0], "misnamed")
                ends[program.name][kind] += 1
    return rows, ends, ended


def own_time():
    return time.process_time()


def childrens_time():
    times = os.times()
    return times.children_user + times.children_system


def best_rate(count, work, clock=own_time, times=5):
    """Rays per second of processor time, of the quickest of some runs."""
    best = math.inf
    for _ in range(times):
        start = clock()
        work()
        best = min(best, clock() - start)
    return count / best


def benchmark_rates(benchmark, name):
    """The tracer alone, from the benchmark: rays per second of processor time in each precision."""
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch) / "times.json"
        subprocess.run([benchmark, f"--benchmark_filter=^trace/{name}/forward/follow/", f"--benchmark_out={file}",
                        "--benchmark_out_format=json", "--benchmark_repetitions=5", "--benchmark_min_time=0.2"],
                       stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True)
        runs = json.loads(file.read_text())["benchmarks"]
    rates = {}
    for run in runs:
        if run["run_type"] == "iteration":
            key = run["run_name"].rsplit("/", 1)[-1]
            rates[key] = max(rates.get(key, 0), run["rays/s"])
    return rates


def speed(programs, benchmark):
    rows = []
    for name in ("tessar", "muller-fisheye"):
        lens = at_wavelength(read_lens(lens_file(name), LENSES / "glass"), D)
        surfaces = len(lens.surfaces)
        for program in programs:
            program.build(lens, name)
        true_rays = aimed_rays(lens, 0.5 * CASES[name], math.inf, 0.5, 7)
        rays = [r for r, t in zip(true_rays, truth(lens, true_rays)) if t[0] == "ok" and t[3]]
        many = (rays * (100000 // len(rays) + 1))[:100000]
        rates = {}
        ours, scalar, vector = programs
        for precision, rate in benchmark_rates(benchmark, name).items():
            rates[f"lensproof, the tracer in `{precision}`, a ray a call"] = rate
        rates["lensproof, the command `trace`: 100 000 rays, CSV read and written"] = best_rate(
            len(many), lambda: ours.trace_file(many), childrens_time)
        few = (rays * (5000 // len(rays) + 1))[:5000]
        rates["rayoptics, a ray a call"] = best_rate(len(few), lambda: scalar.trace(few))
        vector.trace(rays)  # compiles what it compiles
        columns = np.array([[*p, *d] for p, d in many]).T
        rates["Optiland (NumPy), 100 000 rays a call"] = best_rate(
            10 * len(many), lambda: [vector.trace_columns(columns.copy()) for _ in range(10)])
        rates["Optiland (NumPy), a ray a call"] = best_rate(
            300, lambda: [vector.trace_columns(columns[:, [i]].copy()) for i in range(300)])
        for what, rate in rates.items():
            rows.append([f"`{name}`, {surfaces} surfaces", what, f"{rate:.2g}", f"{rate * surfaces:.2g}"])
    return rows


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def write(mark, content):
    """Puts the content between a pair of marks of README.md."""
    file = HERE / "README.md"
    page = file.read_text(encoding="utf-8")
    pattern = rf"(<!-- {mark} -->\n).*?(<!-- end of {mark} -->)"
    page, count = re.subn(pattern, lambda m: m[1] + content + "\n" + m[2], page, flags=re.S)
    if count != 1:
        sys.exit(f"{file}: no place for {mark}")
    file.write_text(page, encoding="utf-8")
    print(content, flush=True)


def main():
    programs = [Lensproof(str(pathlib.Path(sys.argv[1]).resolve())), RayOptics(), Optiland()]
    rows, ends, ended = agreement(programs)
    text = ["### Agreement", "", "Largest distance from the true point of the image plane, mm, over rays within every rim.", "",
            table(["lens", "object at", "rays", *(p.name for p in programs)], rows), "",
            f"What is said of {ended} rays that miss a surface or are totally reflected:", "",
            table(["", "the right reason", "the other one", "NaN", "a point of the image"],
                  [[name, *(str(n) for n in kinds.values())] for name, kinds in ends.items()])]
    write("agreement", "\n".join(text))
    if len(sys.argv) > 2:
        text = table(["lens", "program", "rays/s", "ray-surfaces/s"],
                     speed(programs, str(pathlib.Path(sys.argv[2]).resolve())))
        write("speed", "### Speed\n\n" + text)


if __name__ == "__main__":
    main()
