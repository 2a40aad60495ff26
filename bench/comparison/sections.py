# SPDX-License-Identifier: Apache-2.0
"""What is run for each section of docs/benchmarks.md."""
from .figures import Series, filter_seconds, ratio, text

NAMES = ("coarse", "threads", "refined", "growth", "budget", "peers")
# Vertices of CGAL Mesh_3's meshes in docs/results.md ("Beside CGAL Mesh_3").
BUDGETS = {"head_igea_sdf@0": (2235, 4436, 5817), "dragon_sdf@0": (12272, 23050, 29323)}
UNREACHABLE_VOXELS = "0.01"
PEERS = ("mesh_3", "quadric", "meshoptimizer")
PEER_SURFACES = ("head_igea_sdf@0", "dragon_sdf@0")


def command(build, surface, limits, *options):
    return [build.binary, surface.path(), surface.isovalue, "--time-limit", limits.seconds, *options]


def show_progress(case, records, first, second):
    """One line with the medians of `second` over `first`, each a (build, variant)."""
    a, b = (Series([r for r in records if (r["build"], r["variant"]) == key]) for key in (first, second))
    clocks = [f"{name} {text(x)} -> {text(y)} s ({text(ratio(y, x))})" for name, x, y in
              (("CPU", a.seconds("cpu_s"), b.seconds("cpu_s")), ("wall", a.seconds("wall_s"), b.seconds("wall_s")))]
    memory = f"B per c-vertex {text(a.bytes_per_c_vertex())} -> {text(b.bytes_per_c_vertex())}"
    cubes = filter_seconds([a, b], "marching_cubes")
    over = f"over marching cubes {text(ratio(a.seconds('cpu_s'), cubes))} -> {text(ratio(b.seconds('cpu_s'), cubes))}" if cubes else ""
    problems = "; ".join(f"{key[0]} {s.problem()}" for key, s in ((first, a), (second, b)) if s.problem())
    print(f"{case}: " + ", ".join(x for x in (*clocks, memory, over, problems) if x), flush=True)


def measure_surfaces(section, session, builds, catalogue, names, variants):
    """`variants`: name -> options of bench_extract."""
    for name in names:
        surface = catalogue.by_name[name]
        runs = [(build, variant, command(build, surface, session.limits, *options)) for variant, options in variants.items() for build in builds]
        records = session.measure(section, name, runs)
        for variant in variants:
            show_progress(f"{name} [{variant}]" if len(variants) > 1 else name, records, (builds[0].letter, variant), (builds[-1].letter, variant))


def bound_for_vertices(session, build, surface, wanted):
    """(bound in voxels, vertices) of the run without a budget that ends within 2 % of `wanted` vertices, or the closest one of ten runs."""
    low, high, best = 0.02, 8.0, None  # vertices fall as the bound grows
    for _ in range(10):
        middle = (low * high) ** 0.5
        records = session.measure("budget-search", f"{surface.name} {wanted} {build.letter} {middle}",
                                  [(build, "bound", command(build, surface, session.limits, "--refine", middle, "--no-vtk"))], repeats=1)
        vertices = Series(records[:1]).level("vertices")
        if vertices is None or vertices > wanted:  # a run over the time limit was too fine
            low = middle
        else:
            high = middle
        if vertices is not None and (best is None or abs(vertices - wanted) < abs(best[1] - wanted)):
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
                found = bound_for_vertices(session, build, surface, wanted)
                if found:
                    runs.append((build, f"bound:{found[0]:.4g}", command(build, surface, session.limits, "--refine", found[0], "--no-vtk")))
                runs.append((build, "budget", command(build, surface, session.limits, "--refine", UNREACHABLE_VOXELS, "--max-vertices", wanted, "--no-vtk")))
            records = session.measure("budget", f"{name} {wanted}", runs, vertices=wanted)
            show_progress(f"{name}, {wanted:,} vertices", records, (builds[0].letter, "budget"), (builds[-1].letter, "budget"))


def measure_peers(session, build, catalogue, names):
    for name in names:
        surface = catalogue.by_name[name]
        for peer in PEERS:
            command_line = [build.peers / f"peer_{peer}", surface.path(), surface.isovalue, "--repeats", session.limits.repeats]
            record, = session.measure("peers", f"{name} {peer}", [(build, peer, command_line)], repeats=1)
            print(f"{name} {peer}: {record.get('result') or record.get('message')}", flush=True)


def measure(section, session, builds, catalogue, patterns):
    real = catalogue.select(catalogue.standard, patterns)
    if section == "coarse":
        measure_surfaces(section, session, builds, catalogue, real, {"1": ["--threads", 1]})
    elif section == "threads":
        measure_surfaces(section, session, builds, catalogue, real, {"1": ["--threads", 1], "2": ["--threads", 2]})
    elif section == "refined":
        measure_surfaces(section, session, builds, catalogue, real, {"1": ["--threads", 1, "--refine", "0.5", "--by-default"]})
    elif section == "growth":
        names = catalogue.select(catalogue.growth, patterns, catalogue.growth)
        measure_surfaces(section, session, builds, catalogue, names, {"1": ["--threads", 1, "--no-vtk"]})
    elif section == "budget":
        measure_budget(session, builds, catalogue, catalogue.select(list(BUDGETS), patterns, list(BUDGETS)))
    elif section == "peers":
        measure_peers(session, builds[-1], catalogue, catalogue.select(list(PEER_SURFACES), patterns, list(PEER_SURFACES)))
