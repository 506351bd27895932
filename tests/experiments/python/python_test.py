"""The Python package as its users meet it: python_test.py PACKAGES PROGRAM CHECKOUT

PACKAGES is the folder to import from, PROGRAM the command line, which the package is held to: the same bytes. Exits with
77, which counts as skipped, where NumPy is missing, and where Matplotlib is, if all else holds.
"""
import ast, inspect, json, math, os, pathlib, re, signal, subprocess, sys, tempfile, threading, time, unittest, unittest.mock

sys.dont_write_bytecode = True
SKIPPED = 77
PACKAGES, PROGRAM = map(os.path.abspath, sys.argv[1:3])
CHECKOUT = pathlib.Path(sys.argv[3]).resolve()
PYTHON = CHECKOUT / "experiments/python"
SCENES = CHECKOUT / "experiments/scenes"
os.environ["LENSPROOF_HOME"] = str(CHECKOUT)
os.environ["LENSPROOF_CACHE"] = "off"
os.environ["MPLBACKEND"] = "agg"
sys.path.insert(0, PACKAGES)
try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(SKIPPED)
try:
    import matplotlib
except ImportError:
    matplotlib = None

import lensproof
from lensproof import _lensproof


def program(*words):
    """Exit status, and what `--json -` writes."""
    done = subprocess.run([PROGRAM, *map(str, words), "--quiet", "--json", "-"], capture_output=True, timeout=300)
    return done.returncode, done.stdout


SCENE = """
[camera]
lens = "tessar"
f_number = 8.0
focus_distance_mm = 2000.0
sensor_mm = [36.0, 24.0]
pixels = [360, 240]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[light]
illuminant = "D65"
luminance_cd_m2 = 1000.0
[chart]
kind = "checkerboard"
squares = [12, 9]
square_mm = 60.0
[pose]
distance_mm = 2000.0
tilt_deg = [0.0, 25.0, 0.0]
"""


def bundle(rays=1000, seed=1):
    """Rays through and past the Tessar's front, for which each status can come."""
    random = np.random.default_rng(seed)
    origins = np.column_stack([random.uniform(-25, 25, rays), random.uniform(-25, 25, rays), np.full(rays, -40.0)])
    directions = np.column_stack([random.normal(0, 0.2, rays), random.normal(0, 0.2, rays), random.uniform(0.5, 2, rays)])
    return origins, directions


class InAFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.before = os.getcwd()
        os.chdir(self.folder.name)

    def tearDown(self):
        os.chdir(self.before)
        self.folder.cleanup()

    def assertSame(self, result, *words):
        status, written = program(*words)
        self.assertEqual(result.json, written)
        self.assertEqual(result.status, status)
        self.assertEqual(result.to_dict(), json.loads(written))


