#!/usr/bin/env python3
"""slurm_test.py PROGRAM SOURCE — a render on a real Slurm whose tasks are killed, preempted, out of time.

Starts Debian's munged, slurmctld and slurmd (packages slurmctld, slurmd, slurm-client, munge) in a folder of their own:
one node, this machine. Does there what experiments/many_machines.md shows, kills one task in ten, and renders by the
workers that dask-jobqueue starts where that is installed. Each picture has the bytes of the same shards done one after
the other.
Exits with 77, which counts as skipped, where Slurm is not installed, and unless LENSPROOF_ALL_TRIALS is set: it takes
minutes.
"""
import datetime
import importlib.util
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

sys.dont_write_bytecode = True
PROGRAM, SOURCE = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
SHARDS = 64  # as on the page
TOOLS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "sinfo"]
os.environ["PATH"] += ":/usr/sbin:/sbin"
if "LENSPROOF_ALL_TRIALS" not in os.environ:
    print("takes minutes; LENSPROOF_ALL_TRIALS=1 asks for it")
    sys.exit(77)
if missing := [tool for tool in TOOLS if not shutil.which(tool)]:
    print(f"{missing[0]} is not installed here")
    sys.exit(77)
PACKAGE = str(SOURCE / "experiments/python/lensproof")
os.environ.update(LENSPROOF_PROGRAM=str(PROGRAM), LENSPROOF_CACHE="off", LENSPROOF_HOME=str(SOURCE), PYTHONPATH=PACKAGE)
sys.path.insert(0, PACKAGE)
import cluster  # noqa: E402
from common import Killer, settings, snippets  # noqa: E402

