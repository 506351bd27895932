#!/usr/bin/env python3
"""overhead.py PROGRAM SOURCE [--shards N] [--spp N] — what workers that die cost, in processor time.

A render in shards and an experiment of a hundred settings on a `LocalCluster` of two workers, of which every tenth task
has its worker killed. What all processes took together, workers and scheduler included, over the sum of the parts: of
each kind (a shard, a merge, the report) as many as there are times what one takes that nobody disturbed.
By hand: minutes, and less is told of what takes seconds.
"""
import argparse
import collections
import ctypes
import json
import os
import pathlib
import resource
import shutil
import statistics
import sys
import tempfile
import time

import distributed

arguments = argparse.ArgumentParser()
arguments.add_argument("program", type=pathlib.Path)
arguments.add_argument("source", type=pathlib.Path)
arguments.add_argument("--shards", type=int, default=64)
arguments.add_argument("--spp", type=int, default=4096)
sys.dont_write_bytecode = True
PR_SET_CHILD_SUBREAPER = 36
# Of each of the hundred settings, what takes a moment.
FIELDS = """
field_deg = { from = 0.0, to = 20.0, count = 3 }
frequency_per_mm = 20.0
"""


def seconds_of_all():
    """Of processor time, of this process and all that it started: those that live, and those that were waited for."""
    ticks = os.sysconf("SC_CLK_TCK")
    parents, used = {}, {}
    for place in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            fields = (place / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents[int(place.name)] = int(fields[1])
        used[int(place.name)] = sum(map(int, fields[11:15])) / ticks
    mine = {os.getpid()}
    while more := {child for child, parent in parents.items() if parent in mine} - mine:
        mine |= more
    return sum(used[process] for process in mine if process in used)


def performed(task):
    """cluster.perform, which notes that it began, and what it took where it came to its end."""
    import cluster

    def note(seconds):
        with open(os.environ["LENSPROOF_NOTES"], "a") as notes:
            json.dump([task.arguments[0] + " --shard" * ("--shard" in task.arguments), task.result.name, seconds], notes)
            notes.write("\n")

    note(None)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = cluster.perform(task)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    note(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return result


def sum_of_parts(notes):
    """In seconds, and how many parts there are."""
    tries, undisturbed, others = collections.Counter(), collections.defaultdict(list), collections.defaultdict(list)
    noted = [json.loads(line) for line in notes.read_text().splitlines()]
    for kind, name, seconds in noted:
        tries[kind, name] += seconds is None
    for kind, name, seconds in noted:
        if seconds is not None:
            (undisturbed if tries[kind, name] == 1 else others)[kind].append(seconds)
    # Of a kind that is there once and was disturbed, what its last try took.
    return sum(statistics.fmean(undisturbed[kind] or others[kind]) for kind, _ in tries), len(tries)


def measured(what, cores, notes, killer, work):
    notes.write_text("")
    before, begin = seconds_of_all(), time.monotonic()
    work()
    wall, all_of_it = time.monotonic() - begin, seconds_of_all() - before
    parts, count = sum_of_parts(notes)
    print(f"{what}: {count} parts, {killer.killed} workers killed; parts {parts:.1f} s of processor time, all "
          f"{all_of_it:.1f} s: {all_of_it / parts - 1:.1%} more; {wall:.1f} s on {cores} workers, "
          f"{wall * cores / parts - 1:.1%} more than the parts side by side", flush=True)


def main():
    given = arguments.parse_args()
    package = str((given.source / "experiments/python/lensproof").resolve())
    sys.path.insert(0, package)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="lensproof-overhead-"))
    notes = folder / "notes"
    os.environ.update(LENSPROOF_PROGRAM=str(given.program.resolve()), LENSPROOF_CACHE="off",
                      LENSPROOF_NOTES=str(notes), PYTHONPATH=f"{package}:{pathlib.Path(__file__).resolve().parent}")
    import cluster
    import common

    cluster.perform = performed
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)  # whose parent was killed is ours, and counts
    experiment = folder / "settings.toml"
    experiment.write_text(common.settings(10).replace("field_deg = 10.0", FIELDS)
                          .replace("measure = [", 'measure = ["mtf_tangential", '))
    scene = given.source / "experiments/scenes/tessar_checkerboard.toml"
    try:
        with cluster.local_cluster(n_workers=2, silence_logs=50,
                                   local_directory=str(folder / "workers")) as local, distributed.Client(local) as client:
            killer = common.Killer(client, given.shards)
            measured("render", 2, notes, killer, lambda: cluster.render(
                scene, folder / "picture.exr", client, given.shards, ["--spp", str(given.spp)], progress=killer))
            killer = common.Killer(client, 30)
            measured("sweep", 2, notes, killer, lambda: cluster.experiments(
                [experiment], folder / "sweep", client, progress=killer))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