class Commands(InAFolder):
    def test_results_are_the_command_lines_bytes(self):
        lens = lensproof.Lens.load("tessar", f_number=4, fields_deg=[0, 10, 20])
        self.assertSame(lens.analyze(), "analyze", "tessar", "--f-number", "4", "--fields", "0,10,20")
        self.assertSame(lens.ghosts(strongest=2, source_deg=5.0), "ghosts", "tessar", "--f-number", 4, "--fields",
                        "0,10,20", "--strongest", 2, "--source-deg", 5)
        self.assertSame(lensproof.check("tessar", "petzval", stated={"efl_mm": 90, "f_number": 2.8}), "check", "tessar",
                        "petzval", "--stated", "efl_mm=90,f_number=2.8")
        self.assertSame(lensproof.compare("canon-fd-24", measured="lensfun:Canon FDn 24mm 1:2.8"), "compare",
                        "canon-fd-24", "--measured", "lensfun:Canon FDn 24mm 1:2.8")

    def test_a_chart_is_rendered_measured_compared_and_fitted(self):
        pathlib.Path("scene.toml").write_text(SCENE)
        rendered = lensproof.render("scene.toml", output="chart.exr", samples=16)
        told = rendered.to_dict()
        status, written = program("render", "scene.toml", "-o", "again.exr", "--samples", 16)
        again = json.loads(written)
        for result in (told, again):  # what depends on the clock and on the name
            for key in ("run", "exr", "png"):
                del result[key]
        self.assertEqual(told, again)
        self.assertEqual(pathlib.Path("chart.exr").read_bytes(), pathlib.Path("again.exr").read_bytes())
        self.assertEqual(rendered.picture.rgb.shape, (240, 360, 3))

        options = ("--chart", "scene.toml", "--pixel-pitch", 100, "--no-self-test")
        profile = lensproof.measure("chart.exr", "scene.toml", pixel_pitch_um=100, no_self_test=True)
        self.assertSame(profile, "measure", "chart.exr", *options)
        # An independent number: the focal length of the lens and its pixels.
        focal = profile.model.parameters["focal_length_px"]
        self.assertLess(abs(focal.value - 100.0 / 0.1 * 2000 / 1900), 5 * focal.standard_error + 30)
        profile.save("profile.json")
        comparison = lensproof.compare("tessar", profile, f_number=8, focus_mm=2000)
        from_file = lensproof.compare("tessar", "profile.json", f_number=8, focus_mm=2000)
        self.assertSame(from_file, "compare", "tessar", "profile.json", "--f-number", 8, "--focus", 2000)
        np.testing.assert_array_equal(comparison.curves["distortion_percent"].difference,
                                      from_file.curves["distortion_percent"].difference)
        self.assertSame(lensproof.fit("profile.json", "tessar", free=["focus"]), "fit", "profile.json", "--lens", "tessar",
                        "--free", "focus")

    def test_what_does_not_hold_is_told_and_raises_nothing(self):
        # Far from the Tessar's focal length of 100 mm.
        found = lensproof.check("tessar", stated={"efl_mm": 50})
        self.assertFalse(found.ok)
        self.assertEqual(found.status, 1)
        self.assertFalse(found.lenses[0].ok)
        self.assertIn("error", {finding.severity for finding in found.lenses[0].findings})

    def test_objects_hold_what_the_json_says(self):
        analysis = lensproof.Lens.load("tessar", fields_deg=[0, 60]).analyze()
        told = analysis.to_dict()
        self.assertEqual(analysis.paraxial.efl_mm, told["paraxial"]["efl_mm"])
        self.assertEqual(analysis.seidel.total.s1, told["seidel"]["total"]["s1"])
        self.assertEqual(analysis.seidel.surfaces.s1.tolist(), [row["s1"] for row in told["seidel"]["surfaces"]])
        self.assertTrue(math.isinf(analysis.object_distance_mm) or math.isnan(analysis.object_distance_mm))
        spots = [row["spot_rms_um"] for row in told["fields"]]
        self.assertIn(None, spots)  # no light comes from 60°
        np.testing.assert_array_equal(analysis.fields.spot_rms_um, np.array(spots, dtype=float))
        self.assertEqual(analysis.fields.spot_centroid_mm.shape, (6, 2))
        self.assertEqual(len(analysis.fields.at(analysis.reference_wavelength_nm).field_deg), 2)
        with self.assertRaises(AttributeError):
            analysis.lens = "another"

    def test_plan_and_tradeoff(self):
        pathlib.Path("scene.toml").write_text(SCENE)
        plan = lensproof.plan("scene.toml", "5px,1ev,20de")
        self.assertEqual(plan.tolerance, lensproof.results.Tolerance(5.0, 1.0, 20.0))
        self.assertEqual([effect.effect for effect in plan.effects],
                         [effect["effect"] for effect in plan.to_dict()["effects"]])
        tradeoff = lensproof.tradeoff("scene.toml", rungs=["pinhole", "exact-float"], pixels=100, samples=1, seeds=2)
        self.assertEqual({rung.model for rung in tradeoff.rungs} & {"pinhole", "exact-float"}, {"pinhole", "exact-float"})


