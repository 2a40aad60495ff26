# SPDX-License-Identifier: Apache-2.0
"""Writes docs/benchmarks.md from the stored runs."""

import math

from . import plots
from .figures import Figure, Series, filter_seconds, number, ratio, text

HEAD = """# Benchmarks

Written by `bench/compare.py`; do not edit by hand. The page compares two builds of isoatlas, A (an
earlier commit) and B, with each other and with `vtkMarchingCubes` and `vtkFlyingEdges3D`. To
measure again:

    scripts/install_dependencies.sh bench
    # A: COMMIT, B: the working tree; all sections except peers
    /usr/bin/python3 bench/compare.py --base COMMIT
    # Two sections, some isosurfaces
    /usr/bin/python3 bench/compare.py --base COMMIT coarse refined --only head_igea ct_engine@180.5
    # CGAL Mesh_3 and decimation, see bench/peers/README.md
    /usr/bin/python3 bench/compare.py --base COMMIT peers
    # Two bench_extract programs
    /usr/bin/python3 bench/compare.py --a PROGRAM --b PROGRAM coarse
    # Only this page, from the runs in build/bench-results
    /usr/bin/python3 bench/compare.py --write-only

Sections: `coarse`, `threads`, `refined`, `growth`, `budget`, `peers`. `--help` lists the options
for time limit, memory limit and number of repeats. Measuring some isosurfaces replaces only their
rows. `bench/instructions.py` is a second check without a clock: it compares the [instruction
counts](../CONTRIBUTING.md) of three small volumes. `bench/large.py` measures [volumes in
blocks](scale.md#what-blocks-cost).

## What is measured

- **Builds.** Both are Release builds by the same compiler with the same `bench_extract.cpp`, that
  of the working tree. Their runs alternate: A B A B. Each run is a process.
- **Times** are from the volume in memory to the checked levels in memory. CPU time is that of all
  threads. Each figure is the median of the runs of one build; a ratio is that of two medians.
- **VTK's filters** use one thread, run in the same processes on the same samples, and compute no
  normals, gradients or scalars. Their median is over the runs of both builds.
- **Memory** is the peak of the resident set during the extraction minus the resident set just
  before it. It does not include the volume and the libraries.
- **Self-intersections** are pairs of triangles of all levels, counted again on the finished meshes.
  Below 1/3: the share of triangles of the finest level whose shortest edge is less than a third of
  the longest. Distance: the largest distance of the finest level that `max-distance` reports, in
  smallest spacings.
- **A run over its time limit** is cancelled. It gives a lower bound, marked ">", and is not
  repeated. No run is left out.
- **Isosurfaces** are named volume@isovalue: those of `TOPOLOGY.tsv` of the development data;
  `clinical_ct_F`, made by `make_bigct.py` with factor F (2: 512 x 512 x 332); `noise_N`, white
  noise of N^3 samples.
"""

# Upper limits of issue 14 for the CPU time of B over that of marching cubes; 10 if not listed.
OVER_MARCHING_CUBES = {
    "head_igea_sdf@0": 1,
    "dragon_sdf@0": 1,
    "neuron_dendrite@127.5": 1,
    "ct_engine@80.5": 1,
    "ct_engine@180.5": 1,
    "brain_white_matter@127.5": 2,
    "flame_heptane@60.5": 2,
    "flame_heptane@120.5": 2,
    "ct_oblique@80.5": 2,
    "ct_oblique@200.5": 2,
    "clinical_ct_2@482": 4,
}
OVER_MARCHING_CUBES_TWO_THREADS = {"clinical_ct_2@482": 2.5}
# Upper limits for the refined level: CPU time of B over that of commit c379082, which the issue
# measured.
REFINED_OVER_BASE = {"head_igea_sdf@0": 0.3, "dragon_sdf@0": 0.26, "clinical_ct_2@482": 0.11}


def limit_cell(figure, limit):
    """A table cell with an upper limit, marked if the figure is known to violate it."""
    if limit is None:
        return "–"
    is_above = figure is not None and figure.value > limit and figure.bound != "<"
    return f"{'**no**, ' if is_above else ''}≤ {limit}"


