#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/results.md: topology, certificate, triangles and time on the real volumes, beside VTK's contour filters.

    scripts/install_dependencies.sh bench
    python3 bench/results.py [--data ../shared/data] [--oracle ../shared/oracle] [--repeats 5]

Builds the bench preset and, if its source is there, the independent oracle. Standard library only.
"""
import argparse
import csv
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# Coarse triangles of the feasibility study (index space, unit spacing), and how many times that is asked for at most:
# 1.2, on anisotropic volumes 1.5, since the study knew no spacing.
STUDY = {
    ("head_igea_sdf.nrrd", "0"): (6, 1.2), ("dragon_sdf.nrrd", "0"): (418, 1.2), ("neuron_dendrite.nrrd", "127.5"): (1834, 1.5),
    ("brain_fa.nii.gz", "0.2"): (60577, 1.2), ("vessels_aneurism.nrrd", "60.5"): (33997, 1.2), ("ct_chest.mha", "120.5"): (91128, 1.5),
    ("ct_head_rotated.nrrd", "500.5"): (2353, 1.5), ("ct_oblique.nii.gz", "80.5"): (1722, 1.5), ("stent_ct.nrrd", "800.5"): (23034, 1.2),
    ("flame_heptane.nii.gz", "60.5"): (5388, 1.2), ("brain_white_matter.nii.gz", "127.5"): (7842, 1.2), ("protein_iron.nhdr", "100"): (692, 1.2),
    ("embryo.nrrd", "90.5"): (161764, 1.2), ("ct_engine.nrrd", "128"): (10398, 1.2),
}
# At most so many times vtkMarchingCubes: 2 on smooth volumes, 8 on noisy ones.
SMOOTH = {("head_igea_sdf.nrrd", "0"), ("dragon_sdf.nrrd", "0"), ("neuron_dendrite.nrrd", "127.5"), ("ct_oblique.nii.gz", "80.5"),
          ("brain_white_matter.nii.gz", "127.5"), ("ct_engine.nrrd", "80.5")}


def run(command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)


def must(command, **options):
    done = run(command, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def build(oracle_source):
    must(["cmake", "--preset", "bench"], cwd=ROOT)
    must(["cmake", "--build", "--preset", "bench"], cwd=ROOT)
    oracle = None
    if oracle_source.is_dir():
        folder = ROOT / "build" / "oracle"
        must(["cmake", "-S", oracle_source, "-B", folder, "-DCMAKE_BUILD_TYPE=Release"])
        must(["cmake", "--build", folder, "-j2", "--target", "oracle"])
        oracle = folder / "oracle"
    return ROOT / "build" / "bench" / "bin", oracle


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
    dirty = run(["git", "status", "--porcelain", "--", "src", "include", "apps", "bench", "cmake"], cwd=ROOT).stdout.strip()
    return run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT).stdout.strip() + (" and uncommitted changes" if dirty else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--oracle", type=pathlib.Path, default=ROOT.parent / "shared" / "oracle")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs" / "results.md")
    options = parser.parse_args()
    bin_folder, oracle = build(options.oracle)
    tool = bin_folder / "isoatlas"
    work = pathlib.Path(tempfile.mkdtemp(prefix="isoatlas-results-"))

    rows = list(csv.DictReader(open(options.data / "TOPOLOGY.tsv"), delimiter="\t"))
    topology, triangles, time, shape = [], [], [], []
    passed = {"topology": 0, "certificate": 0, "oracle": 0}
    for row in rows:
        name, iso = row["file"], row["isovalue"]
        label = f"{name.split('.')[0]} @ {iso}"
        print(label, flush=True)
        volume, mesh, report_file = options.data / name, work / "mesh.ply", work / "report.json"
        done = run([tool, "extract", volume, "--iso", iso, "--coarse", "-o", mesh, "--report", report_file, "--space", "voxel", "-q"])
        if done.returncode != 0:
            topology.append(f"| {label} | failed: {done.stderr.strip()} | | | | | | |")
            continue
        r = json.load(open(report_file))
        m = r["levels"][-1]
        c = m["certificate"]
        want = [int(row["faces_" + k]) for k in ("components", "euler", "genus", "boundary_loops")]
        got = [m[k] for k in ("components", "euler_characteristic", "genus", "boundary_loops")]
        judged = None
        if oracle:
            judged = run([oracle, "volume", volume, "--iso", iso, "--mesh", mesh, "--mesh-space", "index", "--rules", "c", "--no-distance",
                          "--require", "c"]).returncode == 0
        passed["topology"] += got == want
        passed["certificate"] += bool(c["passed"])
        passed["oracle"] += bool(judged)
        topology.append(f"| {label} | {got[0]:,} | {got[2]:,} | {got[3]:,} | {got[1]:,} | {yes(got == want)} | {yes(c['passed'])} | "
                        f"{'not run' if judged is None else yes(judged)} |")

        b = json.loads(must([bin_folder / "bench_extract", volume, iso, options.repeats]))
        study = STUDY.get((name, iso))
        bound = f"{study[0]:,} | {study[1] * study[0]:,.0f} | {m['triangles'] / study[0]:.2f} | {yes(m['triangles'] <= study[1] * study[0])}" if study else "| | |"
        triangles.append(f"| {label} | {b['mc_triangles']:,} | {r['reference']['c_vertices']:,} | {m['triangles']:,} | {bound} |")
        q = m["quality"]["aspect_ratio"]
        shape.append(f"| {label} | {c['repair_sites']:,} in {c['repair_rounds']} rounds | {q['minimum']:.3g} | {q['p01']:.3f} | {q['median']:.3f} | "
                     f"{100 * q['share_below_third']:.2f} % |")
        ratio = b["isoatlas_ms"] / b["mc_ms"]
        limit = 2 if (name, iso) in SMOOTH else 8
        s = b["stages_ms"]
        time.append(f"| {label} | {b['mc_ms']:.0f} | {b['fe_ms']:.0f} | {b['isoatlas_ms']:.0f} | {ratio:.2f} | {b['isoatlas_ms'] / b['fe_ms']:.1f} | "
                    f"{yes(ratio <= limit)} (≤ {limit}) | " + " | ".join(f"{s[k]:.0f}" for k in ("surface", "components", "coarsen", "cover", "certify", "mesh", "check")) +
                    f" | {r['peak_memory_bytes'] / 2**20:.0f} |")

    nan = options.data / "tmap_nan.nii.gz"
    mesh = work / "tmap.ply"
    refused = run([tool, "extract", nan, "--iso", "2", "--coarse", "-o", mesh, "-q"])
    tmap = [f"* without `--nan`: exit status {refused.returncode}, file written: {'yes' if mesh.exists() else 'no'}, "
            f"message: `{refused.stderr.strip().replace(str(nan), nan.name)}`"]
    for side in ("below", "above"):
        done = run([tool, "extract", nan, "--iso", "2", "--coarse", "-o", mesh, "--report", work / "tmap.json", "--nan", side, "-q"])
        m = json.load(open(work / "tmap.json"))["levels"][-1]
        tmap.append(f"* `--nan {side}`: exit status {done.returncode}, {m['triangles']:,} triangles, {m['components']:,} components, "
                    f"genus {m['genus']:,}, {m['boundary_loops']:,} boundary loops")

    n = len(rows)
    text = f"""# Results

