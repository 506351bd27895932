"""The Cornell box against another renderer: mitsuba_test.py LENSPROOF SCENES FOLDER

LENSPROOF is the built program, SCENES the folder of cornell_box.toml, FOLDER keeps what pip fetched: Mitsuba 3, whose
spectral variant traces the same box, and a reader of EXR files. Without pip or a package index this says so and exits
with 77 (skipped).

The same geometry, tables of reflectance and emission, pinhole and path lengths go to both; Mitsuba's scene is made here
from the file alone. What is compared is film irradiance in W/m²/nm, as it is, in eight bands of 37.5 nm. A pinhole of
focal length f and f-number N gives E = L cos⁴θ π / (4 N²) of the radiance L that Mitsuba's pixels hold; cos⁴θ is that
of a pixel's centre.

Both render each picture many times over with other seeds, so that the errors of what is compared are known without a
word from either program. Pixels are compared in blocks, whose errors are small; that every block is right within
its error says that no geometry, shadow or colour that bleeds is elsewhere.
"""
import math, pathlib, shutil, subprocess, sys, tempfile, tomllib

sys.dont_write_bytecode = True
from fetched import fetch

SKIPPED = 77
PACKAGES = ("mitsuba==3.5.2", "OpenEXR==3.3.2", "numpy==1.26.4")
PIXELS = 64  # a side
BLOCK = 8  # pixels a side of what is compared
RUNS = 32  # of each program
SAMPLES = 64  # a pixel and run
BANDS = 8
RANGE_NM = (400.0, 700.0)
STRATA_PER_BAND = 32  # wavelengths at which lensproof looks in each band: 1.2 nm apart, where tables have a row each 4 nm
LEVEL_LIMIT_PERCENT = 0.5  # of a band's mean over the image
SLOPE_LIMIT = 0.005  # of the standard error of a slope, so that one of 2 % would show
DEVIATIONS = 4.5  # standard errors that chance exceeds in one of 150 000 numbers

failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)
    print(("ok      " if holds else "FAILED  ") + what)


def band_edges():
    return [RANGE_NM[0] + (RANGE_NM[1] - RANGE_NM[0]) * i / BANDS for i in range(BANDS + 1)]


# --- lensproof ---


def render_with_lensproof(program, scene_file, folder, seed):
    """Film irradiance, [row, column, band]."""
    import numpy, OpenEXR
    picture = folder / f"box-{seed}.exr"
    subprocess.run([program, "render", str(scene_file), "-o", str(picture), "--seed", str(seed), "--spp", str(SAMPLES),
                    "--threads", "1", "--quiet"], check=True, stdin=subprocess.DEVNULL, capture_output=True)
    parts = OpenEXR.File(str(picture), separate_channels=True).parts
    layers = next(part for part in parts if part.header["name"] == "spectral").channels
    wavelength = lambda name: float(name.split(".", 1)[1].removesuffix("nm").replace(",", "."))
    return numpy.stack([layers[name].pixels for name in sorted(layers, key=wavelength)], axis=-1).astype(float)


def small_copy(scenes, folder):
    """The scene file with another number of pixels and of bands, beside copies of its tables."""
    for table in scenes.glob("cornell_box*.csv"):
        shutil.copy(table, folder)
    text = (scenes / "cornell_box.toml").read_text()
    sampling = f"layers = {BANDS}\nstrata_per_layer = {STRATA_PER_BAND}\nwavelengths_nm = {list(RANGE_NM)}"
    changed = text.replace("pixels = [512, 512]", f"pixels = [{PIXELS}, {PIXELS}]").replace(
        "[render]", "[render]\n" + sampling)
    file = folder / "cornell_box.toml"
    file.write_text(changed)
    scene = tomllib.loads(changed)
    assert scene["camera"]["pixels"] == [PIXELS, PIXELS] and scene["render"]["layers"] == BANDS
    return file, scene


# --- Mitsuba ---


def table(folder, file, column):
    rows = [line for line in (folder / file).read_text().splitlines() if line and not line.startswith("#")]
    names = rows[0].split(",")
    at = names.index(column)
    return [tuple(float(row.split(",")[i]) for i in (0, at)) for row in rows[1:]]


def irregular(points):
    return {"type": "irregular", "wavelengths": ",".join(repr(nm) for nm, _ in points),
            "values": ",".join(repr(value) for _, value in points)}


def spectrum(folder, said, name):
    if isinstance(said, (int, float)):
        return {"type": "uniform", "value": float(said)}
    return irregular(table(folder, said["file"], said.get("column", name)))


