#!/usr/bin/env python3
"""cluster_test.py PROGRAM SOURCE — renders and sweeps on workers that die.

A `LocalCluster` of two workers; one task in ten has its worker killed under it. The picture has the bytes that the same
shards have when nobody dies. With LENSPROOF_ALL_TRIALS=1 64 shards and a hundred settings, else fewer. Exits with 77,
which counts as skipped, where Dask's `distributed` is not installed.
"""
import contextlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import types
import unittest
import unittest.mock

try:
    import distributed
except ImportError:
    print("distributed is not installed here (Debian: python3-distributed)")
    sys.exit(77)

sys.dont_write_bytecode = True
PROGRAM, SOURCE = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
os.environ["LENSPROOF_PROGRAM"] = str(PROGRAM)
os.environ["LENSPROOF_CACHE"] = "off"
# The workers' processes import it too; the package around it needs what pip builds.
package = str(SOURCE / "experiments/python/lensproof")
sys.path.insert(0, package)
os.environ["PYTHONPATH"] = package
import cluster  # noqa: E402
from common import ALL_TRIALS, Killer, settings, snippets  # noqa: E402

SHARDS = 64 if ALL_TRIALS else 16
SIDE = 10 if ALL_TRIALS else 4

SCENE = """
[camera]
lens = "tessar"
f_number = 4.0
focus_distance_mm = 2000.0
sensor_mm = [72.0, 54.0]
pixels = [40, 30]
shutter_s = 0.01
iso = 100.0
response = "camera"
[light]
illuminant = "D65"
luminance_cd_m2 = 1000.0
[chart]
kind = "checkerboard"
squares = [12, 9]
square_mm = 110.0
[pose]
distance_mm = 2000.0
"""


class Cluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="lensproof-cluster-")))
        cls.local = cls.enterClassContext(cluster.local_cluster(
            n_workers=2, silence_logs=50, local_directory=str(cls.folder / "workers")))
        cls.client = cls.enterClassContext(distributed.Client(cls.local))
        (cls.folder / "scene.toml").write_text(SCENE)

    def test_pictures_have_the_same_bytes_whoever_dies(self):
        options = ["--spp", str(16 * SHARDS), "--threads", "1"]
        killer = Killer(self.client, SHARDS)
        picture = cluster.render(self.folder / "scene.toml", self.folder / "picture.exr", self.client, SHARDS, options,
                                 progress=killer)
        self.assertGreater(killer.killed, 0)
        unbroken = cluster.render_task(self.folder / "scene.toml", self.folder / "unbroken", SHARDS, options)
        for task in cluster.needed([unbroken]):
            cluster.perform(task)
        self.assertEqual(picture.read_bytes(), unbroken.result.read_bytes())
        self.assertEqual(picture.with_suffix(".png").read_bytes(), unbroken.result.with_suffix(".png").read_bytes())
        self.assertEqual(list(self.folder.glob("picture.parts-*")), [], "what the picture was made of is gone")

    def test_a_task_goes_on_from_the_checkpoint_of_one_that_was_killed(self):
        samples = 8192
        whole = cluster.render_task(self.folder / "scene.toml", self.folder / "killed", 1,
                                    ["--spp", str(samples), "--threads", "1", "--checkpoint-interval", "0.2"])
        part = whole.after[0]
        part.result.parent.mkdir()
        process = subprocess.Popen([PROGRAM, *part.arguments])
        while not part.checkpoint.exists() and process.poll() is None:
            time.sleep(0.01)
        process.kill()
        process.wait()
        self.assertFalse(part.is_done())
        arguments = (*part.arguments, "--json", str(self.folder / "went_on.json"))
        cluster.perform(cluster.Task(arguments, part.result, checkpoint=part.checkpoint))
        went_on = json.loads((self.folder / "went_on.json").read_text())["run"]
        self.assertLess(went_on["samples"], samples * 40 * 30)
        self.assertFalse(part.checkpoint.exists())

    def test_sweeps_answer_in_order_and_are_kept(self):
        killer = Killer(self.client, 20)
        f_numbers = [2.8 + 0.5 * step for step in range(20)]
        commands = [["analyze", "tessar", "--f-number", str(n), "--fields", "0"] for n in f_numbers]
        answers = cluster.sweep(commands, self.folder / "sweep", self.client, progress=killer)
        for f_number, answer in zip(f_numbers, answers):
            self.assertAlmostEqual(answer["paraxial"]["f_number"], f_number, places=9)
        done = []
        self.assertEqual(cluster.sweep(commands, self.folder / "sweep", self.client,
                                       progress=lambda *told: done.append(told)), answers)
        self.assertEqual(len(done), 1, "nothing is done again")

    def test_a_lens_that_changed_is_asked_again(self):
        lens = self.folder / "lens.toml"
        text = (SOURCE / "lenses/tessar.toml").read_text()
        answers = []
        thicker = re.sub(r"(thickness_mm\s*=\s*)([0-9.]+)", lambda gap: gap[1] + str(float(gap[2]) + 0.5), text, count=1)
        for content in (text, thicker):
            lens.write_text(content)
            answers += cluster.sweep([["analyze", str(lens), "--fields", "0"]], self.folder / "changed", self.client)
        self.assertNotEqual(answers[0]["paraxial"]["efl_mm"], answers[1]["paraxial"]["efl_mm"])

    def test_experiments_are_run_again_to_what_they_say_now(self):
        experiment = self.folder / "passage.toml"
        for f_number in ("8.0", "16.0"):
            experiment.write_text(f'title = "at {f_number}"\n[[pupil_passage]]\nlens = "tessar"\nf_number = {f_number}\n')
            place, = cluster.experiments([experiment], self.folder / "reports", self.client)
            self.assertEqual(json.loads((place / "report.json").read_text())["title"], f"at {f_number}")
        self.assertEqual([file.name for file in (self.folder / "reports").iterdir()], ["passage"])

    def test_a_sweep_is_shared_out_and_its_report_has_the_same_bytes_whoever_dies(self):
        experiment = self.folder / "settings.toml"
        experiment.write_text(settings(SIDE))
        killer = Killer(self.client, 10)
        place, = cluster.experiments([experiment], self.folder / "shared", self.client, progress=killer, shards=10)
        self.assertGreater(killer.killed, 0)
        told = json.loads(subprocess.run([PROGRAM, "run", experiment, "-o", place, "--dry-run", "--json", "-"],
                                         capture_output=True, check=True).stdout)
        self.assertEqual((told["steps"], told["kept"]), (SIDE * SIDE, SIDE * SIDE))
        alone = self.folder / "alone" / "settings"
        subprocess.run([PROGRAM, "run", experiment, "-o", alone, "--quiet"], check=True)
        for name in ("report.json", "report.html"):
            self.assertEqual((place / name).read_bytes(), (alone / name).read_bytes())
        self.assertEqual([file.name for file in (self.folder / "shared").iterdir()], ["settings"])

    def test_what_no_other_try_changes_ends_at_once(self):
        with self.assertRaises(cluster.TaskFailed) as failed:
            cluster.sweep([["analyze", "no-such-lens"]], self.folder / "wrong", self.client)
        self.assertEqual(failed.exception.status, cluster.UNUSABLE_INPUT)
        self.assertIn("no-such-lens", str(failed.exception))

    def test_a_slurm_array_goes_on_from_its_checkpoint(self):
        """The array's script as Slurm would start it, with a `scontrol` that only notes what it is asked."""
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "scontrol").write_text('#!/bin/sh\necho "$@" >> "$(dirname "$0")/asked"\n')
        (tools / "scontrol").chmod(0o755)
        (tools / "lensproof").symlink_to(PROGRAM)
        environment = os.environ | {
            "PATH": f"{tools}:{os.environ['PATH']}", "LENSPROOF_HOME": str(SOURCE), "SLURM_JOB_ID": "7",
            "SLURM_ARRAY_TASK_ID": "1", "SLURM_ARRAY_TASK_COUNT": "1"}
        command = ["bash", SOURCE / "experiments/render_array.sbatch", "scene.toml", "array.exr", "--spp", "8192",
                   "--threads", "1", "--checkpoint-interval", "0.2"]
        task = subprocess.Popen(command, cwd=self.folder, env=environment)
        checkpoint = self.folder / "array.part-1.checkpoint"
        while not checkpoint.exists() and task.poll() is None:
            time.sleep(0.01)
        task.terminate()
        self.assertEqual(task.wait(), 0)
        self.assertEqual((tools / "asked").read_text(), "requeue 7\n")
        self.assertTrue(checkpoint.exists())
        subprocess.run(command, cwd=self.folder, env=environment, check=True)
        self.assertTrue((self.folder / "array.part-1.exr").exists())
        self.assertEqual(list(self.folder.glob("array*.checkpoint*")), [])

    def test_what_the_page_shows(self):
        place = self.folder / "page"
        place.mkdir()
        (place / "scene.toml").write_text(SCENE)
        for name in ("one", "two"):
            (place / f"{name}.toml").write_text(settings(2))
        shown = next(snippet for snippet in snippets(SOURCE) if "import Client" in snippet)
        around = types.ModuleType("lensproof")
        around.cluster = cluster
        space = {}
        shown = shown.replace("tcp://scheduler:8786", self.local.scheduler_address).replace("shards=64", f"shards={SHARDS}")
        with contextlib.chdir(place), unittest.mock.patch.dict(sys.modules, lensproof=around):
            exec(shown, space)
        space["client"].close()
        self.assertEqual(sorted(file.name for file in place.iterdir()),
                         ["one.toml", "output", "picture.exr", "picture.png", "scene.toml", "sweep", "two.toml"])
        self.assertEqual([round(answer["paraxial"]["f_number"], 9) for answer in space["answers"]], [2.8, 4, 5.6, 8])
        self.assertEqual(sorted(file.name for file in (place / "output").iterdir()), ["one", "two"])

    def test_the_command_line(self):
        status = cluster.main(["render", str(self.folder / "scene.toml"), "-o", str(self.folder / "two.exr"), "--shards",
                               "2", "--spp", "32", "--scheduler", self.local.scheduler_address])
        self.assertEqual(status, 0)
        self.assertTrue((self.folder / "two.exr").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
