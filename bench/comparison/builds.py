# SPDX-License-Identifier: Apache-2.0
"""Builds bench_extract from a commit or from the working tree.

All builds use the same flags, and bench_extract.cpp of the working tree.
"""

import pathlib
import platform
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILDS = ROOT / "build" / "compare"
FLAGS = [
    "-G",
    "Ninja",
    "-DCMAKE_BUILD_TYPE=Release",
    "-DISOATLAS_BUILD_BENCH=ON",
    "-DISOATLAS_BUILD_TESTS=OFF",
    "-DISOATLAS_BUILD_PAGE=OFF",
    "-DISOATLAS_BUILD_TOOL=OFF",
]
# Files of the working tree that replace those of the commit.
OVERLAID = ("bench/bench_extract.cpp", "bench/vtk_image.h")
# Everything that a build depends on.
SOURCES = (
    "CMakeLists.txt",
    "cmake",
    "include",
    "src",
    "bench/CMakeLists.txt",
    "bench/peers",
    *OVERLAID,
)


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def git(*arguments):
    return run("git", "-C", ROOT, *arguments)


class Build:
    """One of the two compared builds: its programs, and its name and subject on the page."""

    def __init__(self, letter, binary, name, subject, peers=None):
        self.letter, self.binary, self.peers = letter, binary, peers
        self.name, self.subject = name, subject

    def source(self):
        return {"name": self.name, "subject": self.subject}


def compile_target(source, folder, targets, jobs, flags=()):
    run("cmake", "-S", source, "-B", folder, *FLAGS, *flags)
    print(f"building {', '.join(targets)}", flush=True)
    run("cmake", "--build", folder, f"-j{jobs}", "--target", *targets)
    return folder / "bin"


def from_commit(letter, commit, jobs):
    full = git("rev-parse", "--verify", commit + "^{commit}")
    short, subject = git("log", "-1", "--format=%h%n%s", full).split("\n")
    folder = BUILDS / full[:12]
    source = folder / "source"
    if not source.exists():
        git("worktree", "prune")
        git("worktree", "add", "--detach", "--quiet", source, full)
    for name in OVERLAID:
        ours, theirs = ROOT / name, source / name
        if not theirs.exists() or ours.read_bytes() != theirs.read_bytes():
            shutil.copyfile(ours, theirs)
    binaries = compile_target(source, folder / "build", ["bench_extract"], jobs)
    return Build(letter, binaries / "bench_extract", short, subject)


def from_working_tree(letter, jobs, with_peers):
    name, subject = git("log", "-1", "--format=%h%n%s").split("\n")
    if git("status", "--porcelain", "--", *SOURCES):
        name, subject = name + " and uncommitted changes", subject
    flags = [f"-DISOATLAS_BUILD_PEERS={'ON' if with_peers else 'OFF'}"]
    targets = ["bench_extract"] + (["peers"] if with_peers else [])
    binaries = compile_target(ROOT, BUILDS / "working-tree", targets, jobs, flags)
    return Build(
        letter, binaries / "bench_extract", name, subject, binaries if with_peers else None
    )


def from_binary(letter, path, name):
    return Build(letter, pathlib.Path(path).resolve(), name, "given as a program")


def machine():
    """The description of the machine on the page."""

    def first(path, start, default):
        try:
            with open(path) as file:
                return next(
                    (
                        line[len(start) :].strip(' \t:=\n"')
                        for line in file
                        if line.startswith(start)
                    ),
                    default,
                )
        except OSError:
            return default

    kilobytes = int(first("/proc/meminfo", "MemTotal", "0 kB").split()[0])
    compiler = subprocess.run(
        ["c++", "-dumpfullversion"], capture_output=True, text=True
    ).stdout.strip()
    processors = len([line for line in open("/proc/cpuinfo") if line.startswith("processor")])
    processor = first("/proc/cpuinfo", "model name", platform.processor())
    system = first("/etc/os-release", "PRETTY_NAME", platform.system())
    return (
        f"{processor}, {processors} processors, {kilobytes / 2**20:.0f} GiB, "
        f"{system}, g++ {compiler}"
    )