CONFIGURATION = """
ClusterName=lensproof
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
ReturnToService=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=8000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def output(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def wait_for(what, seconds=300):
    deadline = time.monotonic() + seconds
    while not (found := what()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"{what.__name__}: not within {seconds} s")
        time.sleep(0.2)
    return found


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="lensproof-slurm-"))
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        for name in ("state", "spool", "tools"):
            (folder / name).mkdir()
        folder.chmod(0o755)  # munged wants to be found
        (folder / "tools/lensproof").symlink_to(PROGRAM)
        (folder / "experiments").symlink_to(SOURCE / "experiments")
        (folder / "munge.key").write_bytes(os.urandom(1024))
        (folder / "munge.key").chmod(0o600)
        os.environ.update(SLURM_CONF=str(folder / "slurm.conf"), PATH=f"{folder}/tools:{os.environ['PATH']}")
        (folder / "slurm.conf").write_text(CONFIGURATION.format(
            folder=folder, host=socket.gethostname(), ports=free_ports(2), user=output("id", "-un").strip(),
            cores=os.cpu_count()))
        places = [f"--{name}-file={folder}/munge.{name}" for name in ("key", "pid", "seed", "log")]
        for daemon in (["munged", "--force", "--foreground", f"--socket={folder}/munge.socket", *places],
                       ["slurmctld", "-D"], ["slurmd", "-D"]):
            running = subprocess.Popen(daemon, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            cls.addClassCleanup(running.wait)
            cls.addClassCleanup(running.terminate)
            if daemon[0] == "munged":
                wait_for((folder / "munge.socket").exists)
        wait_for(lambda: subprocess.run(["sinfo", "-h", "-o", "%t"], capture_output=True, text=True).stdout == "idle\n")
        text = (SOURCE / "experiments/scenes/tessar_checkerboard.toml").read_text()
        cls.scene = folder / "scene.toml"
        cls.scene.write_text(text.replace("pixels = [720, 540]", "pixels = [240, 180]"))
        cls.options = ["--spp", "4096", "--threads", "1"]

    def merged(self, parts):
        """The bytes of the picture that is made of them all at once."""
        output(PROGRAM, "merge", *parts, "-o", "unbroken.exr", "--quiet")
        return (self.folder / "unbroken.exr").read_bytes()

    def parts(self):
        """The same shards, done here and one after the other."""
        for number in range(1, SHARDS + 1):
            part = self.folder / f"unbroken-{number}.exr"
            if not part.exists():
                output(PROGRAM, "render", self.scene, *self.options, "--shard", f"{number}/{SHARDS}", "-o", part, "--quiet")
            yield part

    def setUp(self):
        os.chdir(self.folder)

    def shown(self, words, more=""):
        """Does what the page shows with these words, with more options of its render."""
        script = next(snippet for snippet in snippets(SOURCE) if "sbatch" in snippet and words in snippet)
        output("bash", "-euc", script.replace("--spp 4096", f"--spp 4096 {more}"))

    def rendering(self):
        """The array's processes that render: their ids."""
        found = subprocess.run(["pgrep", "-f", "^lensproof render.*--shard"], capture_output=True, text=True)
        return [int(process) for process in found.stdout.split() if self.is_here(process)]

    def is_here(self, process):
        try:
            return os.readlink(f"/proc/{process}/cwd") == str(self.folder)
        except OSError:
            return False  # it has ended

    def hurry(self):
        """Who is queued again waits two minutes, for all that is left of it to end. Here that takes no four seconds."""
        for line in output("squeue", "-h", "-t", "PD", "-o", "%A %S %r").splitlines():
            job, start, reason = line.split(maxsplit=2)
            if reason != "BeginTime" or start == "N/A":
                continue
            if datetime.datetime.fromisoformat(start).timestamp() > time.time() + 10:
                subprocess.run(["scontrol", "update", f"JobId={job}", "StartTime=now+4"], capture_output=True)

    def test_an_array_has_the_same_bytes_whoever_dies(self):
        self.shown("render_array.sbatch", "--checkpoint-interval 0.1")
        chance = random.Random(1)
        ends = ["kill"] * max(1, SHARDS // 10) + ["walltime", "preemption"]
        deadline = time.monotonic() + 900
        while output("squeue", "-h").strip():
            self.assertLess(time.monotonic(), deadline, output("squeue"))
            if ends and (rendering := self.rendering()):
                victim = chance.choice(rendering)
                try:
                    if ends[-1] == "kill":
                        os.kill(victim, signal.SIGKILL)
                    elif ends[-1] == "walltime":  # what --signal=B:TERM@120 does
                        os.kill(int(output("ps", "-o", "ppid=", victim)), signal.SIGTERM)
                    else:  # as someone of a higher priority does
                        environment = pathlib.Path(f"/proc/{victim}/environ").read_text()
                        output("scontrol", "requeue", re.search(r"SLURM_JOB_ID=(\d+)", environment)[1])
                    ends.pop()
                except (OSError, subprocess.CalledProcessError):
                    pass  # it was done
            self.hurry()
            time.sleep(0.1)
        self.assertEqual(ends, [])
        self.assertEqual((self.folder / "picture.exr").read_bytes(), self.merged(self.parts()))
        self.assertEqual(list(self.folder.glob("*.checkpoint*")), [])
        self.assertEqual(len(list(self.folder.glob("picture.part-*.exr"))), SHARDS)

    def test_a_sweep_is_shared_out_and_its_report_has_the_same_bytes_whoever_dies(self):
        (self.folder / "sweep.toml").write_text(settings(10))
        self.shown("--dependency=afterany")
        tasks = [job for job in output("squeue", "-h", "-r", "-o", "%i").split() if "_" in job]
        output("scancel", tasks[6])  # the report's run does what is not done
        wait_for(lambda: not output("squeue", "-h").strip())
        output(PROGRAM, "run", "sweep.toml", "-o", "alone", "--quiet")
        for name in ("report.json", "report.html"):
            self.assertEqual((self.folder / "output/sweep" / name).read_bytes(),
                             (self.folder / "alone" / name).read_bytes())

    @unittest.skipUnless(importlib.util.find_spec("dask_jobqueue"), "dask-jobqueue (PyPI's) is not here")
    def test_dask_has_its_workers_from_slurm(self):
        import dask_jobqueue
        import distributed

        def cancel(client, worker):
            job = client.run(os.getenv, "SLURM_JOB_ID", workers=[worker])[worker]
            subprocess.run(["scancel", job], check=True)

        with dask_jobqueue.SLURMCluster(cores=1, memory="1GB", walltime="00:10:00", python=sys.executable,
                                        log_directory=str(self.folder), local_directory=str(self.folder)) as workers:
            workers.adapt(minimum=2, maximum=2)
            with distributed.Client(workers) as client:
                killer = Killer(client, SHARDS, cancel)
                picture = cluster.render(self.scene, self.folder / "dask.exr", client, SHARDS, self.options, progress=killer)
        self.assertGreater(killer.killed, 0)
        unbroken = cluster.render_task(self.scene, self.folder / "unbroken", SHARDS, self.options)
        (self.folder / "unbroken").mkdir()
        for number, part in enumerate(self.parts(), 1):
            part.rename(self.folder / f"unbroken/part-{number}.exr")
        for task in cluster.needed([unbroken]):
            cluster.perform(task)
        self.assertEqual(picture.read_bytes(), unbroken.result.read_bytes())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
