#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/results.md: results on the real volumes.

The page has topology, certificate and triangles of coarse meshes, compared with VTK's contour
filters; then refined levels: the table of the paper, bounds on the distance, and the triangle
counts of CGAL Mesh_3.

    scripts/install_dependencies.sh bench
    python3 bench/results.py [--data ../shared/data] [--oracle ../shared/oracle]

Builds the bench preset and, if its source exists, the independent oracle. Uses only the standard
library.
"""

import argparse
import csv
import datetime
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# Coarse triangles of the feasibility study (index space, unit spacing), and the target as a
# multiple of them: 1.2, or 1.5 on anisotropic volumes, because the study used unit spacing.
STUDY = {
    ("head_igea_sdf.nrrd", "0"): (6, 1.2),
    ("dragon_sdf.nrrd", "0"): (418, 1.2),
    ("neuron_dendrite.nrrd", "127.5"): (1834, 1.5),
    ("brain_fa.nii.gz", "0.2"): (60577, 1.2),
    ("vessels_aneurism.nrrd", "60.5"): (33997, 1.2),
    ("ct_chest.mha", "120.5"): (91128, 1.5),
    ("ct_head_rotated.nrrd", "500.5"): (2353, 1.5),
    ("ct_oblique.nii.gz", "80.5"): (1722, 1.5),
    ("stent_ct.nrrd", "800.5"): (23034, 1.2),
    ("flame_heptane.nii.gz", "60.5"): (5388, 1.2),
    ("brain_white_matter.nii.gz", "127.5"): (7842, 1.2),
    ("protein_iron.nhdr", "100"): (692, 1.2),
    ("embryo.nrrd", "90.5"): (161764, 1.2),
    ("ct_engine.nrrd", "128"): (10398, 1.2),
}


def run(command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)


def run_or_exit(command, **options):
    """The output of a command. Ends this script if the command fails."""
    done = run(command, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def sections(text):
    """[(heading, text)] of a page, in order; the first entry is the text before all headings."""
    parts = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    return [
        (part.split("\n", 1)[0] if part.startswith("## ") else "", part.strip() + "\n")
        for part in parts
    ]


def with_new_sections(old, new):
    """The old page with its sections replaced by those of the new page.

    Sections that only the old page has are kept: other scripts and people write them.
    """
    written = {heading: text for heading, text in sections(new) if text.strip()}
    kept = [written.pop(heading, part) for heading, part in sections(old)]
    return "\n".join(kept + list(written.values()))


def build(oracle_source):
    run_or_exit(["cmake", "--preset", "bench"], cwd=ROOT)
    run_or_exit(["cmake", "--build", "--preset", "bench"], cwd=ROOT)
    oracle = None
    if oracle_source.is_dir():
        folder = ROOT / "build" / "oracle"
        run_or_exit(["cmake", "-S", oracle_source, "-B", folder, "-DCMAKE_BUILD_TYPE=Release"])
        run_or_exit(["cmake", "--build", folder, "-j2", "--target", "oracle"])
        oracle = folder / "oracle"
    return ROOT / "build" / "bench" / "bin", oracle


def triangle_counts(bin_folder, volume, iso):
    """Triangles of vtkMarchingCubes and of isoatlas with self-intersections allowed."""
    b = json.loads(
        run_or_exit([bin_folder / "bench_extract", volume, iso, "--allow-self-intersections"])
    )
    return b["marching_cubes"]["triangles"], b["levels"][-1]["triangles"]


def cpu_name():
    try:
        for line in open("/proc/cpuinfo"):
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor()


def yes(flag):
    return "yes" if flag else "**NO**"


def commit():
    dirty = run(
        ["git", "status", "--porcelain", "--", "src", "include", "apps", "bench", "cmake"], cwd=ROOT
    ).stdout.strip()
    return run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT).stdout.strip() + (
        " and uncommitted changes" if dirty else ""
    )


# Triangles of the four meshes in each of the paper's figures 11, 13, 14 and 15.
PAPER = [
    ("head", "head_igea_sdf.nrrd", "0", (38, 358, 4286, 8752)),
    ("dragon", "dragon_sdf.nrrd", "0", (4020, 18498, 41910, 65420)),
    ("dendrite", "neuron_dendrite.nrrd", "127.5", (3974, 12898, 21648, 63906)),
    ("brain", "brain_fa.nii.gz", "0.2", (10606, 16354, 37002, 49734)),
]
# Meshes of CGAL Mesh_3: triangles, largest two-sided distance and mean distance from mesh to
# surface in voxels (measured for the study).
MESH_3 = {
    "head": ((4466, 0.932, 0.15), (8868, 0.525, 0.087), (11630, 0.426, 0.07)),
    "dragon": ((24544, 0.994, 0.14), (46100, 0.815, 0.081), (58646, 0.486, 0.066)),
}
REFINED = [p[:3] for p in PAPER[:3]]
# A bound that no mesh satisfies: the number of vertices ends the refinement.
UNREACHABLE = ["--refine", "max-distance:0.01vx"]


class Refinement:
    """The section on refined levels.

    Distances are measured by the tool, with 200,000 samples in each direction, and by the oracle.
    """

    def __init__(self, tool, oracle, data, work):
        self.tool, self.oracle, self.data, self.work = tool, oracle, data, work

    def extract(self, name, iso, *options):
        """Mesh a volume.

        Returns the finest level of the report, the oracle's distances (largest, p99, mean, largest
        at grid edges; in voxels) or None without an oracle, and the seconds of the level.
        """
        mesh, report = self.work / "level.ply", self.work / "level.json"
        fixed = ["--space", "voxel", "-q", "--measure", "--threads", "1"]
        command = [self.tool, "extract", self.data / name, "--iso", iso, "-o", mesh]
        done = run([*command, "--report", report, *fixed, *options])
        if done.returncode not in (0, 1):
            sys.exit(done.stderr)
        r = json.load(open(report))
        level = r["levels"][-1]
        from_oracle = None
        if self.oracle:
            command = [self.oracle, "volume", self.data / name, "--iso", iso, "--mesh", mesh]
            command += ["--mesh-space", "index", "--rules", "d", "--samples", "200000", "--json"]
            d = json.loads(run(command).stdout)["mesh"]["distance"]["physical"]
            a, b = d["mesh_to_isosurface_newton"], d["isosurface_to_mesh"]
            nodes = d["reference_to_mesh"]["max_over_grid_nodes"]
            lengths = (max(a["max"], b["max"]), max(a["p99"], b["p99"]), a["mean"], nodes)
            from_oracle = [length / level["measured"]["voxel"] for length in lengths]
        return level, from_oracle, level["seconds"]

    @staticmethod
    def distances(level, from_oracle):
        """Six table cells: largest, p99 and mean distance by the tool, and by the oracle."""
        m = level["measured"]
        ours = (
            f"{m['maximum'] / m['voxel']:.3f} | {m['p99'] / m['voxel']:.3f} "
            f"| {m['mesh_to_surface']['voxels']['mean']:.4f}"
        )
        if not from_oracle:
            return ours + " | | |"
        return ours + " | " + " | ".join(f"{x:.{n}f}" for x, n in zip(from_oracle, (3, 3, 4)))

    @staticmethod
    def shape(level):
        a = level["quality"]["aspect_ratio"]
        angle = level["quality"]["angle_degrees"]["minimum"]
        share = 100 * a["share_below_third"]
        return f"{a['minimum']:.3f} | {a['p01']:.3f} | {share:.3f} % | {angle:.1f}"

    @staticmethod
    def topology(level):
        return f"{level['components']:,} / {level['genus']:,} / {level['boundary_loops']:,}"

    def paper(self):
        rows = []
        for label, name, iso, counts in PAPER:
            if label == "brain":
                continue
            for count in counts:
                limit = ["--max-vertices", str(self.vertices(label, count))]
                level, from_oracle, _ = self.extract(name, iso, *limit, *UNREACHABLE)
                print(f"{label} {count}", flush=True)
                rows.append(
                    f"| {label} | {count:,} | {level['triangles']:,} "
                    f"| {self.distances(level, from_oracle)} "
                    f"| {self.shape(level)} | {self.topology(level)} |"
                )
        return rows

    @staticmethod
    def vertices(label, triangles):
        """Vertices of a closed surface: V = 2 - 2 genus + T / 2."""
        return triangles // 2 + 2 - 2 * {"head": 0, "dragon": 1, "dendrite": 2}[label]

    def brain_floor(self):
        """The size of the coarse mesh of the brain, with and without specks.

        Specks are components that enclose less than 10 voxels. Returns all triangles, components,
        specks, and the triangles without specks.
        """
        mesh = self.work / "brain.off"
        options = ["--iso", "0.2", "--coarse", "-o", mesh, "--space", "voxel", "-q"]
        run_or_exit([self.tool, "extract", self.data / "brain_fa.nii.gz", *options])
        lines = [line.split() for line in open(mesh) if not line.startswith("#")]
        nv, nf = int(lines[1][0]), int(lines[1][1])
        p = [tuple(map(float, line[:3])) for line in lines[2 : 2 + nv]]
        faces = [tuple(map(int, line[1:4])) for line in lines[2 + nv : 2 + nv + nf]]
        root = list(range(nv))

        def find(i):
            while root[i] != i:
                root[i] = root[root[i]]
                i = root[i]
            return i

        for a, b, c in faces:
            root[find(a)] = find(b)
            root[find(b)] = find(c)
        size, volume = {}, {}
        for a, b, c in faces:
            r = find(a)
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = p[a], p[b], p[c]
            size[r] = size.get(r, 0) + 1
            volume[r] = (
                volume.get(r, 0)
                + (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx))
                / 6
            )
        specks = [r for r in size if abs(volume[r]) < 10]
        return nf, len(size), len(specks), nf - sum(size[r] for r in specks)

    def bounds(self):
        rows = []
        for placement in ("surface", "balanced"):
            for label, name, iso in REFINED:
                for bound in ("1", "0.5", "0.25"):
                    level, from_oracle, seconds = self.extract(
                        name, iso, "--refine", f"max-distance:{bound}vx", "--placement", placement
                    )
                    print(f"{label} {bound} {placement}", flush=True)
                    at_edges = f"{from_oracle[3]:.3f}" if from_oracle else ""
                    rows.append(
                        f"| {label} | {placement} | {bound} | {level['triangles']:,} "
                        f"| {self.distances(level, from_oracle)} | {at_edges} "
                        f"| {self.shape(level)} | {level['at_limit']['count']} | {seconds:.1f} |"
                    )
        return rows

    def like_mesh_3(self):
        rows = []
        for label, peers in MESH_3.items():
            name, iso = next((n, i) for l, n, i, _ in PAPER if l == label)
            for count, largest, mean in peers:
                limit = ["--max-vertices", str(self.vertices(label, count))]
                level, from_oracle, seconds = self.extract(
                    name, iso, *limit, *UNREACHABLE, "--placement", "balanced"
                )
                print(f"{label} like Mesh_3 {count}", flush=True)
                rows.append(
                    f"| {label} | {count:,} | {largest:.3f} | {mean:.4f} "
                    f"| {level['triangles']:,} | {self.distances(level, from_oracle)} "
                    f"| {self.shape(level)} | {seconds:.1f} |"
                )
        return rows


class TopologyTable:
    """The topology of coarse meshes under one rule, compared with TOPOLOGY.tsv and the oracle."""

    def __init__(self, rule, oracle):
        self.rule, self.oracle = rule, oracle
        self.oracle_rule = {"faces": "c", "trilinear": "d"}[rule]  # the oracle's name of the rule
        self.lines, self.passed = [], {"topology": 0, "certificate": 0, "oracle": 0}

    def add(self, label, row, volume, mesh, done, report):
        if done.returncode != 0:
            self.lines.append(f"| {label} | failed: {done.stderr.strip()} | | | | | | | |")
            return
        m = report["levels"][-1]
        expected = [
            int(row[f"{self.rule}_{k}"]) for k in ("components", "euler", "genus", "boundary_loops")
        ]
        got = [m[k] for k in ("components", "euler_characteristic", "genus", "boundary_loops")]
        certified = bool(m["certificate"]["passed"])
        accepted = None
        if self.oracle:
            command = [self.oracle, "volume", volume, "--iso", row["isovalue"], "--mesh", mesh]
            command += ["--mesh-space", "index", "--rules", self.oracle_rule, "--no-distance"]
            accepted = run([*command, "--require", self.oracle_rule]).returncode == 0
        self.passed["topology"] += got == expected
        self.passed["certificate"] += certified
        self.passed["oracle"] += bool(accepted)
        self.lines.append(
            f"| {label} | {got[0]:,} | {got[2]:,} | {got[3]:,} | {got[1]:,} "
            f"| {report['reference']['tunnels']:,} | {yes(got == expected)} | {yes(certified)} "
            f"| {'not run' if accepted is None else yes(accepted)} |"
        )

    def text(self, rows):
        n = len(rows)
        equal, certified = self.passed["topology"], self.passed["certificate"]
        accepted = f"{self.passed['oracle']} of {n}" if self.oracle else "not run"
        return f"""Topology equal to `TOPOLOGY.tsv` (columns `{self.rule}_*`): **{equal} of {n}**.
