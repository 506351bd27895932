"""The Zemax files that other programs ship, fetched from the package index.

They are other people's work and are never committed. Each archive is pinned by its SHA-256, so that what is compared
is what first_order.json was computed from.
"""
import pathlib, subprocess, sys, tarfile, tempfile, zipfile

# rayoptics keeps its samples in its wheel (0.5 MB). Optiland's stand beside its tests, and so only in its source
# archive (53 MB, most of it pictures of its manual). Nothing but the samples is kept of either.
ARCHIVES = [
    {"package": "rayoptics", "version": "0.9.8", "kind": "wheel",
     "sha256": "71a5a82770e6281e337885e0c78aa438806d65c1dae8b22b224d6308ba98e796"},
    {"package": "optiland", "version": "0.6.3", "kind": "source",
     "sha256": "72f4282ae3c147953630a1dc3fefc27c6d66d8d53d490f188509ecc029a0d0b6"},
]


class Unavailable(Exception):
    """There is no pip, or it cannot reach a package index."""


def zemax_files(archive):
    """Path and bytes of every .zmx in a wheel, or in a source archive without its top folder."""
    if archive.suffix == ".whl":
        with zipfile.ZipFile(archive) as content:
            for name in content.namelist():
                if name.lower().endswith(".zmx"):
                    yield name, content.read(name)
    else:
        with tarfile.open(archive) as content:
            for member in content:
                if member.isfile() and member.name.lower().endswith(".zmx"):
                    yield member.name.split("/", 1)[1], content.extractfile(member).read()


def download(archive, folder):
    """The archive's file, which pip fetched into the folder and whose hash it checked."""
    requirement = folder / "requirement.txt"
    requirement.write_text(f"{archive['package']}=={archive['version']} --hash=sha256:{archive['sha256']}\n")
    form = "--only-binary" if archive["kind"] == "wheel" else "--no-binary"
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps",
               "--require-hashes", form, archive["package"], "--retries", "1", "--timeout", "30",
               "--dest", str(folder / "archive"), "--requirement", str(requirement)]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=480)
    except subprocess.TimeoutExpired:
        raise Unavailable("pip took longer than 480 s") from None
    if done.returncode != 0:
        if "DO NOT MATCH" in done.stderr:
            raise RuntimeError(f"{archive['package']} {archive['version']} is not the archive that is pinned here: "
                               + done.stderr)
        raise Unavailable(done.stderr.strip() or f"pip ended with {done.returncode}")
    return next((folder / "archive").iterdir())


def fetch(folder):
    """Makes sure that folder/PACKAGE-VERSION/… holds the samples under their paths inside their archives."""
    for archive in ARCHIVES:
        place = folder / f"{archive['package']}-{archive['version']}"
        if place.is_dir():
            continue
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            scratch = pathlib.Path(scratch)
            kept = scratch / "kept"
            for path, content in zemax_files(download(archive, scratch)):
                file = kept / path
                if not file.resolve().is_relative_to(kept.resolve()):
                    raise RuntimeError(f"{archive['package']}: {path} leads out of its archive")
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
            try:
                kept.rename(place)
            except OSError:  # another test run was quicker
                if not place.is_dir():
                    raise


def read_text(file):
    """The text of a .zmx, whose encoding nothing but its first bytes tells."""
    content = file.read_bytes()
    if content.startswith(b"\xff\xfe"):
        return content.decode("utf-16"), "UTF-16"
    try:
        return content.decode("ascii"), "ASCII"
    except UnicodeDecodeError:
        return content.decode("iso-8859-1"), "ISO 8859-1"
