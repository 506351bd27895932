"""What the tests of many machines share: work, and what befalls its workers."""
import os
import random
import re
import signal
import threading


ALL_TRIALS = "LENSPROOF_ALL_TRIALS" in os.environ  # sizes that studies have; every day's are smaller


def snippets(source):
    """What experiments/many_machines.md shows between its fences."""
    return re.findall(r"```\n(.*?)```", (source / "experiments/many_machines.md").read_text(), re.DOTALL)


def kill_process(client, worker):
    os.kill(client.run(os.getpid, workers=[worker])[worker], signal.SIGKILL)


def settings(side):
    """An experiment: a lens at `side` times as many settings."""
    return f"""
title = "Settings"
[[sweeps]]
name = "settings"
lens = "tessar"
f_number = {{ from = 2.8, to = 16.0, count = {side}, spacing = "logarithmic" }}
focus_distance_mm = {{ from = 1000.0, to = 10000.0, count = {side} }}
field_deg = 10.0
measure = ["spot_rms_um", "chief_ray_height_mm"]
"""


class Killer:
    """Ends a worker under every tenth task, at random, as `tasks` are done."""

    def __init__(self, client, tasks, end=kill_process):
        self.client, self.end = client, end
        self.at = set(random.Random(1).sample(range(tasks), max(1, tasks // 10)))
        self.killed = 0

    def __call__(self, done, total, seconds_left):
        if done in self.at:
            self.at.remove(done)
            threading.Timer(0.05, self.kill).start()

    def kill(self):
        busy = [worker for worker, keys in self.client.processing().items() if keys]
        for worker in busy[:1]:
            self.end(self.client, worker)
            self.killed += 1