class Errors(InAFolder):
    def test_they_say_file_key_and_value(self):
        table = (CHECKOUT / "lenses/tessar.toml").read_text()
        pathlib.Path("wrong.toml").write_text(re.sub(r"semi_diameter_mm = [\d.]+", "semi_diameter_mm = -7", table, count=1)
                                              if "semi_diameter_mm = " in table else "name = 3\n" + table)
        pathlib.Path("lamp.toml").write_text(SCENE.replace('kind = "checkerboard"', 'kind = "chequers"'))
        for complaint, call in (
            ("nowhere.toml", lambda: lensproof.Lens.load("nowhere.toml")),
            (r"wrong\.toml", lambda: lensproof.Lens.load("wrong.toml")),
            (r'lamp\.toml.*kind.*"chequers"', lambda: lensproof.render("lamp.toml")),
            (r"--f-number.*-4", lambda: lensproof.Lens.load("tessar", f_number=-4)),
            (r'"--f-numbr" is no option.*--f-number', lambda: lensproof.Lens.load("tessar").analyze(f_numbr=4)),
            (r"untrusted: no option here", lambda: lensproof.check("tessar", untrusted=True)),
            (r"a Check is no input", lambda: lensproof.compare("tessar", lensproof.check("tessar"))),
            (r"nowhere\.exr", lambda: lensproof.Picture.load("nowhere.exr")),
            (r"lamp\.toml: not an OpenEXR file", lambda: lensproof.Picture.load("lamp.toml")),
        ):
            with self.subTest(complaint), self.assertRaisesRegex(lensproof.InputError, f"(?s){complaint}"):
                call()
        self.assertTrue(issubclass(lensproof.InputError, ValueError))

    def test_other_failures_are_no_fault_of_the_input(self):
        with unittest.mock.patch.object(_lensproof, "command", return_value=(3, b"", "no space left on the device")):
            with self.assertRaisesRegex(lensproof.LensproofError, "no space left") as raised:
                lensproof.check("tessar")
        self.assertNotIsInstance(raised.exception, lensproof.InputError)

    def test_rays_that_cannot_be_traced(self):
        lens = lensproof.Lens.load("tessar")
        origins, directions = bundle(3000)

        def with_entry(array, ray, column, value):
            changed = array.copy()
            changed[ray, column] = value
            return changed

        for complaint, rays in (
            (r"x_mm\[2900\] is nan", lensproof.Rays.of(with_entry(origins, 2900, 0, np.nan), directions)),
            (r"dz\[17\] is inf", lensproof.Rays.of(origins, with_entry(directions, 17, 2, np.inf))),
            (r"dx, dy, dz\[5\] is 0", lensproof.Rays.of(origins, with_entry(directions, 5, slice(None), 0.0))),
            (r"different lengths \(x_mm: 2, y_mm: 3\)", lensproof.Rays([0, 1], [0, 1, 2], 0, 0, 0, 1)),
            (r"x_mm has shape \(1, 2\)", lensproof.Rays([[0, 1]], 0, 0, 0, 0, 1)),
            (r"x_mm is str", lensproof.Rays("left", 0, 0, 0, 0, 1)),
            (r"wavelength_nm is -1", lensproof.Rays(0, 0, 0, 0, 0, 1, wavelength_nm=-1.0)),
            (r"wavelength_nm has shape \(2,\), expected \(1,\)", lensproof.Rays(0, 0, 0, 0, 0, 1, wavelength_nm=[500, 600])),
            (r"80", lensproof.Rays(0, 0, 0, 0, 0, 1, wavelength_nm=80.0)),  # beyond the glasses' formulas
        ):
            with self.subTest(complaint), self.assertRaisesRegex(lensproof.InputError, complaint):
                lens.trace(rays)
        traced = lens.trace(lensproof.Rays.of(origins, directions))
        with self.assertRaisesRegex(lensproof.InputError, "out: holds 3000 rays, expected 1"):
            lens.trace(lensproof.Rays(0, 0, -10, 0, 0, 1), out=traced)
        with self.assertRaises(ValueError):  # what the native part would write beyond
            _lensproof.LoadedLens(["tessar"]).trace([np.zeros(9)] * 6, [np.zeros(9)] * 8 + [np.zeros(9, np.uint8),
                                                    np.zeros(9, np.int16)], [500.0], None, False, True, 0)