Certificate passed: **{certified} of {n}**.
Accepted by the independent oracle, component by component (`--require {self.oracle_rule}`):
**{accepted}**.

| volume @ isovalue | components | genus | boundary loops | Euler characteristic | tunnels \
| as in TOPOLOGY.tsv | certificate | oracle |
|---|---:|---:|---:|---:|---:|---|---|---|
{chr(10).join(self.lines)}
"""


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--oracle", type=pathlib.Path, default=ROOT.parent / "shared" / "oracle")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs" / "results.md")
    options = parser.parse_args()
    bin_folder, oracle = build(options.oracle)
    tool = bin_folder / "isoatlas"
    work = pathlib.Path(tempfile.mkdtemp(prefix="isoatlas-results-"))

    rows = list(csv.DictReader(open(options.data / "TOPOLOGY.tsv"), delimiter="\t"))
    triangles, shape = [], []
    faces, trilinear = TopologyTable("faces", oracle), TopologyTable("trilinear", oracle)
    for row in rows:
        name, iso = row["file"], row["isovalue"]
        label = f"{name.split('.')[0]} @ {iso}"
        print(label, flush=True)
        volume, mesh, report_file = options.data / name, work / "mesh.ply", work / "report.json"
        for table in (faces, trilinear):  # the default is last: the code below uses its report
            command = [tool, "extract", volume, "--iso", iso, "--topology", table.rule]
            command += ["--coarse", "-o", mesh, "--report", report_file, "--space", "voxel", "-q"]
            done = run(command)
            r = json.load(open(report_file)) if done.returncode == 0 else None
            table.add(label, row, volume, mesh, done, r)
        if done.returncode != 0:
            continue
        m = r["levels"][-1]
        c = m["certificate"]
        cubes, allowed = triangle_counts(bin_folder, volume, iso)
        study = STUDY.get((name, iso))
        bound = "| | |"
        if study:
            limit = study[1] * study[0]
            bound = (
                f"{study[0]:,} | {limit:,.0f} | {m['triangles'] / study[0]:.2f} "
                f"| {yes(m['triangles'] <= limit)}"
            )
        triangles.append(
            f"| {label} | {cubes:,} | {r['reference']['c_vertices']:,} | {m['triangles']:,} "
            f"| {allowed:,} | {bound} |"
        )
        q = m["quality"]["aspect_ratio"]
        shape.append(
            f"| {label} | {c['repair_sites']:,} in {c['repair_rounds']} rounds "
            f"| {q['minimum']:.3g} | {q['p01']:.3f} | {q['median']:.3f} "
            f"| {100 * q['share_below_third']:.2f} % |"
        )

    nan = options.data / "tmap_nan.nii.gz"
    mesh = work / "tmap.ply"
    refused = run([tool, "extract", nan, "--iso", "2", "--coarse", "-o", mesh, "-q"])
    tmap = [
        f"* without `--nan`: exit status {refused.returncode}, "
        f"file written: {'yes' if mesh.exists() else 'no'}, "
        f"message: `{refused.stderr.strip().replace(str(nan), nan.name)}`"
    ]
    for side in ("below", "above"):
        command = [tool, "extract", nan, "--iso", "2", "--coarse", "-o", mesh, "-q"]
        done = run([*command, "--report", work / "tmap.json", "--nan", side])
        m = json.load(open(work / "tmap.json"))["levels"][-1]
        tmap.append(
            f"* `--nan {side}`: exit status {done.returncode}, {m['triangles']:,} triangles, "
            f"{m['components']:,} components, genus {m['genus']:,}, "
            f"{m['boundary_loops']:,} boundary loops"
        )

    refinement = Refinement(tool, oracle, options.data, work)
    paper, bounds, like_mesh_3 = refinement.paper(), refinement.bounds(), refinement.like_mesh_3()
    floor, floor_components, specks, without = refinement.brain_floor()
    distances = "largest | p99 | mean | oracle: largest | p99 | mean"
    shapes = "aspect ratio: min | 1st percentile | below 1/3 | least angle"
    today = datetime.date.today().isoformat()

    text = f"""# Results