def ratio_limit(name, threads=1):
    """The upper limit for the time of B over that of marching cubes, or None."""
    if name.startswith(("noise", "clinical_ct_1", "clinical_ct_4")):
        return None
    return (
        OVER_MARCHING_CUBES.get(name, 10)
        if threads == 1
        else OVER_MARCHING_CUBES_TWO_THREADS.get(name, 6)
    )


def table(columns, rows):
    """A Markdown table. Titles that start with "<" are aligned to the left."""
    titles = [c.removeprefix("<") for c in columns]
    lines = [titles, ["---" if c.startswith("<") else "---:" for c in columns], *rows]
    return "\n".join("| " + " | ".join(str(x) for x in line) + " |" for line in lines) + "\n"


def series(records, build, variant):
    return Series([r for r in records if (r["build"], r["variant"]) == (build, variant)])


def milliseconds(figure):
    return text(figure and figure.scaled(1e3))


def count(value):
    return "–" if value is None else f"{value:,}"


def percent(share):
    return "–" if share is None else "0" if share == 0 else f"{100 * share:.3f} %"


def mebibytes(figure):
    return text(figure and figure.scaled(2**-20))


def runs_text(*all_series):
    counts = sorted({len(s.results) for s in all_series})
    return str(counts[0]) if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"


def both(a, b, show=text):
    """Three cells: the figures of A and B and their ratio."""
    return [show(a), show(b), text(ratio(b, a))]


def spread(figures, what):
    """A sentence about the ratios of all rows."""
    known = [f.value for f in figures if f is not None and not f.bound]
    if len(known) < 2:
        return ""
    mean = math.exp(sum(map(math.log, known)) / len(known))
    bounds = sum(1 for f in figures if f is not None and f.bound)
    return (
        f"- {what}: geometric mean {number(mean)}, "
        f"from {number(min(known))} to {number(max(known))} in {len(known)} rows"
        + (f"; {bounds} more are only bounds" if bounds else "")
        + ".\n"
    )


def provenance(cases, runs=None):
    """Date, commits and machine of the measurements. `runs`: a sentence about their number."""
    groups = {}
    for name, records in cases.items():
        sources = {r["build"]: (r["source"]["name"], r["source"]["subject"]) for r in records}
        groups.setdefault(
            (records[0]["session"][:10], records[0]["machine"], tuple(sorted(sources.items()))), []
        ).append(name)
    repeats = [
        sum(1 for r in records if (r["build"], r["variant"]) == key)
        for records in cases.values()
        for key in {(r["build"], r["variant"]) for r in records}
    ]
    load = max(r["load"] for records in cases.values() for r in records)
    lines = []
    for (date, machine, sources), names in groups.items():
        builds = ", ".join(
            f"{letter} = `{name}` ({subject})" for letter, (name, subject) in sources
        )
        where = "" if len(groups) == 1 else f" {', '.join(names)}."
        lines.append(f"{'- ' if len(groups) > 1 else ''}{date}: {builds}. {machine}.{where}")
    if max(repeats) == 1:
        times = "once"
    elif min(repeats) == max(repeats):
        times = f"{max(repeats)} times"
    else:
        times = f"{min(repeats)} to {max(repeats)} times"
    runs = runs or f"Each build ran {times} per row."
    return "\n".join(lines) + f"\n\n{runs} The load of the machine was up to {load:.1f}.\n"


def problems(cases):
    """A list of the cases without figures; none is dropped silently."""
    lines = []
    for name, records in cases.items():
        for build, variant in dict.fromkeys((r["build"], r["variant"]) for r in records):
            s = series(records, build, variant)
            if s.problem():
                lines.append(
                    f"- {name}, {build}{'' if variant == '1' else f' ({variant})'}: {s.problem()}"
                )
    return "\nWithout figures:\n\n" + "\n".join(lines) + "\n" if lines else ""


