#!/usr/bin/env python3
"""The table of attacks: what was done to the program, how often, and how often it failed.

    attacks.py PROGRAM FUZZ_REPLAY FAILING_CALLS [--scale S] [--only WORD]

PROGRAM is `lensproof`, FUZZ_REPLAY runs the readers of tests/fuzz, FAILING_CALLS is the library of
tests/failing_calls.cpp. The same scale gives the same attacks, but for the moments of the kills. Exit status 1 where one was a success.
"""
import argparse
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

CORPUS = pathlib.Path(__file__).resolve().parent.parent / "fuzz" / "corpus"
SCENE = """[camera]
lens = "tessar"
f_number = 8.0
focus_distance_mm = 10000.0
sensor_mm = [72.0, 54.0]
pixels = [32, 24]
shutter_s = 0.08
iso = 100.0
response = "camera"
[chart]
kind = "checkerboard"
squares = [12, 9]
square_mm = 560.0
[pose]
distance_mm = 10000.0
[render]
samples_per_pixel = 64
layers = 4
"""
MESH_SCENE = """[camera]
model = "pinhole"
focal_length_mm = 50.0
f_number = 8.0
focus_distance_mm = 3000.0
position_mm = [0.0, 0.0, 3000.0]
look_at_mm = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
sensor_mm = [36.0, 24.0]
pixels = [6, 4]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[render]
samples_per_pixel = 1
layers = 4
[[objects]]
shape = "mesh"
file = "{mesh}"
material = "grey"
[[materials]]
name = "grey"
kind = "diffuse"
reflectance = 0.5
[[lights]]
kind = "environment"
luminance_cd_m2 = 1.0
illuminant = "D65"
"""
RENDER = ["render", "scene.toml", "--quiet"]