`bench/results.py` wrote the tables on {today} from commit {commit()}; do not edit them by hand. One
thread, {cpu_name()}, shared with other work: compare the ratios, not the milliseconds. The volumes
are the sixteen of the development data, with the isovalues of its `TOPOLOGY.tsv`.

## Topology

With the default topology, the surface has a tunnel wherever the trilinear interpolant connects two
loops of a grid cell by a tunnel.

{trilinear.text(rows)}
With `--topology faces` every loop is spanned by a disk, as in the paper:

{faces.text(rows)}
`tmap_nan` (2,066 NaN samples), isovalue 2:

{chr(10).join(tmap)}

## Triangles of the coarse mesh

"Study" is the coarse column of the feasibility study, whose meshes intersect themselves. The target
("at most") is 1.2 times that number, or 1.5 times on anisotropic volumes, which the study meshed
with unit spacing.

| volume @ isovalue | marching cubes | c-vertices | isoatlas | self-intersections allowed | study \
| at most | ratio | satisfied |
|---|---:|---:|---:|---:|---:|---:|---:|---|
{chr(10).join(triangles)}

## Shape of the coarse mesh

For coarse meshes only the topology is guaranteed, not the shape (paper, section 3.7). World units.

| volume @ isovalue | sites added by repair | aspect ratio: min | 1st percentile | median \
| below 1/3 |
|---|---:|---:|---:|---:|---:|
{chr(10).join(shape)}
"""
    text += f"""
