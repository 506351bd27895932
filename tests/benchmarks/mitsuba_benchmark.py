"""Samples a second of CPU, beside another renderer's: mitsuba_benchmark.py LENSPROOF SCENES FOLDER

LENSPROOF is the built program, SCENES the folder of cornell_box.toml and checker_wall.toml, FOLDER keeps what pip
fetched: Mitsuba 3. The Cornell box through a pinhole, by itself and with a bumpy ball of 358,800 triangles in it, by
lensproof also with hits in float; and the checkered wall through a thin lens and, by lensproof alone, through the exact
one: the same geometry, spectra and path lengths, four wavelengths a path, one thread each, in turns. The thin lenses
have the exact one's focal length, so that all look at the same. What a sample costs is the difference of a long run and
a short one, so that starting, reading and writing count for neither; of Mitsuba's its first run, which compiles, counts
for nothing. Medians of five.

A sample's noise is what two runs with other seeds differ by; the time to one percent of it is what users wait for.
Mitsuba's `llvm_ad_spectral` wants a libLLVM, the newest that is found.
"""
import array, math, os, pathlib, resource, shutil, statistics, struct, subprocess, sys, tempfile, time, tomllib

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "validation"))
import mitsuba_test as cornell
from fetched import fetch

SKIPPED = 77
PACKAGES = ("mitsuba==3.9.1", "OpenEXR==3.3.2", "numpy==1.26.4")
VARIANTS = ("scalar_spectral", "llvm_ad_spectral")
ROUNDS = 5
SHORT, LONG = 16, 64  # samples a pixel; squares, as Mitsuba's sampler wants them
COLUMNS = 192
FOCAL_LENGTH_MM = 100.4  # of the double Gauss


# --- lensproof ---


def scene_file(scenes, folder, name, changes):
    """The scene with a smaller sensor, one layer and `changes`, beside copies of its tables."""
    for table in scenes.glob("*.csv"):
        shutil.copy(table, folder)
    text = (scenes / f"{name}.toml").read_text()
    width, height = tomllib.loads(text)["camera"]["pixels"]
    rows = COLUMNS * height // width
    changes = [(f"pixels = [{width}, {height}]", f"pixels = [{COLUMNS}, {rows}]"),
               ("[render]", "[render]\nlayers = 1\nstrata_per_layer = 64\nwavelengths_nm = [400.0, 700.0]"), *changes]
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    file = folder / f"{name}-{len(list(folder.iterdir()))}.toml"
    file.write_text(text)
    return file, tomllib.loads(text)


BALL = {"file": "ball.ply", "rows": 300, "columns": 600, "radius_mm": 80.0, "translate_mm": [185.0, 250.0, 170.0]}


def write_ball(file):
    """A binary PLY of a sphere with bumps: triangles that share vertices, none at the poles."""
    rows, columns, radius = BALL["rows"], BALL["columns"], BALL["radius_mm"]
    vertices, faces = array.array("f"), bytearray()
    for row in range(rows):
        theta = 0.001 + (math.pi - 0.002) * row / (rows - 1)
        for column in range(columns):
            phi = 2 * math.pi * column / columns
            r = radius * (1 + 0.05 * math.sin(40 * phi) * math.sin(30 * theta))
            vertices.extend((r * math.sin(theta) * math.cos(phi), r * math.sin(theta) * math.sin(phi),
                             r * math.cos(theta)))
    for row in range(rows - 1):
        for column in range(columns):
            a, b = row * columns + column, row * columns + (column + 1) % columns
            faces += struct.pack("<B3iB3i", 3, a, a + columns, b, 3, b, a + columns, b + columns)
    if sys.byteorder == "big":
        vertices.byteswap()
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {rows * columns}\nproperty float x\n"
              f"property float y\nproperty float z\nelement face {2 * (rows - 1) * columns}\n"
              "property list uchar int vertex_indices\nend_header\n")
    file.write_bytes(header.encode() + vertices.tobytes() + bytes(faces))


def add_ball(file):
    """To the scene."""
    write_ball(file.parent / BALL["file"])
    with file.open("a") as scene:
        scene.write(f'\n[[objects]]\nname = "ball"\nshape = "mesh"\nfile = "{BALL["file"]}"\nmaterial = "white"\n'
                    f'translate_mm = {BALL["translate_mm"]}\n')


def film(file):
    """Its irradiance, [row, column]."""
    import OpenEXR
    parts = OpenEXR.File(str(file), separate_channels=True).parts
    layers = next(part for part in parts if part.header["name"] == "spectral").channels
    return next(iter(layers.values())).pixels.astype(float)