Written by `bench/results.py` on {datetime.date.today().isoformat()} from commit {commit()}; do not edit by hand. One thread,
{cpu_name()}, shared with other work: read the ratios, not the milliseconds. Volumes: the sixteen of the development data,
isovalues of its `TOPOLOGY.tsv`.

## Topology

Topology equal to `TOPOLOGY.tsv` (columns `faces_*`): **{passed['topology']} of {n}**; certificate passed: **{passed['certificate']} of {n}**;
accepted by the independent oracle, component by component (`--require c`): **{str(passed['oracle']) + ' of ' + str(n) if oracle else 'not run'}**.

| volume @ isovalue | components | genus | boundary loops | Euler characteristic | as in TOPOLOGY.tsv | certificate | oracle |
|---|---:|---:|---:|---:|---|---|---|
{chr(10).join(topology)}

`tmap_nan` (2,066 NaN samples), isovalue 2:

{chr(10).join(tmap)}

## Triangles of the coarse mesh

"Study" is the feasibility study's coarse column; asked for is at most 1.2 times that, 1.5 times on anisotropic volumes, which the
study meshed with unit spacing.

| volume @ isovalue | marching cubes | c-vertices | isoatlas | study | at most | ratio | met |
|---|---:|---:|---:|---:|---:|---:|---|
{chr(10).join(triangles)}

## Shape of the coarse mesh

Nothing is promised here yet: a coarse mesh has to be right before it is nice (paper, section 3.7). World units.

| volume @ isovalue | sites added by repair | aspect ratio: min | 1st percentile | median | below 1/3 |
|---|---:|---:|---:|---:|---:|
{chr(10).join(shape)}

## Time

CPU milliseconds from the volume in memory to the checked mesh, best of {options.repeats}, in one process with `vtkMarchingCubes` and
`vtkFlyingEdges3D` (normals, gradients and scalars off) in turns on the same samples. Asked for: at most 2 times marching cubes on the
smooth volumes, 8 times on the noisy ones. Stages: milliseconds of the best run by the wall clock. Memory: peak of the tool in MiB, volume and
libraries included.

Where it goes: on smooth volumes a third each into reading the samples and placing c-vertices (`surface`), into making the coarser complex certified
(`coarsen`) and into disks (`cover`, `certify`); on noisy ones, whose complexes shrink little, into disks and repair. `certify` includes repair; `mesh` turning
components outward; `check` counting the finished triangles and measuring their shape.

| volume @ isovalue | MC | FE | isoatlas | / MC | / FE | met | surface | components | coarsen | cover | certify | mesh | check | MiB |
|---|---:|---:|---:|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|
{chr(10).join(time)}
"""
    options.out.write_text(text)
    print(f"wrote {options.out}")
    for file in work.iterdir():
        file.unlink()
    os.rmdir(work)


if __name__ == "__main__":
    main()
