# SPDX-License-Identifier: Apache-2.0
"""Runs programs in turns with limits of time and memory, and stores each run as a JSON line."""

import datetime
import json
import os
import resource
import subprocess
import time

# A program that does not stop at its limit is killed after limit * KILL_FACTOR + KILL_SECONDS.
KILL_FACTOR, KILL_SECONDS = 2, 300


class Limits:
    def __init__(self, repeats, seconds, enough_seconds, memory_gib):
        self.repeats, self.seconds = repeats, seconds
        self.enough_seconds, self.memory_gib = enough_seconds, memory_gib


def run_once(command, limits):
    """Run a program. Returns a dict; its "outcome" is "finished", "over_limit" or "failed"."""
    memory = int(limits.memory_gib * 2**30)
    load, before = os.getloadavg()[0], resource.getrusage(resource.RUSAGE_CHILDREN)
    out = {"load": load, "limit_s": limits.seconds}
    try:
        done = subprocess.run(
            [str(c) for c in command],
            capture_output=True,
            text=True,
            timeout=KILL_FACTOR * limits.seconds + KILL_SECONDS,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (memory, memory)),
        )
    except subprocess.TimeoutExpired:
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return out | {
            "outcome": "over_limit",
            "result": {
                "cancelled_after": {"cpu_s": min(limits.seconds, cpu), "wall_s": limits.seconds}
            },
        }
    if done.returncode != 0:
        signal = (
            f"killed by signal {-done.returncode}"
            if done.returncode < 0
            else f"status {done.returncode}"
        )
        message = done.stderr.strip().splitlines()[-1] if done.stderr.strip() else signal
        return out | {
            "outcome": "failed",
            "message": message,
            "memory_limit_gib": limits.memory_gib,
        }
    result = json.loads(done.stdout)
    return out | {
        "outcome": "over_limit" if result.get("cancelled_after") else "finished",
        "result": result,
    }


class Store:
    """The stored runs: one file of JSON lines per section.

    A session is one call of bench/compare.py. Its runs of a case replace those of older sessions.
    """

    def __init__(self, folder):
        self.folder = folder

    def path(self, section):
        return self.folder / f"{section}.jsonl"

    def append(self, section, record):
        self.folder.mkdir(parents=True, exist_ok=True)
        with open(self.path(section), "a") as file:
            file.write(json.dumps(record) + "\n")

    def latest(self, section):
        """Per case, in the order of measurement, the records of the last session that has it."""
        cases = {}
        if self.path(section).exists():
            with open(self.path(section)) as file:
                for line in file:
                    record = json.loads(line)
                    old = cases.get(record["case"])
                    if old is None or old[0]["session"] != record["session"]:
                        cases[record["case"]] = []
                    cases[record["case"]].append(record)
        return cases


class Session:
    def __init__(self, store, limits, machine):
        self.store, self.limits, self.machine = store, limits, machine
        self.name = datetime.datetime.now().isoformat(timespec="seconds")

    def measure(self, section, case, runs, repeats=None, **facts):
        """Run each (build, variant, command) of `runs` in turns, up to `repeats` times.

        The default of `repeats` is that of the limits. A run that fails or takes too long is not
        repeated. Returns the records, which are also stored.
        """
        records, stopped, began = [], set(), time.monotonic()
        for repeat in range(repeats or self.limits.repeats):
            if repeat > 0 and time.monotonic() - began > self.limits.enough_seconds:
                break
            for build, variant, command in runs:
                if (build.letter, variant) in stopped:
                    continue
                record = {
                    "section": section,
                    "case": case,
                    "session": self.name,
                    "machine": self.machine,
                    "build": build.letter,
                    "variant": variant,
                    "source": build.source(),
                    "repeat": repeat,
                    **facts,
                    **run_once(command, self.limits),
                }
                if record["outcome"] != "finished":
                    stopped.add((build.letter, variant))
                self.store.append(section, record)
                records.append(record)
        return records