def lamp_radiance(mi, folder, light):
    """Scaled to its luminance, Km ∫ L V dλ (CIE 18:2019), by Mitsuba's own V."""
    import numpy
    points = table(folder, light["radiance"]["file"], light["radiance"]["column"])
    nm = numpy.arange(points[0][0], points[-1][0] + 0.5, 1.0)
    visible = numpy.array([numpy.ravel(mi.cie1931_y(float(x)))[0] for x in nm])  # an array, where variants are
    luminance = 683.0 * numpy.trapz(numpy.interp(nm, *zip(*points)) * visible, nm)
    return irregular([(x, value * light["luminance_cd_m2"] / luminance) for x, value in points])


def write_polygon(file, vertices):
    faces = [f"3 0 {i} {i + 1}" for i in range(1, len(vertices) - 1)]
    file.write_text("\n".join(["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property float x",
                               "property float y", "property float z", f"element face {len(faces)}",
                               "property list uchar int vertex_indices", "end_header",
                               *(" ".join(repr(float(x)) for x in vertex) for vertex in vertices), *faces]) + "\n")


def mitsuba_camera(mi, camera):
    film = {"type": "specfilm", "width": PIXELS, "height": PIXELS, "component_format": "float32",
            "rfilter": {"type": "box"}}
    edges, ramp_nm = band_edges(), 1e-3
    for i, (low, high) in enumerate(zip(edges, edges[1:])):
        film[f"band{i:02d}"] = irregular([(low, 0.0), (low + ramp_nm, 1.0), (high - ramp_nm, 1.0), (high, 0.0)])
    return {"type": "perspective", "film": film, "near_clip": 1.0, "far_clip": 1e5, "fov_axis": "x",
            "fov": math.degrees(2.0 * math.atan(camera["sensor_mm"][0] / 2.0 / camera["focal_length_mm"])),
            "to_world": mi.ScalarTransform4f.look_at(origin=camera["position_mm"], target=camera["look_at_mm"],
                                                     up=camera["up"]),
            "sampler": {"type": "multijitter", "sample_count": SAMPLES}}


def mitsuba_scene(mi, scene, folder):
    light = scene["lights"][0]
    made = {"type": "scene", "sensor": mitsuba_camera(mi, scene["camera"]),
            # A path of n scatterings has the depth n + 1 there.
            "integrator": {"type": "path", "max_depth": scene["render"]["max_bounces"] + 1}}
    materials = {m["name"]: {"type": "twosided",
                             "bsdf": {"type": "diffuse",
                                      "reflectance": spectrum(folder, m["reflectance"], "reflectance")}}
                 for m in scene["materials"]}
    for i, thing in enumerate(scene["objects"]):
        file = folder / thing.get("file", f"polygon{i}.ply")
        if "vertices_mm" in thing:
            write_polygon(file, thing["vertices_mm"])
        made[f"object{i}"] = {"type": "ply", "filename": str(file), "face_normals": True,
                              "to_world": mi.ScalarTransform4f().translate(thing.get("translate_mm", [0.0, 0.0, 0.0])),
                              "bsdf": materials[thing["material"]]}
        if thing["name"] == light["object"]:
            made[f"object{i}"]["emitter"] = {"type": "area", "radiance": lamp_radiance(mi, folder, light)}
    return mi.load_dict(made)


def irradiance_of_radiance(camera):
    """What multiplies a pixel's radiance, [row, column]."""
    import numpy
    pitch = camera["sensor_mm"][0] / PIXELS
    x = (numpy.arange(PIXELS) + 0.5) * pitch - camera["sensor_mm"][0] / 2.0
    cos2 = camera["focal_length_mm"] ** 2 / (camera["focal_length_mm"] ** 2 + x[None, :] ** 2 + x[:, None] ** 2)
    return cos2 ** 2 * math.pi / (4.0 * camera["f_number"] ** 2)


# --- comparison ---


class Difference:
    """Of the means of two sets of runs, relative to the second's, with its standard error."""

    def __init__(self, ours, theirs):
        self.ours, self.theirs = ours.mean(0), theirs.mean(0)
        variance = sum(runs.var(0, ddof=1) / len(runs) for runs in (ours, theirs))
        self.value = self.ours / self.theirs - 1.0
        self.error = variance ** 0.5 / self.theirs


def blocks(runs):
    """[run, row, column, …] of blocks."""
    count = PIXELS // BLOCK
    return runs.reshape(len(runs), count, BLOCK, count, BLOCK, *runs.shape[3:]).mean((2, 4))


def outside_lamp(image):
    """The pixels that neither see the lamp, hundreds of times as bright as its ceiling, nor touch one that does."""
    import numpy
    dark = image < 6.0 * numpy.median(image)
    padded = numpy.pad(dark, 1, constant_values=True)
    return numpy.all([padded[y:y + PIXELS, x:x + PIXELS] for y in range(3) for x in range(3)], axis=0)