def stage_table(rows, first, second, quotient):
    """Wall milliseconds per stage of two Series, and their ratio.

    rows: (name, Series, Series); quotient: "B / A" for second over first, else first over second.
    """
    names = list(dict.fromkeys(stage for _, a, b in rows for s in (a, b) for stage in s.stages()))
    order = ["surface", "components", "coarsen", "cover", "certify", "mesh", "check", "refine"]
    names.sort(key=lambda n: order.index(n) if n in order else len(order))
    lines = []
    for name, a, b in rows:
        x, y = a.stages(), b.stages()
        cells = []
        for stage in names:
            p, q = x.get(stage), y.get(stage)
            share = text(ratio(q, p) if quotient == "B / A" else ratio(p, q))
            cell = f"{milliseconds(p)} → {milliseconds(q)} ({share})"
            cells.append("–" if p is None and q is None else cell)
        lines.append([name, *cells])
    return f"Stages: wall milliseconds of {first} → {second} ({quotient}).\n\n" + table(
        ["<isosurface", *names], lines
    )


def mesh_table(rows, with_distance):
    lines = []
    for name, a, b in rows:
        triangles = [s.level("triangles") and Figure(s.level("triangles")) for s in (a, b)]
        line = [
            name,
            *both(*triangles, show=lambda f: text(f, lambda v: f"{v:,.0f}")),
            percent(a.level("share_below_third")),
            percent(b.level("share_below_third")),
            count(a.intersections()),
            count(b.intersections()),
        ]
        if with_distance:
            line += [
                text(s.level("max_distance_voxels") and Figure(s.level("max_distance_voxels")))
                for s in (a, b)
            ]
        line += [
            mebibytes(a.peak_bytes()),
            mebibytes(b.peak_bytes()),
            *both(a.bytes_per_c_vertex(), b.bytes_per_c_vertex()),
        ]
        lines.append(line)
    distance = ["distance A", "distance B"] if with_distance else []
    return table(
        [
            "<isosurface",
            "triangles A",
            "triangles B",
            "B / A",
            "below 1/3 A",
            "below 1/3 B",
            "self-intersections A",
            "self-intersections B",
            *distance,
            "peak MiB A",
            "peak MiB B",
            "bytes per c-vertex A",
            "bytes per c-vertex B",
            "B / A",
        ],
        lines,
    )


def surfaces_section(cases, images, title, what, file, with_distance):
    rows = [
        (name, series(records, "A", "1"), series(records, "B", "1"))
        for name, records in cases.items()
    ]
    lines, over = [], []
    for name, a, b in rows:
        cubes, edges = (filter_seconds([a, b], f) for f in ("marching_cubes", "flying_edges"))
        cpu = [s.seconds("cpu_s") for s in (a, b)]
        wall = [s.seconds("wall_s") for s in (a, b)]
        over.append([ratio(c, cubes) for c in cpu])
        line = [
            name,
            count(b.c_vertices() or a.c_vertices()),
            milliseconds(cubes),
            milliseconds(edges),
            *both(*cpu, show=milliseconds),
            *both(*wall, show=milliseconds),
            text(over[-1][0]),
            text(over[-1][1]),
        ]
        line.append(
            limit_cell(ratio(cpu[1], cpu[0]), REFINED_OVER_BASE.get(name))
            if with_distance
            else limit_cell(over[-1][1], ratio_limit(name))
        )
        line += [text(ratio(cpu[1], edges)), runs_text(a, b)]
        lines.append(line)
    names = [name for name, _, _ in rows]
    image = images / f"benchmarks_{file}.svg"
    b_over_a = [ratio(b.seconds("cpu_s"), a.seconds("cpu_s")) for _, a, b in rows]
    if with_distance:
        plots.dots(
            image,
            names,
            [("B / A", plots.COLOURS["B"], b_over_a)],
            "CPU time of B over A, to the refined level",
            limits=[REFINED_OVER_BASE.get(name) for name in names],
        )
    else:
        plots.dots(
            image,
            names,
            [(f"isoatlas {k}", plots.COLOURS[k], [o[i] for o in over]) for i, k in enumerate("AB")],
            "CPU time over vtkMarchingCubes",
            limits=[ratio_limit(name) for name in names],
        )
    wall_ratio = [ratio(b.seconds("wall_s"), a.seconds("wall_s")) for _, a, b in rows]
    bytes_ratio = [ratio(b.bytes_per_c_vertex(), a.bytes_per_c_vertex()) for _, a, b in rows]
    ratios = (
        spread(b_over_a, "CPU time of B over A")
        + spread(wall_ratio, "Wall time of B over A")
        + spread(bytes_ratio, "Memory of B over A")
    )
    limit = "limit of B / A" if with_distance else "limit of B / MC"
    columns = ["<isosurface", "c-vertices", "MC", "FE", "CPU A", "CPU B", "B / A"]
    columns += ["wall A", "wall B", "B / A", "A / MC", "B / MC", limit, "B / FE", "finished runs"]
    return f"""## {title}

{what}

{provenance(cases)}
![{title}: CPU time](images/{image.name})

CPU and wall milliseconds. MC, FE: CPU of vtkMarchingCubes and vtkFlyingEdges3D.

{table(columns, lines)}
{ratios}{problems(cases)}
{mesh_table(rows, with_distance)}
{stage_table(rows, "A", "B", "B / A")}"""