class Trace(InAFolder):
    def setUp(self):
        super().setUp()
        self.lens = lensproof.Lens.load("tessar")

    def assertEqualRays(self, one, other):
        for name, column in one.to_dict().items():
            np.testing.assert_array_equal(column, other.to_dict()[name], name)

    def test_the_command_lines_bits(self):
        origins, directions = bundle(400)
        wavelengths = np.resize([450.0, 550.0, 650.0], 400)
        with open("rays.csv", "w") as file:
            print("id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm", file=file)
            for i, (o, d, nm) in enumerate(zip(origins.tolist(), directions.tolist(), wavelengths.tolist())):
                print(i, *o, *d, nm, sep=",", file=file)
        last = {}
        for row in json.loads(program("trace", "tessar", "--rays", "rays.csv")[1])["rows"]:
            if row["surface"] != "image":
                last[int(row["id"])] = row
        traced = self.lens.trace(lensproof.Rays.of(origins, directions, wavelengths))
        self.assertEqual(set(lensproof.STATUS_NAMES[:5]) & {row["status"] for row in last.values()} - {"ok"},
                         {row["status"] for row in last.values()} - {"ok"})
        self.assertGreater(traced.ok.sum(), 20)
        self.assertGreater((~traced.ok).sum(), 20)
        told = traced.to_dict()
        for i, row in last.items():
            self.assertEqual([traced.x_mm[i], traced.y_mm[i], traced.z_mm[i]], row["point_mm"])
            self.assertEqual([traced.dx[i], traced.dy[i], traced.dz[i]], row["direction"])
            self.assertEqual(traced.optical_path_mm[i], row["optical_path_mm"])
            self.assertEqual(traced.transmittance[i], row["transmittance"])
            self.assertEqual(told["status"][i], row["status"])
            self.assertEqual(str(traced.surface[i]), row["surface"])

    def test_arrays_are_used_where_they_lie(self):
        origins, directions = bundle(1001)
        rays = lensproof.Rays.of(origins, directions)
        for column in rays.columns():
            self.assertTrue(np.shares_memory(column, origins) or np.shares_memory(column, directions))
        separate = lensproof.Rays(*map(np.ascontiguousarray, (*origins.T, *directions.T)))
        backwards = lensproof.Rays(*(column[::-1] for column in rays.columns()))
        expected = self.lens.trace(rays)
        self.assertEqualRays(self.lens.trace(separate), expected)
        np.testing.assert_array_equal(self.lens.trace(backwards).x_mm, expected.x_mm[::-1])
        for column in rays.columns():
            column.flags.writeable = False
        self.assertEqualRays(self.lens.trace(rays), expected)

        class OnlyDLPack:  # as PyTorch's and others' arrays speak it
            def __init__(self, array):
                self.array = array
            def __dlpack__(self, **options):
                return self.array.__dlpack__(**options)
            def __dlpack_device__(self):
                return self.array.__dlpack_device__()

        given = [np.array(column) for column in separate.columns()]
        foreign = lensproof.Rays(*map(OnlyDLPack, given))
        for column, array in zip(foreign.columns(), given):
            self.assertTrue(np.shares_memory(column, array))
        self.assertEqualRays(self.lens.trace(foreign), expected)

    def test_any_number_of_rays_on_any_number_of_threads(self):
        origins, directions = bundle(40000)
        whole = self.lens.trace(lensproof.Rays.of(origins, directions), threads=1)
        self.assertEqualRays(self.lens.trace(lensproof.Rays.of(origins, directions), threads=3), whole)
        for count in (0, 1, 15, 16, 17, 129, 1024, 1025):
            part = self.lens.trace(lensproof.Rays.of(origins[:count], directions[:count]))
            self.assertEqual(len(part), count)
            np.testing.assert_array_equal(part.optical_path_mm, whole.optical_path_mm[:count])

    def test_memory_may_be_used_again(self):
        origins, directions = bundle(5000)
        first = self.lens.trace(lensproof.Rays.of(origins, directions))
        expected = {name: column.copy() for name, column in first.to_dict().items()}
        again = self.lens.trace(lensproof.Rays.of(origins[::-1], directions[::-1]), out=first)
        self.assertTrue(np.shares_memory(again.x_mm, first.x_mm))
        for name, column in again.to_dict().items():
            np.testing.assert_array_equal(column[::-1], expected[name])

    def test_memory_of_results_that_are_gone_serves_the_next_and_no_other(self):
        rays = lensproof.Rays.of(*bundle(5000))
        others = lensproof.Rays.of(*bundle(5000, seed=2))
        expected = self.lens.trace(rays).y_mm.copy()
        place = self.lens.trace(rays).y_mm.__array_interface__["data"][0]  # gone with this line
        looked_at = {"a column": self.lens.trace(rays).y_mm}
        self.assertEqual(looked_at["a column"].__array_interface__["data"][0], place)
        looked_at["a part of one"] = self.lens.trace(rays).y_mm[2:][::2]
        looked_at["another library's"] = np.from_dlpack(self.lens.trace(rays).y_mm)
        looked_at["bytes"] = np.frombuffer(memoryview(self.lens.trace(rays).y_mm))
        for _ in range(3):
            self.lens.trace(others)
        for what, column in looked_at.items():
            np.testing.assert_array_equal(column, expected[2:][::2] if what == "a part of one" else expected, what)
        kept = self.lens.trace(rays)
        memory = kept.y_mm
        del kept
        status = self.lens.trace(others).status  # whatever column is left of it holds all
        self.lens.trace(rays)
        np.testing.assert_array_equal(status, self.lens.trace(others).status)
        np.testing.assert_array_equal(memory, expected)

    def test_light_runs_the_same_way_back(self):
        # Fermat: what left comes back along itself.
        heights = np.linspace(-10, 10, 41)
        there = self.lens.trace(lensproof.Rays(0, heights, -20, 0, 0, 1))
        self.assertTrue(there.ok.all())
        x, y = there.at_image()
        back = self.lens.trace(
            lensproof.Rays(x, y, self.lens.image_z_mm, -there.dx, -there.dy, -there.dz), reverse=True)
        self.assertTrue(back.ok.all())
        np.testing.assert_allclose(back.y_mm, heights, atol=1e-11)
        np.testing.assert_allclose(back.dz, -1.0, atol=1e-12)

    def test_psf_and_mtf(self):
        # A small stop leaves diffraction alone: Airy's pattern (2 J1(v) / v)², J1 by its integral, and the MTF of a
        # circular pupil (Goodman, Introduction to Fourier Optics, 6.3). What is left of aberrations takes as much of the
        # peak as the Strehl ratio says, and puts no more than that elsewhere.
        lens = lensproof.Lens.load("tessar", f_number=22, fields_deg=[0.0, 5.0], wavelengths_nm=[550.0],
                                   best_focus="wavefront")
        f_number = lens.analyze().paraxial.real_working_f_number
        image = lens.psf()[0]
        self.assertGreater(image.strehl, 0.97)
        middle = len(image.intensity) // 2
        v = np.pi * np.arange(1, 12) * image.pixel_um / (0.55 * f_number)
        angles = np.linspace(0, np.pi, 2001)
        bessel = np.trapz(np.cos(angles - v[:, None] * np.sin(angles)), angles) / np.pi
        np.testing.assert_allclose(image.intensity[middle, middle + 1:middle + 12], (2 * bessel / v) ** 2,
                                   atol=1 - image.strehl + 5e-3)
        self.assertAlmostEqual(image.intensity[middle, middle], image.strehl, delta=5e-3)
        mtf = lens.mtf([0.0, 20.0, 40.0])[0]
        s = mtf.frequency_per_mm * 0.55e-3 * f_number
        perfect = 2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s * s))
        np.testing.assert_allclose(mtf.limit_tangential, perfect, atol=3e-3)
        self.assertTrue((mtf.tangential <= mtf.limit_tangential + 1e-3).all())
        self.assertEqual([one.field_deg for one in lens.mtf(fields_deg=[0, 1, 2])], [0, 1, 2])
        self.assertEqual(self.lens.mtf(fields_deg=[89.0])[0].tangential.size, 0)  # no light
        self.assertEqual(self.lens.psf(fields_deg=[89.0])[0].intensity.size, 0)


