#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares two builds of isoatlas with each other and with VTK's contour filters.

    scripts/install_dependencies.sh bench
    /usr/bin/python3 bench/compare.py --base COMMIT [SECTION ...] [--only NAME ...]

Writes docs/benchmarks.md, with plots in docs/images. A is the commit of --base, built in
build/compare from a git worktree with the current bench_extract.cpp. B is the working tree. Their
runs alternate. All runs are stored in build/bench-results, and the page is written from all stored
runs. Needs Debian's python3-numpy and python3-matplotlib; the clinical CT also needs python3-scipy
and python3-vtk9.
"""

import argparse
import os
import pathlib
import sys

from comparison import builds, measure, page, sections, volumes

ROOT = builds.ROOT


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "sections",
        nargs="*",
        metavar="SECTION",
        help=f"{', '.join(sections.NAMES)} (default: all except peers)",
    )
    parser.add_argument("--base", metavar="COMMIT", help="build A from this commit")
    parser.add_argument("--a", metavar="PROGRAM", help="A is this bench_extract program")
    parser.add_argument(
        "--b",
        metavar="PROGRAM",
        help="B is this bench_extract program (default: built from the working tree)",
    )
    parser.add_argument(
        "--a-name", default="a given program", help="name of the program of --a on the page"
    )
    parser.add_argument(
        "--b-name", default="a given program", help="name of the program of --b on the page"
    )
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="NAME",
        help="only isosurfaces whose name starts with, or matches, one of these; see --list",
    )
    parser.add_argument(
        "--list",
        action="store_true",
        help="list the names of all isosurfaces; a * marks those measured by default",
    )
    parser.add_argument(
        "--write-only",
        action="store_true",
        help="write the page from the stored runs, without measuring",
    )
    parser.add_argument(
        "--repeats", type=int, default=5, help="runs of each build (default: %(default)s)"
    )
    parser.add_argument(
        "--time-limit",
        type=float,
        default=300,
        metavar="SECONDS",
        help="cancel an extraction after this wall time (default: %(default)s)",
    )
    parser.add_argument(
        "--enough",
        type=float,
        default=600,
        metavar="SECONDS",
        help="start no further repeat of a row after this wall time (default: %(default)s)",
    )
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    parser.add_argument(
        "--memory-limit",
        type=float,
        default=round(0.9 * memory, 1),
        metavar="GIB",
        help="address space of a run (default: %(default)s)",
    )
    parser.add_argument(
        "--jobs",
        type=int,
        default=os.cpu_count(),
        help="parallel jobs of the builds (default: %(default)s)",
    )
    parser.add_argument(
        "--shared",
        type=pathlib.Path,
        default=ROOT.parent / "shared",
        help="folder with data/TOPOLOGY.tsv and tools/make_bigct.py",
    )
    parser.add_argument(
        "--results",
        type=pathlib.Path,
        default=ROOT / "build" / "bench-results",
        help="folder of the stored runs",
    )
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=ROOT / "docs" / "benchmarks.md",
        help="the page to write",
    )
    arguments = parser.parse_args()
    unknown = set(arguments.sections) - set(sections.NAMES)
    if unknown:
        parser.error(
            f"unknown section {', '.join(sorted(unknown))}; expected {', '.join(sections.NAMES)}"
        )
    if not (arguments.write_only or arguments.list) and (arguments.base is None) == (
        arguments.a is None
    ):
        parser.error("expected --base COMMIT or --a PROGRAM")
    if arguments.b and "peers" in arguments.sections:
        parser.error("section peers: B must be the working tree, remove --b")
    return arguments


def make_builds(arguments, with_peers):
    if arguments.a:
        a = builds.from_binary("A", arguments.a, arguments.a_name)
    else:
        a = builds.from_commit("A", arguments.base, arguments.jobs)
    b = (
        builds.from_binary("B", arguments.b, arguments.b_name)
        if arguments.b
        else builds.from_working_tree("B", arguments.jobs, with_peers)
    )
    return a, b


def main():
    arguments = parse_arguments()
    catalogue = volumes.Catalogue(arguments.shared, ROOT / "build" / "bench-data")
    if arguments.list:
        for name in catalogue.by_name:
            print(name + (" *" if name in catalogue.standard else ""))
        return 0
    store = measure.Store(arguments.results)
    if not arguments.write_only:
        names = arguments.sections or [name for name in sections.NAMES if name != "peers"]
        pair = make_builds(arguments, "peers" in names)
        session = measure.Session(
            store,
            measure.Limits(
                arguments.repeats, arguments.time_limit, arguments.enough, arguments.memory_limit
            ),
            builds.machine(),
        )
        for name in names:
            print(f"== {name}", flush=True)
            sections.measure(name, session, pair, catalogue, arguments.only)
    page.write(arguments.out, store, list(catalogue.by_name))
    return 0


if __name__ == "__main__":
    sys.exit(main())
