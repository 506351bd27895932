"""Renders and other work of the command line on many machines, by Dask.

A task is one process of `lensproof` that leaves one file. The file appears whole or not at all, so what has left its
file is done, and what is done twice does no harm. Workers that are killed, that reach their walltime or that are
preempted are the normal case: a task is given to another worker, which goes on from the checkpoint that the last one
left. Workers and client share the folder that they write to, and have `lensproof` (or what $LENSPROOF_PROGRAM names).

    from distributed import Client
    from lensproof import cluster
    cluster.render("scene.toml", "picture.exr", Client("tcp://scheduler:8786"), shards=64, options=["--spp", "4096"])

The same from a shell: `python3 -m lensproof.cluster render scene.toml -o picture.exr --shards 64 --scheduler ADDRESS`.
"""
from __future__ import annotations

import argparse
import contextlib
import dataclasses
import hashlib
import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterable, Sequence

UNUSABLE_INPUT = 2  # an exit status: another try comes to the same
SECONDS_OF_A_SHARD = 5.0  # of an experiment's steps, about

CALM = {
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.tick.interval": "1s",
    "distributed.scheduler.work-stealing-interval": "1s",
    "distributed.worker.memory.monitor-interval": "5s",
    "distributed.worker.profile.interval": "10s",
}
"""For Dask's processes, whose tasks here take seconds: each looks at itself up to a hundred times a second otherwise."""


class TaskFailed(Exception):
    """A process that did not leave its file. `status`: its exit status; minus the signal's number where one ended it."""

    def __init__(self, message: str, status: int):
        super().__init__(message, status)
        self.status = status

    def __str__(self) -> str:
        return self.args[0]


@dataclasses.dataclass(frozen=True)
class Task:
    """A process of the command line, and the file that it leaves; `after`: tasks whose files it reads."""

    arguments: tuple[str, ...]
    result: pathlib.Path
    after: tuple[Task, ...] = ()
    checkpoint: pathlib.Path | None = None  # in its arguments too; gone when it is done
    consumes: bool = False  # the files that it reads are gone when it is done

    def is_done(self) -> bool:
        return self.result.exists()


Progress = Callable[[int, int, float], None]
"""What is told of a run: tasks done, tasks in all, and the seconds that the others will take, as far as can be said."""


def program() -> str:
    """The program `lensproof`: $LENSPROOF_PROGRAM, else the one on the path."""
    found = os.environ.get("LENSPROOF_PROGRAM") or shutil.which("lensproof")
    if not found:
        raise FileNotFoundError("the program lensproof is not on the path; LENSPROOF_PROGRAM may name it")
    return found