class Pictures(InAFolder):
    def test_arrays_are_the_files_numbers(self):
        pathlib.Path("scene.toml").write_text(SCENE.replace("[360, 240]", "[45, 30]"))
        kept = lensproof.render("scene.toml", output="kept.exr", samples=4, features=True, filter="tent")
        gone = lensproof.render("scene.toml", samples=4, features=True, filter="tent")
        np.testing.assert_array_equal(kept.picture.rgb, gone.picture.rgb)
        self.assertFalse(os.path.exists(gone.to_dict()["exr"]))
        picture = lensproof.Picture.load("kept.exr")
        self.assertEqual(picture.rgb.dtype, np.float32)
        self.assertEqual(picture.rgb.shape, (30, 45, 3))
        self.assertEqual(picture.spectral.shape, (30, 45, picture.spectral_nm.size))
        self.assertTrue((np.diff(picture.spectral_nm) > 0).all())
        self.assertTrue((picture.samples == 4).all())
        self.assertIn("Z", picture.features)
        self.assertEqual(picture.metadata["lensproof:identity:seed"], "0")
        # As OpenImageIO's tool shows a pixel of it.
        subprocess.run(["oiiotool", "kept.exr", "--subimage", "rgb", "--cut", "1x1+30+12", "-o", "pixel.exr"], check=True)
        shown = subprocess.run(["oiiotool", "--dumpdata", "pixel.exr"], capture_output=True, text=True, check=True).stdout
        values = re.search(r"Pixel \(.*?\): ([-\d.e+]+) ([-\d.e+]+) ([-\d.e+]+)", shown)
        np.testing.assert_allclose(picture.rgb[12, 30], [float(value) for value in values.groups()], rtol=1e-5, atol=1e-7)

    def test_passes_add_up(self):
        scene = SCENES / "lamp_beside_the_door.toml"
        rendered = lensproof.render(scene, samples=1, passes=["imaged", "direct"])
        self.assertEqual(set(rendered.picture.passes), {"imaged", "direct"})
        total = sum(one.rgb.astype(float) for one in rendered.picture.passes.values())
        np.testing.assert_allclose(rendered.picture.rgb, total, rtol=1e-5, atol=1e-6 * total.max())