def coarse(cases, images):
    return surfaces_section(
        cases,
        images,
        "Coarse mesh, one thread",
        "From the samples to the coarse mesh without self-intersections, default options.",
        "coarse",
        False,
    )


def refined(cases, images):
    return surfaces_section(
        cases,
        images,
        "Refined to half a voxel, one thread",
        "The coarse mesh and the default level, within half a smallest spacing of the isosurface.\n"
        "A default bound is refined to, but not proved like a requested one. The limit of B / A\n"
        "applies to A = `c379082`.",
        "refined",
        True,
    )


def threads(cases, images):
    rows, lines, stages, speed = [], [], [], {"A": [], "B": []}
    for name, records in cases.items():
        one = {k: series(records, k, "1") for k in "AB"}
        two = {k: series(records, k, "2") for k in "AB"}
        cubes = filter_seconds([*one.values(), *two.values()], "marching_cubes", "wall_s")
        line = [name, milliseconds(cubes)]
        for k in "AB":
            x, y = one[k].seconds("wall_s"), two[k].seconds("wall_s")
            speed[k].append(ratio(x, y))
            line += [milliseconds(x), milliseconds(y), text(speed[k][-1])]
        over = ratio(two["B"].seconds("wall_s"), cubes)
        line += [
            text(ratio(two["B"].seconds("wall_s"), two["A"].seconds("wall_s"))),
            text(ratio(two["B"].seconds("cpu_s"), one["B"].seconds("cpu_s"))),
            text(over),
            limit_cell(over, ratio_limit(name, 2)),
            runs_text(*one.values(), *two.values()),
        ]
        lines.append(line)
        rows.append(name)
        stages.append((name, one["B"], two["B"]))
    image = images / "benchmarks_threads.svg"
    plots.dots(
        image,
        rows,
        [(k, plots.COLOURS[k], speed[k]) for k in "AB"],
        "wall time with one thread over that with two, coarse mesh",
    )
    columns = ["<isosurface", "MC"]
    for k in "AB":
        columns += [f"{k}, 1 thread", f"{k}, 2 threads", "speed-up"]
    columns += ["B / A, 2 threads", "more CPU", "B / MC, 2 threads", "limit of B / MC"]
    columns += ["finished runs"]
    return f"""## Coarse mesh, two threads

The same with one and with two threads, in turns. Times are wall milliseconds. Speed-up: time with
one thread over time with two. More CPU: CPU time of B with two threads over that with one. MC: wall
time of vtkMarchingCubes with one thread.

{provenance(cases)}
![Speed-up by a second thread](images/{image.name})

{table(columns, lines)}
{problems(cases)}
{stage_table(stages, "B with one thread", "with two", "speed-up")}"""


