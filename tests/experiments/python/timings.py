"""How long an import takes, and how fast rays are traced from Python: timings.py PACKAGES BENCHMARK

PACKAGES is the folder to import from; BENCHMARK, lensproof_benchmark, times the same million rays of the same columns in
C++, in turns with Python, so that both have the same machine.
"""
import json, os, subprocess, sys, tempfile, time

sys.dont_write_bytecode = True
packages, benchmark = sys.argv[1:]
sys.path.insert(0, packages)
RAYS, TURNS, CALLS = 1_000_000, 9, 6


def imported(module):
    code = f"import time; before = time.perf_counter(); import {module}; print(time.perf_counter() - before)"
    environment = {**os.environ, "PYTHONPATH": packages}
    return min(float(subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True,
                                    check=True).stdout) for _ in range(TURNS))


print(f"import lensproof: {imported('lensproof'):.3f} s, of which NumPy {imported('numpy'):.3f} s (best of {TURNS})")

import lensproof
import numpy as np

lens = lensproof.Lens.load("tessar")
# 512 rays that pass, as the benchmark's do, again and again.
random = np.random.default_rng(1)
some = lensproof.Rays(random.uniform(-15, 15, 4096), random.uniform(-15, 15, 4096), -10.0,
                      random.uniform(-0.1, 0.1, 4096), random.uniform(-0.1, 0.1, 4096), 1.0, 550.0)
traced = lens.trace(some)
which = np.resize(np.flatnonzero(traced.ok)[:512], RAYS)
direction = np.column_stack(np.broadcast_arrays(some.dx, some.dy, some.dz))
direction /= np.linalg.norm(direction, axis=1)[:, None]
rays = lensproof.Rays(*(np.ascontiguousarray(np.broadcast_to(column, 4096)[which])
                        for column in (some.x_mm, some.y_mm, some.z_mm, *direction.T)), 550.0)


def of_python(out):
    begin = time.process_time()
    for _ in range(CALLS):
        lens.trace(rays, threads=1, out=out)
    return CALLS * RAYS / (time.process_time() - begin)


def of_cpp():
    with tempfile.NamedTemporaryFile() as file:
        subprocess.run([benchmark, "--benchmark_filter=arrays/tessar/million/one_thread", "--benchmark_min_time=0.3",
                        f"--benchmark_out={file.name}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        return 1e9 * RAYS / json.load(file)["benchmarks"][0]["cpu_time"]


out = lens.trace(rays)
rates = {"C++": of_cpp, "Python, out=": lambda: of_python(out), "Python": lambda: of_python(None)}
best = dict.fromkeys(rates, 0.0)
for _ in range(TURNS):
    best = {who: max(best[who], rate()) for who, rate in rates.items()}
print("rays per second of processor time, one thread: " + ", ".join(
    f"{who} {rate * 1e-6:.2f} M ({rate / best['C++']:.0%})" for who, rate in best.items()))