class Process(InAFolder):
    def test_ctrl_c_ends_long_work_and_leaves_the_process_as_it_was(self):
        handlers = [signal.getsignal(one) for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE)]
        lens = lensproof.Lens.load("tessar")
        rays = lensproof.Rays.of(*bundle(2_000_000))

        def trace_for_ever():
            traced = None
            while True:
                traced = lens.trace(rays, out=traced)

        for name, work in (("render", lambda: lensproof.render(SCENES / "cornell_box.toml", samples=100000)),
                           ("ghosts", lambda: [lens.ghosts(reflections=4, tolerance=1e-9) for _ in range(1000)]),
                           ("trace", trace_for_ever)):
            with self.subTest(name):
                pressed = []
                timer = threading.Timer(0.7, lambda: (pressed.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT)))
                timer.start()
                try:
                    with self.assertRaises(KeyboardInterrupt):
                        work()
                finally:
                    timer.cancel()
                    timer.join()
                self.assertLess(time.monotonic() - pressed[0], 5.0)
        self.assertEqual(handlers, [signal.getsignal(one) for one in
                                    (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE)])
        self.assertTrue(lens.analyze().ok)

    def test_other_threads_go_on_meanwhile(self):
        lens = lensproof.Lens.load("tessar")
        ticks, done = [], threading.Event()

        def tick():
            while not done.wait(0.002):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        lens.ghosts(threads=1)
        end = time.monotonic()
        done.set()
        thread.join()
        self.assertGreater(end - begin, 0.05)
        self.assertGreater(sum(begin < one < end for one in ticks), 5)

    def test_commands_of_two_threads(self):
        expected = lensproof.Lens.load("petzval").analyze().json
        found = []
        threads = [threading.Thread(target=lambda: found.append(lensproof.Lens.load("petzval").analyze().json))
                   for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [expected] * 4)

    def test_options_of_one_command_are_not_the_next_ones(self):
        pathlib.Path("scene.toml").write_text(SCENE)
        lensproof.render("scene.toml", output="chart.exr", samples=1)
        with self.assertRaisesRegex(lensproof.InputError, "largest-picture"):
            lensproof.compare("chart.exr", "chart.png", largest_picture_mib=0.01)
        lensproof.compare("chart.exr", "chart.png")

    def test_is_imported_in_time(self):
        code = "import time; before = time.process_time(); import lensproof; print(time.process_time() - before)"
        environment = {**os.environ, "PYTHONPATH": PACKAGES}
        seconds = min(float(subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True,
                                           text=True, check=True).stdout) for _ in range(5))
        self.assertLess(seconds, 0.3)

    def test_nothing_is_drawn_with_before_it_is_asked_for(self):
        code = "import sys, lensproof; print('matplotlib' in sys.modules)"
        environment = {**os.environ, "PYTHONPATH": PACKAGES}
        self.assertEqual("False", subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True,
                                                 text=True, check=True).stdout.strip())


