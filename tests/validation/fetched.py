"""Packages that pip fetches for a test, kept in a folder of their versions."""
import pathlib, subprocess, sys, tempfile


def fetch(folder, packages, dependencies=True):
    """Why the packages cannot be had, or nothing; then they can be imported."""
    place = folder / "-".join(package.replace("==", "-") for package in packages)
    if not place.is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input",
                       *([] if dependencies else ["--no-deps"]), "--only-binary", ":all:", "--retries", "1",
                       "--timeout", "30", "--target", scratch + "/packages", *packages]
            try:
                done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=480)
            except subprocess.TimeoutExpired:
                return "pip took longer than 480 s"
            if done.returncode != 0:
                return done.stderr.strip() or f"pip ended with {done.returncode}"
            try:
                pathlib.Path(scratch, "packages").rename(place)
            except OSError:  # another test run was quicker
                if not place.is_dir():
                    raise
    sys.path.insert(0, str(place))
    return None