def growth(cases, images):
    lines, families = [], {}
    for name, records in cases.items():
        family = (
            "clinical CT"
            if name.startswith("clinical_ct")
            else "white noise" if name.startswith("noise") else name
        )
        a, b = series(records, "A", "1"), series(records, "B", "1")
        c_vertices = b.c_vertices() or a.c_vertices()
        cost = []
        for s in (a, b):
            seconds = s.seconds("cpu_s")
            cost.append(
                ratio(seconds, Figure(c_vertices)).scaled(1e6) if seconds and c_vertices else None
            )
        sizes = [s.bytes_per_c_vertex() for s in (a, b)]
        lines.append(
            [
                name,
                count(c_vertices),
                *both(*cost),
                *both(*sizes),
                *(milliseconds(s.seconds("cpu_s")) for s in (a, b)),
                runs_text(a, b),
            ]
        )
        for k, s in enumerate("AB"):
            families.setdefault((s, family), []).append((c_vertices, cost[k], sizes[k]))
    flat = []
    for (letter, family), points in families.items():
        for index, what in ((1, "CPU time"), (2, "memory")):
            large = [
                p[index].value
                for p in points
                if p[0] and p[0] >= 1e5 and p[index] is not None and not p[index].bound
            ]
            if len(large) > 1:
                growth_factor = number(max(large) / min(large))
                flat.append(
                    f"- {family}, {letter}, {what}: largest over smallest {growth_factor} "
                    f"({len(large)} sizes)"
                )
    image = images / "benchmarks_growth.svg"
    plots.growth(
        image,
        [
            (
                f"{letter}, {family}",
                plots.COLOURS[letter],
                "o-" if family == "clinical CT" else "s--",
                points,
            )
            for (letter, family), points in families.items()
        ],
    )
    columns = ["<isosurface", "c-vertices"]
    for unit in ("CPU µs per c-vertex", "bytes per c-vertex"):
        columns += [f"{unit} A", f"{unit} B", "B / A"]
    columns += ["CPU ms A", "CPU ms B", "finished runs"]
    return f"""## Growth

The cost of the coarse mesh per c-vertex, one thread. Targets: constant within 30 % from 10^5 to
10^7 c-vertices, and at most 250 bytes per c-vertex.

{provenance(cases)}
![Cost per c-vertex](images/{image.name})

{table(columns, lines)}
From 100,000 c-vertices on:

{chr(10).join(flat) or "- fewer than two sizes have figures"}
{problems(cases)}"""


def budget(cases, images):
    lines, ratios, names = [], {"A": [], "B": []}, []
    for name, records in cases.items():
        cells, times = [], {}
        for k in "AB":
            variant = next(
                (
                    r["variant"]
                    for r in records
                    if r["build"] == k and r["variant"].startswith("bound:")
                ),
                None,
            )
            bound = series(records, k, variant)
            limited = series(records, k, "budget")
            times[k] = limited.seconds("cpu_s")
            ratios[k].append(ratio(times[k], bound.seconds("cpu_s")))
            cells += [
                variant.removeprefix("bound:") if variant else "–",
                count(bound.level("vertices")),
                count(limited.level("vertices")),
                milliseconds(bound.seconds("cpu_s")),
                milliseconds(times[k]),
                text(ratios[k][-1]),
            ]
        surface, wanted = name.split(" ")
        names.append(f"{surface}, {int(wanted):,}")
        lines.append([surface, f"{int(wanted):,}", *cells, text(ratio(times["B"], times["A"]))])
    image = images / "benchmarks_budget.svg"
    plots.dots(
        image,
        names,
        [(k, plots.COLOURS[k], ratios[k]) for k in "AB"],
        "CPU time with a vertex budget over that with a bound on the distance",
        limits=[2] * len(names),
    )
    columns = [
        f"{k}: {c}"
        for k in "AB"
        for c in (
            "bound",
            "vertices",
            "vertices with budget",
            "CPU ms, bound",
            "CPU ms, budget",
            "ratio",
        )
    ]
    return f"""## Vertex budget

A run with `--max-vertices N --refine max-distance:0.01vx`, compared with a run without a budget.
The latter has a bound on the distance (in voxels, found by bisection) that gives N vertices within
2 %. N is the number of vertices of CGAL Mesh_3's meshes in [results](results.md). One thread.
Target: a ratio of at most 2.

{provenance(cases)}
![Time of a vertex budget](images/{image.name})

{table(["<isosurface", "N", *columns, "budget B / A"], lines)}
{problems(cases)}"""