def slope(x, difference, counted):
    """Of the difference over x, beside a constant, by weighted least squares; and its standard error."""
    weight = counted * difference.error ** -2.0
    centred = x - (weight * x).sum() / weight.sum()
    spread = (weight * centred ** 2).sum()
    return (weight * centred * difference.value).sum() / spread, spread ** -0.5


def compare_levels(ours, theirs, pixels, what):
    """Arrays of [run, row, column, band]."""
    found = Difference(ours[:, pixels].mean(1), theirs[:, pixels].mean(1))
    edges = band_edges()
    for b in range(BANDS):
        value, error = 100.0 * found.value[b], 100.0 * found.error[b]
        expect(abs(value) < LEVEL_LIMIT_PERCENT and error < LEVEL_LIMIT_PERCENT / 2.0,
               f"{what}, {edges[b]:.1f} to {edges[b + 1]:.1f} nm: {found.ours[b]:.4e} and {found.theirs[b]:.4e} "
               f"W/m²/nm, {value:+.3f} % ± {error:.3f}")


def compare_blocks(ours, theirs):
    """No block is off by more than chance, in any band."""
    found = Difference(blocks(ours), blocks(theirs))
    count = (PIXELS // BLOCK) ** 2
    # Squares of Student's t with 2 (RUNS − 1) degrees of freedom ν: the mean is ν / (ν − 2), the variance nearly 2.
    freedom = 2.0 * (RUNS - 1)
    limit = freedom / (freedom - 2.0) + DEVIATIONS * (2.0 / count) ** 0.5
    edges = band_edges()
    for b in range(BANDS):
        squares = (found.value[..., b] / found.error[..., b]) ** 2
        expect(squares.mean() < limit,
               f"blocks, {edges[b]:.1f} to {edges[b + 1]:.1f} nm: chi² {squares.mean():.2f} a block (at most {limit:.2f}), "
               f"errors {100.0 * found.error[..., b].min():.1f} to {100.0 * found.error[..., b].max():.1f} %")


def compare_structure(ours, theirs, walls):
    """Over all bands together the difference follows neither brightness nor place, nor does a block stand out."""
    import numpy
    found = Difference(blocks(ours.mean(3)), blocks(theirs.mean(3)))
    counted = blocks(walls[None])[0] == 1.0
    place = 2.0 * (numpy.arange(PIXELS // BLOCK) + 0.5) * BLOCK / PIXELS - 1.0
    x, y = numpy.meshgrid(place, place)
    for what, over in (("brightness, from black to the brightest", found.theirs / found.theirs[counted].max()),
                       ("columns, from the middle to an edge", x), ("rows, from the middle to an edge", y),
                       ("distance from the centre, squared, to an edge", x * x + y * y)):
        value, error = slope(over, found, counted)
        expect(abs(value) < DEVIATIONS * error and error < SLOPE_LIMIT,
               f"difference over {what}: {100.0 * value:+.2f} % ± {100.0 * error:.2f}")
    worst = abs(found.value / found.error).max()
    expect(worst < DEVIATIONS, f"largest of the blocks' differences: {worst:.1f} standard errors")


def render_both(program, scenes, scratch):
    """Film irradiance in W/m²/nm, [run, row, column, band], by lensproof and by Mitsuba."""
    import numpy, mitsuba
    mitsuba.set_variant("scalar_spectral")
    file, scene = small_copy(scenes, scratch)
    ours = numpy.stack([render_with_lensproof(program, file, scratch, seed) for seed in range(RUNS)])
    theirs_scene = mitsuba_scene(mitsuba, scene, scratch)
    theirs = numpy.stack([numpy.array(mitsuba.render(theirs_scene, seed=seed)) for seed in range(RUNS)])
    band_nm = (RANGE_NM[1] - RANGE_NM[0]) / BANDS
    return ours, theirs * irradiance_of_radiance(scene["camera"])[None, :, :, None] / band_nm


def main():
    program, scenes, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    missing = fetch(folder, PACKAGES)
    if missing:
        print(f"skipped: Mitsuba could not be fetched: {missing}")
        return SKIPPED
    with tempfile.TemporaryDirectory() as scratch:
        ours, theirs = render_both(program, scenes, pathlib.Path(scratch))
    walls = outside_lamp(theirs.mean((0, 3)))
    compare_levels(ours, theirs, walls | True, "whole image")
    compare_levels(ours, theirs, walls, "without the lamp")
    compare_blocks(ours, theirs)
    compare_structure(ours, theirs, walls)
    print(f"{len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