## Refined levels

Two-sided distances in voxels (`--measure`, 200,000 samples in each direction; the mean is from mesh
to surface), and those of the independent oracle with the same number of samples. Shape is in world
units. Seconds are wall clock time of the level with one thread on a busy machine.

### The paper's table

The triangle counts of the paper, requested as `--max-vertices` with a distance bound that cannot be
satisfied (`--refine max-distance:0.01vx`), with vertices on the surface. The paper's own volumes
are not available; ours have the same size and are of the same kind.

| mesh | paper | isoatlas | {distances} | {shapes} | components / genus / loops |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|
{chr(10).join(paper)}

Brain (10,606, 16,354, 37,002 and 49,734 triangles in the paper): topology alone needs **{floor:,}**
triangles for {floor_components:,} components here; without the {specks:,} specks that enclose less
than 10 voxels, **{without:,}**. None of the paper's four counts can be reached with all components
kept. The paper does not state the number of components of its meshes.

### A bound on the distance

`--refine max-distance:B` for B = 1, 0.5 and 0.25 voxels. Targets at 0.5: p99 at most 0.5, largest
distance at most 0.6, no triangle below 1/3, smallest angle at least 17 degrees. "At limit": Voronoi
cells that violate the bound and cannot become smaller. "At edges": largest distance of the oracle
from all points where the surface crosses grid edges; these protrude most at creases and tips.