def perform(task: Task) -> str:
    """Does the task here, where that is not done yet, and returns the name of its file. Raises TaskFailed."""
    if task.is_done():
        return str(task.result)
    task.result.parent.mkdir(parents=True, exist_ok=True)
    # A worker that is killed takes its process along, which leaves its checkpoint before it goes.
    guard = ["setpriv", "--pdeathsig", "TERM"] if shutil.which("setpriv") else []
    done = subprocess.run([*guard, program(), *task.arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if not task.is_done():
        why = done.stderr.strip() or f"ended with {done.returncode} and left no file"
        raise TaskFailed(f"lensproof {' '.join(task.arguments)}: {why}", done.returncode)
    if task.checkpoint:  # and the pictures that it left where it was ended
        for file in task.checkpoint.parent.glob(task.checkpoint.name + "*"):
            file.unlink(missing_ok=True)
    return str(task.result)


def needed(goals: Iterable[Task]) -> list[Task]:
    """The goals and what they come after, without what is done already; each behind those that it comes after."""
    order: dict[Task, None] = {}

    def visit(task: Task) -> None:
        if task.is_done() or task in order:
            return
        for earlier in task.after:
            visit(earlier)
        order[task] = None

    for goal in goals:
        visit(goal)
    return list(order)


def show_progress(done: int, total: int, seconds_left: float) -> None:
    """On a terminal, a line on standard error."""
    if sys.stderr.isatty():
        left = f"{seconds_left:.0f} s left" if math.isfinite(seconds_left) else ""
        print(f"\r{done} of {total} tasks  {left}\033[K", end="\n" if done == total else "", file=sys.stderr, flush=True)


def local_cluster(**settings):
    """A distributed.LocalCluster of this machine, a worker of one thread for each core unless the settings say otherwise."""
    import dask
    from distributed import LocalCluster

    dask.config.set(CALM)  # and not for a while: a worker that is started again asks, too
    return LocalCluster(**{"threads_per_worker": 1, "dashboard_address": None, **settings})


def run(goals: Sequence[Task], client, attempts: int = 10, progress: Progress = show_progress) -> None:
    """Does the goals, and what they come after, on the client's workers; each at most `attempts` times.

    `client`: a distributed.Client. Raises TaskFailed for what fails as often as that, and at once for what no other try
    will change: unusable input.
    """
    from distributed import as_completed

    tasks = needed(goals)
    waits = {task: {earlier for earlier in task.after if not earlier.is_done()} for task in tasks}
    tried = dict.fromkeys(tasks, 0)
    work = as_completed()
    running = {}
    begun = time.monotonic()

    def start(task: Task) -> None:
        tried[task] += 1
        # Not pure: what it does is not in what it returns, so Dask may not answer from what it remembers.
        future = client.submit(perform, task, pure=False, retries=0)
        running[future.key] = task
        work.add(future)

    for task in tasks:
        if not waits[task]:
            start(task)
    done = 0
    progress(done, len(tasks), math.inf)
    for future in work:
        task = running.pop(future.key)
        if future.status != "finished":
            error = future.exception()
            future.release()
            if tried[task] == attempts or getattr(error, "status", None) == UNUSABLE_INPUT:
                client.cancel([key for key in running])
                raise error
            start(task)
            continue
        future.release()
        if task.consumes:
            for earlier in task.after:
                earlier.result.unlink(missing_ok=True)
                earlier.result.with_suffix(".png").unlink(missing_ok=True)
        done += 1
        progress(done, len(tasks), (time.monotonic() - begun) / done * (len(tasks) - done))
        for later in tasks:
            if task in waits[later]:
                waits[later].remove(task)
                if not waits[later]:
                    start(later)


def _one_thread(options: Sequence[str]) -> tuple[str, ...]:
    """The options, with one thread unless they say how many: Dask gives each core of a worker a task."""
    said = any(option.split("=")[0] == "--threads" for option in options)
    return (*options,) if said else (*options, "--threads", "1")


def _digest(*what) -> str:
    return hashlib.sha256(json.dumps(what).encode()).hexdigest()[:16]


def render_task(scene: os.PathLike | str, folder: os.PathLike | str, shards: int,
                options: Sequence[str] = ()) -> Task:
    """A scene's picture, `whole.exr` in the folder, as a task that comes after those of its shards.

    Shards are merged in groups of about √shards as these are complete, always the same ones: so the picture's bytes do
    not depend on the order in which they come, and the folder never holds much more than the groups.
    """
    folder = pathlib.Path(folder).resolve()
    arguments = ("render", str(pathlib.Path(scene).resolve()), *_one_thread(options), "--quiet")

    def part(number: int) -> Task:
        result = folder / f"part-{number}.exr"
        checkpoint = folder / f"part-{number}.checkpoint"
        return Task((*arguments, "--shard", f"{number}/{shards}", "--checkpoint", str(checkpoint), "-o", str(result)),
                    result, checkpoint=checkpoint)

    def merged(tasks: Sequence[Task], name: str, *how: str) -> Task:
        result = folder / name
        files = [str(task.result) for task in tasks]
        return Task(("merge", *files, "-o", str(result), *how, "--quiet"), result, after=tuple(tasks), consumes=True)

    parts = [part(number) for number in range(1, shards + 1)]
    size = math.ceil(math.sqrt(shards))
    groups = [parts[first:first + size] for first in range(0, shards, size)]
    if len(groups) == 1:
        return merged(parts, "whole.exr")
    return merged([merged(group, f"group-{number}.exr", "--partial") for number, group in enumerate(groups, 1)],
                  "whole.exr")


def render(scene: os.PathLike | str, output: os.PathLike | str, client, shards: int,
           options: Sequence[str] = (), attempts: int = 10, progress: Progress = show_progress) -> pathlib.Path:
    """Renders a scene in shards and returns the picture, `output`, with a PNG beside it.

    `options`: of `lensproof render`, as ["--spp", "4096"]; a shard has whole blocks of 16 samples. What is finished lies
    in a folder beside the output, named by the scene's bytes and the options, until all is: a call that was ended goes
    on from there.
    """
    output = pathlib.Path(output).resolve()
    identity = _digest(pathlib.Path(scene).read_text(), shards, list(options))
    folder = output.with_name(f"{output.stem}.parts-{identity}")
    whole = render_task(scene, folder, shards, options)
    run([whole], client, attempts, progress)
    for suffix in (".png", ".exr"):
        whole.result.with_suffix(suffix).replace(output.with_suffix(suffix))
    shutil.rmtree(folder)
    return output


def sweep(commands: Sequence[Sequence[str]], folder: os.PathLike | str, client, attempts: int = 10,
          progress: Progress = show_progress) -> list[dict]:
    """What each of the commands, as ["analyze", "tessar", "--f-number", "8"], says as JSON, in their order.

    The answers stay in the folder, named by the program's version, the commands, and the bytes of the files that they
    name (not of those that these refer to): who calls again has what is there at once.
    """
    folder = pathlib.Path(folder).resolve()
    version = subprocess.run([program(), "--version"], capture_output=True, text=True, check=True).stdout
    tasks = []
    for command in commands:
        files = [pathlib.Path(word) for word in command]
        name = _digest(version, list(command), [file.read_bytes().hex() for file in files if file.is_file()])
        result = folder / f"{command[0]}-{name}.json"
        tasks.append(Task((*_one_thread(command), "--json", str(result), "--quiet"), result))
    run(tasks, client, attempts, progress)
    return [json.loads(task.result.read_text()) for task in tasks]


def _shards_for(command: Sequence[str], workers: int) -> int:
    """Of an experiment's steps that are known beforehand and not done yet, so many that each has seconds of work: what
    starting a process and a worker's death cost is then little, and none is long to wait for at the end."""
    told = subprocess.run([program(), *command, "--dry-run", "--json", "-", "--quiet"], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)
    if told.returncode:
        raise TaskFailed(f"lensproof {' '.join(command)}: {told.stderr.strip()}", told.returncode)
    plan = json.loads(told.stdout)
    waiting = plan["steps"] - plan["kept"]
    return min(waiting, max(2 * workers, math.ceil(plan["seconds"] / SECONDS_OF_A_SHARD)))


def experiment_task(file: os.PathLike | str, folder: os.PathLike | str, shards: int,
                    options: Sequence[str] = ()) -> Task:
    """An experiment's report in the folder, as a task that comes after those that do its steps, which the folder keeps.

    What a task that is killed had finished of its steps is not done again, and a step that two come to do is the same of
    both. The task's result is a file beside the folder, of a new name: an earlier report may be of another file or
    program; what is the same in it, its steps know.
    """
    folder = pathlib.Path(folder).resolve()
    command = ("run", str(pathlib.Path(file).resolve()), "-o", str(folder), "--quiet")
    done = folder.with_name(f".{folder.name}-{uuid.uuid4().hex}")

    def share(number: int) -> Task:
        result = done.with_name(f"{done.name}-{number}.json")
        return Task((*command, *_one_thread(options), "--shard", f"{number}/{shards}", "--json", str(result)), result)

    shares = tuple(share(number) for number in range(1, shards + 1)) if shards > 1 else ()
    result = done.with_name(f"{done.name}.json")
    return Task((*command, *options, "--json", str(result)), result, after=shares, consumes=True)


def experiments(files: Sequence[os.PathLike | str], folder: os.PathLike | str, client, attempts: int = 10,
                progress: Progress = show_progress, options: Sequence[str] = (),
                shards: int | None = None) -> list[pathlib.Path]:
    """Runs experiments, each into a folder of its name, and returns the folders.

    `options`: of `lensproof run`, as ["--quality", "draft"]. The steps of an experiment that its studies know beforehand,
    such as each value of a sweep or each pass of a scene, are shared out; the last task finds them kept, does the others
    and writes the report. `shards`: of each, in place of as many as suit. A call that was ended goes on from the steps. A
    report whose checks do not hold is a report.
    """
    folder = pathlib.Path(folder).resolve()
    places = [folder / pathlib.Path(file).stem for file in files]
    goals = []
    for file, place in zip(files, places):
        many = shards or _shards_for(["run", str(file), "-o", str(place), *options], len(client.nthreads()))
        goals.append(experiment_task(file, place, many, options))
    try:
        run(goals, client, attempts, progress)
    finally:
        for goal in goals:
            for task in (goal, *goal.after):
                task.result.unlink(missing_ok=True)
    return places


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line `python3 -m lensproof.cluster`."""
    parser = argparse.ArgumentParser(prog="python3 -m lensproof.cluster", description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser("render", help="render a scene in shards")
    command.add_argument("scene")
    command.add_argument("-o", "--output", required=True, help="EXR to write; a PNG appears beside it")
    command.add_argument("--shards", type=int, required=True)
    command = commands.add_parser("experiments", help="run experiments, each into a folder of its name")
    command.add_argument("files", nargs="+")
    command.add_argument("-o", "--output", required=True, help="folder to write")
    command.add_argument("--shards", type=int, help="of each experiment's steps (default: as many as suit)")
    for command in commands.choices.values():
        command.add_argument("--scheduler", help="its address (default: workers on this machine, a process a core)")
        command.add_argument("--attempts", type=int, default=10, help="of a task at most (default: 10)")
    known, others = parser.parse_known_args(arguments)
    if known.command != "render" and others:
        parser.error(f"unknown: {' '.join(others)}")

    from distributed import Client

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with contextlib.ExitStack() as stack:
            client = stack.enter_context(Client(known.scheduler or stack.enter_context(local_cluster())))
            if known.command == "render":
                render(known.scene, known.output, client, known.shards, others, known.attempts)
            else:
                experiments(known.files, known.output, client, known.attempts, shards=known.shards)
    except KeyboardInterrupt:
        print("ended early; the same command goes on from there", file=sys.stderr)
        return 3
    except TaskFailed as error:
        print(error, file=sys.stderr)
        return UNUSABLE_INPUT if error.status == UNUSABLE_INPUT else 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