class Place:
    """A folder for one attack, with a cache of its own beside the program's."""

    def __init__(self, program, failing_calls, name):
        self.program = program
        self.failing_calls = failing_calls
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix=f"lensproof-{name}-"))
        self.cache = self.folder / "cache"
        self.write("scene.toml", SCENE)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder, ignore_errors=True)

    def write(self, name, content):
        (self.folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())

    def read(self, name):
        file = self.folder / name
        return file.read_bytes() if file.exists() else b""

    def start(self, *arguments, mib=None, variables=None):
        def limit():
            if mib:
                resource.setrlimit(resource.RLIMIT_AS, (mib << 20, mib << 20))
        return subprocess.Popen([self.program, *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, preexec_fn=limit,
                                env={**os.environ, "LENSPROOF_CACHE": str(self.cache), **(variables or {})})

    def run(self, *arguments, mib=None, seconds=120, variables=None):
        """Status (negative: a signal; 124: not done in time) and what was said."""
        process = self.start(*arguments, mib=mib, variables=variables)
        try:
            _, said = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return 124, ""
        return process.returncode, said.decode(errors="replace")


def damaged(content, chance):
    """A bit, a run of bytes, or the end of a file."""
    content = bytearray(content)
    at = chance.randrange(len(content))
    kind = chance.randrange(4)
    if kind < 2:
        content[at] ^= 1 << chance.randrange(8)
    elif kind == 2:
        for i in range(at, min(len(content), at + chance.randrange(1, 64))):
            content[i] = chance.choice([0, 255])
    else:
        del content[at:]
    return bytes(content)


def mutants_of(reader, count, fuzz):
    done = subprocess.run([fuzz, reader, CORPUS / reader, str(count)], capture_output=True, check=False)
    said = done.stdout.decode(errors="replace").strip().splitlines() or ["nothing said"]
    return count, 0 if done.returncode == 0 else max(1, len(said) - 1), "" if done.returncode == 0 else said[0]


def bombs(place, _count):
    """Pictures and meshes, files of a few kilobytes that promise gigabytes or overrun their readers among them: read or
    refused in 3 GB and 20 s."""
    failures = []
    pictures = sorted((CORPUS / "picture").iterdir())
    commands = [(file.name, ["compare", str(file), str(file)]) for file in pictures]
    for mesh in sorted(f for reader in ("gltf", "glb", "obj", "ply") for f in (CORPUS / reader).iterdir()):
        scene = f"{mesh.name}.toml"
        place.write(mesh.name, mesh.read_bytes())
        place.write(scene, MESH_SCENE.format(mesh=mesh.name).encode())
        commands.append((mesh.name, ["render", scene, "--quiet", "-o", "mesh.exr"]))
    for name, command in commands:
        for more in ([], ["--untrusted"]):
            status, said = place.run(*command, *more, mib=None if more else 3000, seconds=20)
            if status not in (0, 2):
                failures.append(f"{name}: {status} {said}")
    return 2 * len(commands), failures


def mutated_lenses(place, count):
    """Lenses with numbers that are no longer what they were: refused, or analysed and rendered in time."""
    failures = []
    chance = random.Random(5)
    lenses = sorted((pathlib.Path(__file__).resolve().parents[2] / "lenses").glob("*.toml"))
    number = re.compile(r"(?<==)( *)(-?\d+\.?\d*)(?=[ ,}])")
    for _ in range(count):
        text = chance.choice(lenses).read_text()
        for _ in range(chance.randrange(1, 4)):
            match = chance.choice(list(number.finditer(text)))
            value = chance.choice(["0", "1e-9", "1e6", "1e7", "0.1", "-" + match[2].lstrip("-")])
            text = f"{text[:match.start(2)]}{value}{text[match.end(2):]}"
        place.write("lens.toml", text)
        place.write("scene.toml", SCENE.replace("[32, 24]", "[8, 6]").replace('"tessar"', '"lens.toml"'))
        for command in (["analyze", "lens.toml"], [*RENDER, "-o", "a.exr"]):
            status, said = place.run(*command, seconds=60)
            if status not in (0, 1, 2):
                failures.append(f"{command[0]}: {status} {said}\n{text}")
    return 2 * count, failures


def kills(place, count):
    """Renders killed at any moment and taken up again: nothing half-written, no part left, the same bytes."""
    failures = []
    place.run(*RENDER, "-o", "whole.exr")
    whole = place.read("whole.exr")
    command = [*RENDER, "-o", "killed.exr", "--checkpoint", "state", "--checkpoint-interval", "0.01", "--preview",
               "p.png"]
    chance = random.Random(1)
    for _ in range(count):
        process = place.start(*command)
        time.sleep(chance.uniform(0.0, 1.0))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        if place.read("killed.exr") not in (b"", whole):
            failures.append("a picture that is half-written")
    status, said = place.run(*command)
    if status != 0 or place.read("killed.exr") != whole:
        failures.append(f"another picture after {count} kills: {status} {said}")
    failures += [f"{part.name} is left" for part in place.folder.iterdir() if "part" in part.name]
    return count, failures


def threads(place, count):
    """Any number of threads, any seed: the same bytes."""
    failures = []
    for seed in range(count):
        seen = set()
        for number in (1, 2, 3, 7):
            place.run(*RENDER, "--seed", str(seed), "--threads", str(number), "--spp", "32", "-o", "a.exr")
            seen.add(place.read("a.exr"))
        if len(seen) != 1:
            failures.append(f"seed {seed}: {len(seen)} pictures")
    return 4 * count, failures


def caches(place, count):
    """Files of the cache with bits turned, overwritten, or cut: the picture is the same."""
    failures = []
    place.run(*RENDER, "--spp", "16", "-o", "a.exr")
    whole = place.read("a.exr")
    files = sorted(f for f in place.cache.rglob("*") if f.is_file())
    if not files:
        return 0, ["no cache was written"]
    chance = random.Random(2)
    for _ in range(count):
        for file in files:
            if file.exists() and file.stat().st_size > 0:
                file.write_bytes(damaged(file.read_bytes(), chance))
        status, said = place.run(*RENDER, "--spp", "16", "-o", "a.exr")
        if status != 0 or place.read("a.exr") != whole:
            failures.append(f"{status} {said}")
    return count, failures


def shards(place, count):
    """Shards with bits turned, overwritten, or cut: refused, or the same picture."""
    failures = []
    place.run(*RENDER, "-o", "a.exr")
    for shard in (1, 2):
        place.run(*RENDER, "--shard", f"{shard}/2", "-o", f"s{shard}.exr")
    place.run("merge", "s1.exr", "s2.exr", "-o", "m.exr")
    merged = place.read("m.exr")
    whole = place.read("s2.exr")
    chance = random.Random(3)
    for _ in range(count):
        place.write("s2.exr", damaged(whole, chance))
        (place.folder / "m.exr").unlink(missing_ok=True)
        status, said = place.run("merge", "s1.exr", "s2.exr", "-o", "m.exr")
        is_refused = status == 2 and not place.read("m.exr")
        if not is_refused and (status != 0 or place.read("m.exr") != merged):
            failures.append(f"{status} {said}")
    return count, failures


def checkpoints(place, count):
    """Checkpoints with bits turned, overwritten, or cut: refused, or the same picture."""
    failures = []
    command = [*RENDER, "-o", "a.exr", "--checkpoint", "state"]
    place.run(*command, "--spp", "32")
    state = place.read("state")
    place.run(*command)
    whole = place.read("a.exr")
    chance = random.Random(4)
    for _ in range(count):
        (place.folder / "a.exr").unlink()
        place.write("state", damaged(state, chance))
        status, said = place.run(*command)
        if status != 2 and (status != 0 or place.read("a.exr") != whole):
            failures.append(f"{status} {said}")
        place.write("a.exr", whole)
    return count, failures


def failing_calls(place, count):
    """Calls that write, flush, rename or allocate fail one after the other: every output is whole or not there."""
    failures = []
    commands = {"a.exr": [*RENDER, "--spp", "16", "-o", "a.exr", "--checkpoint", "state"],
                "t.zmx": ["convert", "tessar", "t.zmx"], "c.pdf": ["chart", "checkerboard", "-o", "c.pdf", "--quiet"]}
    done = 0
    for output, command in commands.items():
        place.run(*command)
        whole = place.read(output)
        for kind, step in (("write", 1), ("writes", 1), ("new", 97)):
            for call in range(1, 1 + count):
                for name in (output, "state"):
                    (place.folder / name).unlink(missing_ok=True)
                status, said = place.run(*command, variables={"LD_PRELOAD": place.failing_calls,
                                                              "LENSPROOF_FAIL": f"{kind} {call * step}",
                                                              "TMPDIR": str(place.folder)})
                done += 1
                if status not in (0, 1, 2, 3) or place.read(output) not in ((whole,) if status == 0 else (b"", whole)):
                    failures.append(f"{output}, {kind} {call * step}: {status} {said}")
    return done, failures


# What is attacked, how often at scale 1, and how.
READERS = {reader.name: 300 if reader.name == "raw_picture" else 3000 for reader in sorted(CORPUS.iterdir())}
ATTACKS = {"bombs and overruns": (bombs, 1), "mutated lenses": (mutated_lenses, 40), "kills": (kills, 8), "threads": (threads, 2),
           "damaged caches": (caches, 8), "damaged shards": (shards, 16), "damaged checkpoints": (checkpoints, 8),
           "failing calls": (failing_calls, 6)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("fuzz", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("failing_calls", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    found = 0
    print(f"{'attack':28} {'count':>9} {'failures':>9} {'s':>7}", flush=True)

    def row(name, attack):
        nonlocal found
        if options.only not in name:
            return
        start = time.monotonic()
        count, failures, first = attack()
        found += failures
        print(f"{name:28} {count:9} {failures:9} {time.monotonic() - start:7.1f}", flush=True)
        if failures:
            print(f"    {first}", flush=True)

    with tempfile.TemporaryDirectory() as here:
        os.chdir(here)  # where readers leave the mutants that end them
        for reader, count in READERS.items():
            row(f"mutants: {reader}", lambda r=reader, n=count: mutants_of(r, max(1, round(n * options.scale)),
                                                                          options.fuzz))
    for name, (attack, count) in ATTACKS.items():
        def carried_out(attack=attack, count=count, name=name):
            with Place(options.program, options.failing_calls, name.split()[-1]) as place:
                done, failures = attack(place, max(1, round(count * options.scale)))
                return done, len(failures), failures[0] if failures else ""
        row(name, carried_out)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