| mesh | placement | bound | triangles | {distances} | at edges | {shapes} | at limit | s |
|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|
{chr(10).join(bounds)}

Triangles that other methods need for the same largest distance, measured for the study (same
volumes, same oracle). Head, 0.5 voxels: quadric decimation of full-resolution flying edges 5,122,
Garland-Heckbert and Lindstrom-Turk (CGAL) 6,120, meshoptimizer 7,320, Mesh_3 10,404. Head, 0.25
voxels: 12,502, 14,940, 19,526 and about 27,000. Dragon, 0.5 voxels: quadric decimation 34,158 (at
65,420 it opened holes), meshoptimizer 37,836, Mesh_3 between 46,100 and 92,638. Decimation
guarantees neither topology nor shape.

### Beside CGAL Mesh_3

At the triangle counts of Mesh_3, with `--placement balanced`. The figures of Mesh_3 were measured
for the study with the same oracle.

| mesh | Mesh_3 | its largest | its mean | isoatlas | {distances} | {shapes} | s |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|
{chr(10).join(like_mesh_3)}
"""
    old = options.out.read_text() if options.out.exists() else ""
    options.out.write_text(with_new_sections(old, text))
    print(f"wrote {options.out}")
    for file in work.iterdir():
        file.unlink()
    os.rmdir(work)


if __name__ == "__main__":
    main()