def peers(cases, images):
    lines, unmeasured, repeats = [], [], set()
    for surface in dict.fromkeys(name.rsplit(" ", 1)[0] for name in cases):
        own = {
            name.rsplit(" ", 1)[1]: records[0]
            for name, records in cases.items()
            if name.rsplit(" ", 1)[0] == surface
        }
        for peer, record in own.items():
            if record["outcome"] != "finished":
                unmeasured.append(f"- {surface}, {peer}: {Series([record]).problem()}")
                continue
            result = record["result"]
            repeats.add(str(result["repeats"]))
            if not any(line[0] == surface and line[1] == "isoatlas" for line in lines):
                mine = result["isoatlas"]
                lines.append(
                    [
                        surface,
                        "isoatlas",
                        "–",
                        count(mine["triangles"]),
                        number(mine["distance_voxels"]),
                        percent(mine["share_below_third"]),
                        number(mine["cpu_s"]),
                        "",
                        count(mine["components"]),
                        count(mine["non_manifold_edges"]),
                    ]
                )
            theirs = result["peer"]
            reached = "" if result["reached"] else " (not reached)"
            lines.append(
                [
                    surface,
                    peer,
                    f"{result['parameter']} {number(theirs['parameter'])}",
                    count(theirs["triangles"]),
                    number(theirs["distance_voxels"]) + reached,
                    percent(theirs["share_below_third"]),
                    number(theirs["cpu_s"]),
                    number(result["isoatlas"]["cpu_s"] / theirs["cpu_s"]),
                    count(theirs["components"]),
                    count(theirs["non_manifold_edges"]),
                ]
            )
    columns = [
        "<isosurface",
        "<program",
        "<parameter",
        "triangles",
        "distance, voxels",
        "below 1/3",
    ]
    columns += ["CPU s", "isoatlas / peer", "components", "non-manifold edges"]
    runs = f"Times are medians of {' or '.join(sorted(repeats)) or 'no'} runs, in turns."
    missing = "\n".join(["Without figures:", "", *unmeasured, ""]) if unmeasured else ""
    return f"""## Peers at the same measured distance

isoatlas (build B, refined to half a voxel, default options) and other programs. These use the
coarsest parameter whose *measured* two-sided distance (`isoatlas::measure`, 200,000 samples in each
direction) is at most that of isoatlas; see `bench/peers/README.md`. CPU seconds are from the volume
in memory to the mesh, with one thread. The ratio is isoatlas over the peer in the same process.
"Not reached": even the finest mesh has a larger distance.

{provenance(cases, runs)}
{table(columns, lines)}
{missing}"""


SECTIONS = {
    "coarse": coarse,
    "threads": threads,
    "refined": refined,
    "growth": growth,
    "budget": budget,
    "peers": peers,
}


def in_order(cases, order):
    """The cases in the order of the catalogue."""
    rank = {name: i for i, name in enumerate(order)}
    return dict(sorted(cases.items(), key=lambda item: rank.get(item[0].split(" ")[0], len(rank))))


def write(out, store, order):
    images = out.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    parts = [HEAD]
    for name, section in SECTIONS.items():
        cases = in_order(store.latest(name), order)
        if cases:
            parts.append(section(cases, images))
    lines = "\n".join(parts).splitlines()
    kept = [
        line.rstrip()
        for i, line in enumerate(lines)
        if line.strip() or (i > 0 and lines[i - 1].strip())
    ]
    out.write_text("\n".join(kept).rstrip() + "\n")
    print(f"wrote {out}")
