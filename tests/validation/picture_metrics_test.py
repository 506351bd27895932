"""Metrics of pictures against other programs': picture_metrics_test.py LENSPROOF FOLDER

LENSPROOF is the built program, FOLDER keeps what pip fetched: scikit-image for PSNR, SSIM and CIEDE2000, and FLIP's
authors' own flip-evaluator. Without pip or a package index this says so and exits with 77 (skipped). Without LENSPROOF
("-") it prints the others' numbers, which tests/calibration/comparison holds the same pictures to.

Two small pictures that a formula makes, once as PNG of sRGB's values and once as Radiance HDR of 200 : 1, go to both as
they are: no registration, no matching of exposure. PSNR and SSIM are the same arithmetic in double precision on single
precision's numbers, 1e-5. FLIP's authors calculate in single precision and promise four digits, 1e-4. scikit-image's
CIELAB takes sRGB's matrix and white with five digits, 2e-3 of differences of 10 and more.
"""
import json, pathlib, subprocess, sys, tempfile

sys.dont_write_bytecode = True
from fetched import fetch

SKIPPED = 77
PACKAGES = ("scikit-image==0.26.0", "flip-evaluator==1.7", "numpy==2.4.6")
WIDTH, HEIGHT = 96, 80

failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)
    print(("ok      " if holds else "FAILED  ") + what)


def made():
    """The two pictures as bytes, and as mantissas (128 to 255) and exponents of Radiance HDR."""
    import numpy as np

    y, x, c = np.mgrid[0:HEIGHT, 0:WIDTH, 0:3]
    wave = (x * 5 + y * 3 + 40 * c + x * y // 7) % 256
    change = (x * 3 + y * 7 + c * 11) % 21 - 10
    low = wave, np.clip(wave + change, 0, 255)
    mantissa = 128 + wave // 2
    high = mantissa, np.clip(mantissa + change, 128, 255)
    exponent = (x // 6 + y // 5)[..., 0] % 7 - 3
    return low, high, exponent


def write_hdr(file, mantissa, exponent):
    import numpy as np

    pixels = np.concatenate([mantissa, (exponent + 128)[..., None]], axis=2).astype(np.uint8)
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n"
    pathlib.Path(file).write_bytes(header.encode() + pixels.tobytes())


def others(a, b):
    """What the other programs say of two pictures of sRGB's values."""
    import flip_evaluator
    import numpy as np
    from skimage import color, metrics

    differences = color.deltaE_ciede2000(color.rgb2lab(a), color.rgb2lab(b))
    return {"psnr_db": metrics.peak_signal_noise_ratio(a, b, data_range=1.0),
            "ssim": metrics.structural_similarity(a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
                                                  data_range=1.0, channel_axis=2),
            "flip": flip_evaluator.evaluate(a.astype(np.float32), b.astype(np.float32), "LDR", applyMagma=False)[1],
            "ciede2000_mean": differences.mean(), "ciede2000_p99": np.percentile(differences, 99, method="lower")}


def said(program, a, b):
    done = subprocess.run([program, "compare", str(a), str(b), "--registration", "none", "--exposure", "none", "--json",
                           "-"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    if complaint := fetch(folder, PACKAGES):
        print(f"skipped: {complaint}")
        sys.exit(SKIPPED)
    import flip_evaluator
    import numpy as np
    from skimage import io

    (low_a, low_b), (high_a, high_b), exponent = made()
    expected = others(low_a / 255.0, low_b / 255.0)
    light = [np.ldexp(mantissa / 256.0, exponent[..., None]).astype(np.float32) for mantissa in (high_a, high_b)]
    _, flip_high, parameters = flip_evaluator.evaluate(*light, "HDR", applyMagma=False)
    print(expected, "FLIP, high range", flip_high, parameters)
    if program == "-":
        return
    with tempfile.TemporaryDirectory() as scratch:
        place = pathlib.Path(scratch)
        for name, low, high in (("a", low_a, high_a), ("b", low_b, high_b)):
            io.imsave(place / f"{name}.png", low.astype(np.uint8), check_contrast=False)
            write_hdr(place / f"{name}.hdr", high, exponent)
        found = said(program, place / "a.png", place / "b.png")
        for key, tolerance in (("psnr_db", 1e-5), ("ssim", 1e-5), ("flip", 1e-4), ("ciede2000_mean", 2e-3),
                               ("ciede2000_p99", 2e-3)):
            scale = 1.0 if key in ("ssim", "flip") else expected[key]
            expect(abs(found[key] - expected[key]) <= tolerance * scale,
                   f"{key}: {found[key]:.7f}, the others say {expected[key]:.7f}")
        found = said(program, place / "a.hdr", place / "b.hdr")
        expect(found["flip_range"] == "high", "HDR's pictures are of a high range")
        expect(abs(found["flip"] - flip_high) <= 1e-4, f"FLIP, high range: {found['flip']:.7f}, its authors say {flip_high:.7f}")
    sys.exit(1 if failures else 0)


main()
