"""Camera models that `export --to mrcal` writes, read and applied by mrcal itself: mrcal_test.py LENSPROOF

LENSPROOF is the built program. Profiles of five models are written by hand, exported, read by mrcal.cameramodel, and
mrcal.project puts directions over the whole frame where the profile's own formula, written out here, puts them: within
1e-9 px for models that mrcal has (sixteen digits of some hundred pixels), within the difference that the export states
for those that it fits: a tenth more, for it looks at 49 columns of pixels, and not between them. Wants Debian's python3-mrcal; exits with 77 (skipped)
without.
"""
import json, pathlib, subprocess, sys, tempfile

SKIPPED = 77
DEBIANS = "/usr/bin/python3"

try:
    import mrcal
    import numpy as np
except ImportError:
    if sys.executable != DEBIANS and pathlib.Path(DEBIANS).exists():
        sys.exit(subprocess.run([DEBIANS, *sys.argv], stdin=subprocess.DEVNULL).returncode)
    print("left out: there is no mrcal (Debian: python3-mrcal)")
    sys.exit(SKIPPED)

SIZE = (640, 480)
CENTRE = {"centre_x_px": 318.5, "centre_y_px": 243.0}
STRETCH = {"stretch_y": 0.003}
# Each with the model that mrcal has for it, or None where one is to be fitted.
PROFILES = [
    ("brown-conrady", {"focal_length_px": 820.0, **CENTRE, "k1": -0.2, "k2": 0.05, "k3": 0.0, "p1": 5e-4, "p2": -1e-3},
     "LENSMODEL_OPENCV4"),
    ("brown-conrady", {"focal_length_px": 820.0, **CENTRE, "k1": -0.2, "k2": 0.05, "k3": 0.02, "p1": 5e-4, "p2": -1e-3},
     "LENSMODEL_OPENCV5"),
    ("stereographic", {"focal_length_px": 260.0, **CENTRE, "k1": 0.0, "k2": 0.0}, "LENSMODEL_STEREOGRAPHIC"),
    ("division", {"focal_length_px": 820.0, **CENTRE, "lambda": -0.12}, None),
    ("equisolid", {"focal_length_px": 450.0, **CENTRE, "k1": -0.02, "k2": 0.003}, None),
]
COVERED = 0.7  # of the half diagonal
EXACT_PX = 1e-9
BETWEEN = 1.1


def profile(kind, parameters):
    parameters = {**parameters, **STRETCH}
    names = list(parameters)
    return {
        "schema": "lensproof-profile/1", "name": kind,
        "source": {"kind": "photo", "images": [], "camera": "unknown", "lens": "unknown", "settings": {}},
        "image_size_px": list(SIZE), "channels": ["G"], "pixel_pitch_um": None,
        "model": {"kind": kind,
                  "parameters": {name: {"value": value, "standard_error": 0.0} for name, value in parameters.items()},
                  "covariance": {"parameter_order": names, "matrix": [[0.0] * len(names) for _ in names]}},
        "reprojection_rms_px": 0.1, "views_used": 1, "points_used": 100, "covered_image_height": COVERED,
        "pictures": [], "views": [], "curves": {}, "terms": {}, "not_measured": {}}


def project(kind, p, rays):
    """Pixels of directions in front, by the formulas of calibration/geometry's headers."""
    x, y = rays[:, 0] / rays[:, 2], rays[:, 1] / rays[:, 2]
    r2 = x * x + y * y
    if kind == "brown-conrady":
        radial = 1 + r2 * (p["k1"] + r2 * (p["k2"] + r2 * p["k3"]))
        u = x * radial + 2 * p["p1"] * x * y + p["p2"] * (r2 + 2 * x * x)
        v = y * radial + p["p1"] * (r2 + 2 * y * y) + 2 * p["p2"] * x * y
    else:
        angle = np.arctan(np.sqrt(r2))
        if kind == "division":  # r_u = r_d / (1 + λ r_d²)
            undistorted = np.sqrt(r2)
            radius = 2 * undistorted / (1 + np.sqrt(1 - 4 * p["lambda"] * r2))
        else:
            g = 2 * np.tan(angle / 2) if kind == "stereographic" else 2 * np.sin(angle / 2)
            radius = g * (1 + p["k1"] * g**2 + p["k2"] * g**4)
        scale = radius / np.sqrt(r2)
        u, v = x * scale, y * scale
    f = p["focal_length_px"]
    return np.column_stack([p["centre_x_px"] + f * u, p["centre_y_px"] + f * (1 + STRETCH["stretch_y"]) * v])


def covered_rays(kind, p):
    """Directions whose pixels lie in the covered part of the frame."""
    slopes = np.linspace(-1.2, 1.2, 60)  # an even number: none on the axis, where the formula divides by 0
    rays = np.array([[x, y, 1.0] for x in slopes for y in slopes])
    pixels = project(kind, p, rays)
    half_diagonal = np.hypot(*SIZE) / 2
    inside = np.hypot(pixels[:, 0] - CENTRE["centre_x_px"], pixels[:, 1] - CENTRE["centre_y_px"]) < COVERED * half_diagonal
    inside &= (pixels >= 0).all(axis=1) & (pixels <= np.array(SIZE) - 1).all(axis=1)
    return rays[inside], pixels[inside]


def check(program, kind, parameters, expected, scratch):
    source, target = scratch / "profile.json", scratch / "camera.cameramodel"
    source.write_text(json.dumps(profile(kind, parameters)))
    done = subprocess.run([program, "export", str(source), "--to", "mrcal", "-o", str(target), "--json", "-"],
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        return f"export ended with {done.returncode}: {done.stderr}"
    stated = json.loads(done.stdout)["largest_difference_px"]
    camera = mrcal.cameramodel(str(target))
    model, values = camera.intrinsics()
    if expected is not None and model != expected:
        return f"is {model}, expected {expected}"
    if tuple(camera.imagersize()) != SIZE:
        return f"has {camera.imagersize()} pixels"
    rays, pixels = covered_rays(kind, parameters)
    found = float(np.hypot(*(mrcal.project(rays, model, values) - pixels).T).max())
    limit = EXACT_PX if expected is not None else BETWEEN * stated
    print(f"{kind} as {model}: {len(rays)} directions, at most {found:.3g} px off, {stated:.3g} stated")
    return None if len(rays) > 100 and found <= limit else f"{found} px off over {len(rays)} directions, allowed {limit}"


def main():
    wrong = []
    with tempfile.TemporaryDirectory() as scratch:
        for kind, parameters, expected in PROFILES:
            why = check(sys.argv[1], kind, parameters, expected, pathlib.Path(scratch))
            if why:
                wrong.append(f"{kind}: {why}")
    print(*wrong, sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