class Stubs(unittest.TestCase):
    def test_they_say_what_the_native_part_is(self):
        tree = ast.parse((PYTHON / "lensproof/_lensproof.pyi").read_text())

        def signatures(body):
            return {node.name: [one.arg for one in node.args.args] for node in body if isinstance(node, ast.FunctionDef)}

        stub = next(node for node in tree.body if isinstance(node, ast.ClassDef))
        functions = {name for name in dir(_lensproof) if not name.startswith("_") and callable(getattr(_lensproof, name))}
        self.assertEqual(set(signatures(tree.body)) | {stub.name}, functions)
        methods = {name for name in vars(_lensproof.LoadedLens) if not name.startswith("_")}
        self.assertEqual(set(signatures(stub.body)) - {"__init__"}, methods)
        for owner, told in ((_lensproof, signatures(tree.body)), (_lensproof.LoadedLens, signatures(stub.body))):
            for name, arguments in told.items():
                if name == "__init__":
                    continue
                signature = getattr(owner, name).__doc__.split("\n")[0].split(" -> ")[0]
                self.assertEqual([one for one in re.findall(r"(\w+): ", signature) if one != "self"],
                                 [one for one in arguments if one != "self"], name)

    def test_the_package_says_its_types(self):
        self.assertTrue((PYTHON / "lensproof/py.typed").exists())
        for name in lensproof.__all__:
            member = getattr(lensproof, name)
            if inspect.isfunction(member):
                self.assertIn("return", member.__annotations__, name)


def cells_of(notebook):
    content = json.loads(notebook.read_text())
    return ["".join(cell["source"]) for cell in content["cells"] if cell["cell_type"] == "code"], content


@unittest.skipIf(matplotlib is None, "Matplotlib is not installed")
class Documents(InAFolder):
    def run_all(self, name, codes):
        from matplotlib import pyplot

        space = {"__name__": "__main__"}
        for number, code in enumerate(codes, start=1):
            try:
                exec(compile(code, f"{name}, {number}", "exec"), space)
            except Exception as failure:
                self.fail(f"{name}, {number}:\n{code}\n{type(failure).__name__}: {failure}")
        pictures = os.environ.get("LENSPROOF_TEST_PLOTS")  # a folder to look at them in
        for figure in pyplot.get_fignums() if pictures else ():
            pyplot.figure(figure).savefig(f"{pictures}/{name}-{figure}.png", dpi=70)
        drawn = len(pyplot.get_fignums())
        pyplot.close("all")
        return drawn

    def test_every_snippet_of_the_readme(self):
        snippets = re.findall(r"```python\n(.*?)```", (PYTHON / "README.md").read_text(), re.DOTALL)
        self.assertGreater(len(snippets), 5)
        self.run_all("README", snippets)

    def test_notebooks(self):
        notebooks = sorted((PYTHON / "notebooks").glob("*.ipynb"))
        self.assertEqual([one.stem for one in notebooks], ["first_lens", "ghost_hunt", "own_photos", "trade_off"])
        for notebook in notebooks:
            with self.subTest(notebook.stem):
                codes, content = cells_of(notebook)
                self.assertGreater(self.run_all(notebook.stem, codes), 0)
                self.assertFalse([cell for cell in content["cells"] if cell.get("outputs")], "has outputs")


if __name__ == "__main__":
    result = unittest.main(argv=sys.argv[:1] + sys.argv[4:], exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if result.skipped else 0)