class Lensproof:
    def __init__(self, program, scene, *options):
        self.program, self.scene, self.picture, self.options = program, scene, scene.with_suffix(".exr"), options

    def run(self, samples, seed, threads):
        subprocess.run([self.program, "render", str(self.scene), "-o", str(self.picture), "--seed", str(seed), "--spp",
                        str(samples), "--threads", str(threads), "--quiet", *self.options], check=True,
                       stdin=subprocess.DEVNULL, capture_output=True)

    def render(self, samples, seed):
        """The picture, and the seconds of CPU."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.run(samples, seed, 1)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return film(self.picture), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def gain_of_two_threads(self):
        """By the clock, of sampling alone: the median of as many rounds."""
        def clock(samples, threads):
            start = time.perf_counter()
            self.run(samples, 1, threads)
            return time.perf_counter() - start
        sampling = lambda threads: clock(4 * LONG, threads) - clock(SHORT, threads)
        return statistics.median(sampling(1) / sampling(2) for _ in range(ROUNDS))


# --- Mitsuba, each variant in a process of its own: an unsuited LLVM ends it ---


def wall_scene(mi, scene):
    camera, objects = scene["camera"], {thing["name"]: thing for thing in scene["objects"]}
    width, height = camera["sensor_mm"]
    turned = lambda thing, axis, degrees: mi.ScalarTransform4f().translate(thing["translate_mm"]).rotate(axis, degrees)
    even = lambda value: {"type": "uniform", "value": value}
    chart, lamp, ball = objects["wall"]["chart"], objects["lamp"], objects["sphere"]
    half = [chart["square_mm"] * squares / 2 for squares in chart["squares"]]
    nm, ramp = (400.0, 700.0), 1e-3
    band = cornell.irregular([(nm[0], 0.0), (nm[0] + ramp, 1.0), (nm[1] - ramp, 1.0), (nm[1], 0.0)])
    focal = camera["focal_length_mm"]
    return {"type": "scene", "integrator": {"type": "path", "max_depth": scene["render"]["max_bounces"] + 1},
            "sensor": {"type": "thinlens", "fov_axis": "x",
                       "fov": math.degrees(2 * math.atan(width / 2 * (1 / focal - 1 / camera["focus_distance_mm"]))),
                       "aperture_radius": focal / camera["f_number"] / 2, "near_clip": 1.0, "far_clip": 1e5,
                       "focus_distance": camera["focus_distance_mm"],
                       "to_world": mi.ScalarTransform4f().look_at(origin=camera["position_mm"], up=camera["up"],
                                                                  target=camera["look_at_mm"]),
                       "film": {"type": "specfilm", "width": camera["pixels"][0], "height": camera["pixels"][1],
                                "component_format": "float32", "rfilter": {"type": "box"}, "band": band},
                       "sampler": {"type": "multijitter", "sample_count": LONG}},
            "wall": {"type": "rectangle", "to_world": turned(objects["wall"], [0, 1, 0], 180).scale([*half, 1]),
                     "bsdf": {"type": "diffuse", "reflectance": {
                         "type": "checkerboard", "color0": even(0.9), "color1": even(0.04),
                         "to_uv": mi.ScalarTransform4f().scale([squares / 2 for squares in chart["squares"]] + [1])}}},
            "sphere": {"type": "sphere", "center": ball["translate_mm"], "radius": ball["radius_mm"],
                       "bsdf": {"type": "plastic", "int_ior": 1.5,
                                "diffuse_reflectance": {"type": "rgb", "value": [0.6, 0.05, 0.05]}}},
            "lamp": {"type": "rectangle",
                     "to_world": turned(lamp, [1, 0, 0], 90).scale([lamp["size_mm"][0] / 2, lamp["size_mm"][1] / 2, 1]),
                     "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": even(0.5)}},
                     "emitter": {"type": "area", "radiance": {"type": "d65"}}}}


def measure_mitsuba(folder, variant, file):
    """Prints the nanoseconds of CPU a sample, a line a round, and the noise of one."""
    fetch(folder, PACKAGES)
    import mitsuba, numpy
    mitsuba.set_variant(variant)
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    if variant.startswith("llvm"):
        import drjit
        drjit.set_thread_count(1)
    scene = tomllib.loads(file.read_text())
    if "checker" in file.name:
        made = mitsuba.load_dict(wall_scene(mitsuba, scene))
    else:
        cornell.PIXELS, cornell.BANDS, cornell.SAMPLES = COLUMNS, 1, LONG
        made = cornell.mitsuba_scene(mitsuba, scene, file.parent)
    pictures = [numpy.array(mitsuba.render(made, seed=0, spp=samples)) for samples in (SHORT, LONG)]
    count = pictures[1].shape[0] * pictures[1].shape[1]
    for seed in range(1, ROUNDS + 1):
        seconds = []
        for samples in (SHORT, LONG):
            start = time.process_time()
            pictures.append(numpy.array(mitsuba.render(made, seed=seed, spp=samples)))
            seconds.append(time.process_time() - start)
        print("ns", 1e9 * (seconds[1] - seconds[0]) / (LONG - SHORT) / count)
    print("noise", noise_of_a_sample(pictures[-1][..., 0], pictures[-3][..., 0]))


# --- both ---


def noise_of_a_sample(one, other):
    """The median over pixels' blocks of the relative deviation that a single sample would have."""
    import numpy
    block = 8
    rows, columns = (size // block * block for size in one.shape)
    cut = lambda image: image[:rows, :columns].reshape(rows // block, block, columns // block, block)
    variance = ((cut(one) - cut(other)) ** 2).mean((1, 3)) / 2
    level = ((cut(one) + cut(other)) / 2).mean((1, 3))
    lit = level > 0
    return float(numpy.median(numpy.sqrt(variance[lit] * LONG) / level[lit]))


def in_turns(cameras, other_seed=1000):
    """[(ns a sample, …), noise] of each, a round after the other."""
    found = {name: [] for name in cameras}
    for seed in range(1, ROUNDS + 1):
        for name, camera in cameras.items():
            (_, short), (picture, long) = camera.render(SHORT, seed), camera.render(LONG, seed)
            found[name].append(1e9 * (long - short) / (LONG - SHORT) / picture.size)
    return {name: (ns, noise_of_a_sample(cameras[name].render(LONG, 1)[0], cameras[name].render(LONG, other_seed)[0]))
            for name, ns in found.items()}


def newest_llvm():
    found = [path for folder in ("/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib")
             for path in pathlib.Path(folder).glob("libLLVM*.so*")]
    version = lambda path: max([int(part) for part in path.name.replace("-", ".").split(".") if part.isdigit()] or [0])
    return str(max(found, key=version)) if found else ""


def theirs(folder, variant, file):
    environment = dict(os.environ)
    environment.setdefault("DRJIT_LIBLLVM_PATH", newest_llvm())
    done = subprocess.run([sys.executable, __file__, "--mitsuba", str(folder), variant, str(file)], text=True,
                          stdin=subprocess.DEVNULL, capture_output=True, env=environment)
    words = [line.split() for line in done.stdout.splitlines()]
    ns = [float(word[1]) for word in words if word and word[0] == "ns"]
    noise = [float(word[1]) for word in words if word and word[0] == "noise"]
    if done.returncode != 0 or not ns or not noise:
        print(f"Mitsuba's {variant} does not run here: {(done.stderr.strip().splitlines() or ['no word'])[-1]}")
        return {}
    return {f"Mitsuba, {variant}": (ns, noise[0])}


def tell(scene, found):
    print(f"\n{scene}\n{'':36}{'ns a sample':>14}{'least … most':>18}{'noise of one':>14}{'s a pixel to 1 %':>18}")
    for name, (ns, noise) in found.items():
        median = statistics.median(ns)
        print(f"{name:36}{median:14.0f}{f'{min(ns):.0f} … {max(ns):.0f}':>18}{noise:14.2f}"
              f"{median * 1e-9 * (noise / 0.01) ** 2:18.4f}")


def main():
    program, scenes, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    missing = fetch(folder, PACKAGES)
    if missing:
        print(f"skipped: Mitsuba could not be fetched: {missing}")
        return SKIPPED
    print(subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.strip(),
          *PACKAGES, newest_llvm())
    with tempfile.TemporaryDirectory() as scratch:
        box, _ = scene_file(scenes, pathlib.Path(scratch), "cornell_box", [])
        ball, _ = scene_file(scenes, pathlib.Path(scratch), "cornell_box", [])
        add_ball(ball)
        wall, _ = scene_file(scenes, pathlib.Path(scratch), "checker_wall", [])
        thin, _ = scene_file(scenes, pathlib.Path(scratch), "checker_wall", [
            ('lens = "double-gauss-lowenthal"', f'model = "thin-lens"\nfocal_length_mm = {FOCAL_LENGTH_MM}')])
        for scene, file, ours in (
                ("Cornell box", box, {"lensproof, pinhole": Lensproof(program, box)}),
                ("Cornell box and a ball", ball, {
                    "lensproof, pinhole": Lensproof(program, ball),
                    "lensproof, hits in float": Lensproof(program, ball, "--precision", "float")}),
                ("checkered wall", thin, {"lensproof, thin lens": Lensproof(program, thin),
                                          "lensproof, exact lens": Lensproof(program, wall)})):
            found = in_turns(ours)
            for variant in VARIANTS:
                found |= theirs(folder, variant, file)
            tell(scene, found)
            for name, camera in ours.items() if os.cpu_count() > 1 else ():
                print(f"{name}: two threads are {camera.gain_of_two_threads():.2f} times as fast as one")
    return 0


if __name__ == "__main__":
    if sys.argv[1] == "--mitsuba":
        measure_mitsuba(pathlib.Path(sys.argv[2]), sys.argv[3], pathlib.Path(sys.argv[4]))
        sys.exit(0)
    sys.exit(main())
