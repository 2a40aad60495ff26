# SPDX-License-Identifier: Apache-2.0
"""The runs for each section of docs/benchmarks.md."""

from .figures import Series, filter_seconds, ratio, text

NAMES = ("coarse", "threads", "refined", "growth", "budget", "peers")
# Numbers of vertices of CGAL Mesh_3's meshes in docs/results.md ("Beside CGAL Mesh_3").
BUDGETS = {"head_igea_sdf@0": (2235, 4436, 5817), "dragon_sdf@0": (12272, 23050, 29323)}
UNREACHABLE_VOXELS = "0.01"
PEERS = ("mesh_3", "quadric", "meshoptimizer")
PEER_SURFACES = ("head_igea_sdf@0", "dragon_sdf@0")


def command(build, surface, limits, *options):
    return [
        build.binary,
        surface.path(),
        surface.isovalue,
        "--time-limit",
        limits.seconds,
        *options,
    ]


def show_progress(case, records, first, second):
    """Print the medians of `first` and `second`, each a (build, variant), and their ratios."""
    a, b = (
        Series([r for r in records if (r["build"], r["variant"]) == key]) for key in (first, second)
    )
    clocks = [
        f"{name} {text(x)} -> {text(y)} s ({text(ratio(y, x))})"
        for name, x, y in (
            ("CPU", a.seconds("cpu_s"), b.seconds("cpu_s")),
            ("wall", a.seconds("wall_s"), b.seconds("wall_s")),
        )
    ]
    memory = f"B per c-vertex {text(a.bytes_per_c_vertex())} -> {text(b.bytes_per_c_vertex())}"
    cubes = filter_seconds([a, b], "marching_cubes")
    over = ""
    if cubes:
        ratios = [text(ratio(s.seconds("cpu_s"), cubes)) for s in (a, b)]
        over = f"over marching cubes {ratios[0]} -> {ratios[1]}"
    problems = "; ".join(
        f"{key[0]} {s.problem()}" for key, s in ((first, a), (second, b)) if s.problem()
    )
    print(f"{case}: " + ", ".join(x for x in (*clocks, memory, over, problems) if x), flush=True)


def measure_surfaces(section, session, builds, catalogue, names, variants):
    """Measure isosurfaces. `variants`: options of bench_extract by name."""
    for name in names:
        surface = catalogue.by_name[name]
        runs = [
            (build, variant, command(build, surface, session.limits, *options))
            for variant, options in variants.items()
            for build in builds
        ]
        records = session.measure(section, name, runs)
        for variant in variants:
            show_progress(
                f"{name} [{variant}]" if len(variants) > 1 else name,
                records,
                (builds[0].letter, variant),
                (builds[-1].letter, variant),
            )


def bound_for_vertices(session, build, surface, wanted):
    """Search the bound on the distance that gives `wanted` vertices without a budget.

    Returns (bound in voxels, vertices) of the first run within 2 %, or of the closest of ten runs.
    """
    low, high, best = 0.02, 8.0, None  # vertices fall as the bound grows
    for _ in range(10):
        middle = (low * high) ** 0.5
        search = command(build, surface, session.limits, "--refine", middle, "--no-vtk")
        case = f"{surface.name} {wanted} {build.letter} {middle}"
        runs = [(build, "bound", search)]
        records = session.measure("budget-search", case, runs, repeats=1)
        vertices = Series(records[:1]).level("vertices")
        if vertices is None or vertices > wanted:  # a run over the time limit was too fine
            low = middle
        else:
            high = middle
        if vertices is not None and (
            best is None or abs(vertices - wanted) < abs(best[1] - wanted)
        ):
            best = (middle, vertices)
        if best and abs(best[1] - wanted) <= 0.02 * wanted:
            break
    return best


def measure_budget(session, builds, catalogue, names):
    for name in names:
        surface = catalogue.by_name[name]
        for wanted in BUDGETS[name]:
            runs = []
            for build in builds:
                run = [build, surface, session.limits, "--no-vtk", "--refine"]
                found = bound_for_vertices(session, build, surface, wanted)
                if found:
                    runs.append((build, f"bound:{found[0]:.4g}", command(*run, found[0])))
                budget = command(*run, UNREACHABLE_VOXELS, "--max-vertices", wanted)
                runs.append((build, "budget", budget))
            records = session.measure("budget", f"{name} {wanted}", runs, vertices=wanted)
            show_progress(
                f"{name}, {wanted:,} vertices",
                records,
                (builds[0].letter, "budget"),
                (builds[-1].letter, "budget"),
            )


def measure_peers(session, build, catalogue, names):
    for name in names:
        surface = catalogue.by_name[name]
        for peer in PEERS:
            command_line = [
                build.peers / f"peer_{peer}",
                surface.path(),
                surface.isovalue,
                "--repeats",
                session.limits.repeats,
            ]
            (record,) = session.measure(
                "peers", f"{name} {peer}", [(build, peer, command_line)], repeats=1
            )
            print(f"{name} {peer}: {record.get('result') or record.get('message')}", flush=True)


def measure(section, session, builds, catalogue, patterns):
    """Measure a section, on the isosurfaces that match a pattern or on its default ones."""
    real = catalogue.select(catalogue.standard, patterns)
    if section == "coarse":
        measure_surfaces(section, session, builds, catalogue, real, {"1": ["--threads", 1]})
    elif section == "threads":
        measure_surfaces(
            section,
            session,
            builds,
            catalogue,
            real,
            {"1": ["--threads", 1], "2": ["--threads", 2]},
        )
    elif section == "refined":
        measure_surfaces(
            section,
            session,
            builds,
            catalogue,
            real,
            {"1": ["--threads", 1, "--refine", "0.5", "--by-default"]},
        )
    elif section == "growth":
        names = catalogue.select(catalogue.growth, patterns, catalogue.growth)
        measure_surfaces(
            section, session, builds, catalogue, names, {"1": ["--threads", 1, "--no-vtk"]}
        )
    elif section == "budget":
        measure_budget(
            session, builds, catalogue, catalogue.select(list(BUDGETS), patterns, list(BUDGETS))
        )
    elif section == "peers":
        measure_peers(
            session,
            builds[-1],
            catalogue,
            catalogue.select(list(PEER_SURFACES), patterns, list(PEER_SURFACES)),
        )
