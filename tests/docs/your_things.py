"""What the pages take for granted that a reader has: a lens file, photos of a chart, a profile of them.

The photos are simulated, through the lens of the lens file, so that what the pages say of them is known beforehand.
"""
import pathlib, shutil, subprocess

SCENE = """[camera]
lens = "{lens}"
f_number = 8.0
focus_distance_mm = 1000.0
sensor_mm = [36.0, 24.0]
pixels = [600, 400]
shutter_s = 0.05
iso = 100.0
response = "cie-1931"
[chart]
kind = "checkerboard"
squares = [10, 7]
square_mm = 30.0
[pose]
distance_mm = {distance}
towards_deg = [{right}, {down}]
tilt_deg = [{x}, {y}, {z}]
[render]
samples_per_pixel = 64
layers = 16
strata_per_layer = 1
"""
POSES = [(1050, 0, 0, 0, 0, 0), (1150, 1, 1, 25, 0, 5), (1150, -1, -1, -25, 5, 0), (1150, 1, -1, 0, 28, -4),
         (1150, -1, 1, 5, -28, 3), (1300, 2.5, 1, 20, 20, 0), (1300, -2.5, -1, -20, -20, 5)]
MANIFEST = """name = "My 100 mm at f/8"
licence = "my own"
source = "simulated"
pixel_pitch_um = 60.0
folders = ["."]
photos = [{photos}]
[chart]
kind = "checkerboard"
squares = [10, 7]
square_mm = 30.0
"""


def run(program, folder, *words):
    subprocess.run([program, *map(str, words), "--quiet"], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def make(program, folder):
    """my_lens.zmx, my_photos with their manifest, and my_profile.json."""
    folder = pathlib.Path(folder)
    photos = folder / "my_photos"
    photos.mkdir(parents=True, exist_ok=True)
    run(program, folder, "convert", "tessar", "my_lens.zmx")
    for i, (distance, right, down, x, y, z) in enumerate(POSES, 1):
        scene = folder / f"board_{i:02}.toml"
        scene.write_text(SCENE.format(lens="tessar", distance=distance, right=right, down=down, x=x, y=y, z=z))
        run(program, folder, "render", scene.name, "-o", f"board_{i:02}.exr", "--seed", i)
        shutil.move(folder / f"board_{i:02}.png", photos / f"board_{i:02}.png")
        (folder / f"board_{i:02}.exr").unlink()
    names = ", ".join(f'"board_{i:02}.png"' for i in range(1, len(POSES) + 1))
    (photos / "manifest.toml").write_text(MANIFEST.format(photos=names))


if __name__ == "__main__":
    import sys
    make(*sys.argv[1:])
