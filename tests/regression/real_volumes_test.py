#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes the real volumes of ../shared/data and compares their topology with known values.

real_volumes_test.py topology TOOL FOLDER       every row of TOPOLOGY.tsv; writes meshes to FOLDER
real_volumes_test.py faces TOOL FOLDER          the same with --topology faces
real_volumes_test.py nan TOOL FOLDER            the volume with NaN voxels
real_volumes_test.py bytes TOOL FOLDER          the same bytes for any number of threads
real_volumes_test.py build-oracle BUILD         builds the oracle, an independent checker
real_volumes_test.py oracle ORACLE FOLDER       the oracle checks the meshes in FOLDER
real_volumes_test.py oracle-faces ORACLE FOLDER the same for the meshes with --topology faces
real_volumes_test.py distance TOOL ORACLE FOLDER
                    compares `isoatlas check --volume` with the oracle on the same meshes

Exit status 77 means skipped: no data or no oracle. ISOATLAS_TEST_DATA and ISOATLAS_TEST_ORACLE name
their folders if they are not in ../shared next to the repository. Needs only the standard library.
"""

import csv
import json
import os
import pathlib
import subprocess
import sys
import time

SHARED = pathlib.Path(__file__).resolve().parents[3] / "shared"
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or SHARED / "data")
ORACLE_SOURCE = pathlib.Path(os.environ.get("ISOATLAS_TEST_ORACLE") or SHARED / "oracle")
SKIPPED = 77


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(SKIPPED)


def table():
    path = DATA / "TOPOLOGY.tsv"
    if not path.is_file():
        skip(f"no {path}; set ISOATLAS_TEST_DATA to the folder of volumes that has it")
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    if not rows:
        raise AssertionError(f"{path} has no rows")
    return rows


def mesh_of(folder, row):
    return folder / f"{row['file']}@{row['isovalue']}.ply"


def extract(tool, row, mesh, report, *options):
    return subprocess.run([
        tool, "extract", DATA / row["file"], "--iso", row["isovalue"], "--coarse", "--space",
        "voxel", "-o", mesh, "--report", report, "-q", *options
    ], capture_output=True, text=True)


def check_row(tool, folder, row, rule, *options):
    """Yields the errors. The rule, trilinear or faces, selects the columns of the table."""
    mesh = mesh_of(folder, row)
    report_path = mesh.with_suffix(".json")
    for path in (mesh, report_path):
        path.unlink(missing_ok=True)
    run = extract(tool, row, mesh, report_path, *options)
    if run.returncode != 0:
        yield f"exit status {run.returncode}: {run.stderr.strip()}"
        return
    report = json.loads(report_path.read_text())
    finest = report["levels"][-1]
    if report["surface"]["topology"] != rule:
        yield f"the topology is {report['surface']['topology']}"
    for part, topology in (("mesh", finest), ("reference", report["reference"])):
        for key, column in (("components", f"{rule}_components"),
                            ("euler_characteristic", f"{rule}_euler"), ("genus", f"{rule}_genus"),
                            ("boundary_loops", f"{rule}_boundary_loops")):
            if topology[key] != int(row[column]):
                yield f"{part} {key} is {topology[key]} instead of {row[column]}"
    tunnels = int(row["tunnel_cells"]) if rule == "trilinear" else 0
    if report["reference"]["tunnels"] != tunnels:
        yield f"{report['reference']['tunnels']} tunnels instead of {tunnels}"
    if finest["certificate"]["passed"] is not True:
        yield "the certificate did not pass"
    # Recounted by the tool from the file alone.
    check = subprocess.run([tool, "check", mesh, "--json"], capture_output=True, text=True)
    if check.returncode != 0:
        yield f"`isoatlas check` exits with {check.returncode}: {check.stderr.strip()}"
        return
    counted = json.loads(check.stdout)
    for key in ("components", "euler_characteristic", "genus", "boundary_loops", "kinds"):
        if counted[key] != finest[key]:
            yield f"{key} is {counted[key]} in the file, but {finest[key]} in the report"
    if sum(kind["count"] for kind in counted["kinds"]) != int(row[f"{rule}_components"]):
        yield "the kinds of components do not add up"


def report_all(rows, check):
    failures = 0
    for row in rows:
        start = time.monotonic()
        wrong = list(check(row))
        failures += bool(wrong)
        print(
            f"{'FAILED' if wrong else 'ok    '} {row['file']} at {row['isovalue']} "
            f"({time.monotonic() - start:.1f} s)"
            + "".join(f"\n       {line}" for line in wrong), flush=True)
    print(f"{len(rows) - failures} of {len(rows)} passed")
    return 1 if failures else 0


def topology(tool, folder, rule="trilinear", *options):
    rows = table()
    folder.mkdir(parents=True, exist_ok=True)
    return report_all(rows, lambda row: check_row(tool, folder, row, rule, *options))


def faces(tool, folder):
    return topology(tool, folder, "faces", "--topology", "faces")


def nan(tool, folder):
    table()
    row = {"file": "tmap_nan.nii.gz", "isovalue": "1.5"}
    folder.mkdir(parents=True, exist_ok=True)
    mesh, report = folder / "tmap.ply", folder / "tmap.json"
    wrong = []
    for path in (mesh, report):
        path.unlink(missing_ok=True)
    refused = extract(tool, row, mesh, report)
    if refused.returncode != 2:
        wrong.append(
            f"without --nan: exit status {refused.returncode} instead of 2: "
            f"{refused.stderr.strip()}"
        )
    for word in ("NaN", "--nan"):
        if word not in refused.stderr:
            wrong.append(
                f"without --nan: the message does not contain {word!r}: {refused.stderr.strip()}")
    if mesh.exists() or report.exists():
        wrong.append("without --nan: something was written")
    seen = []
    for isovalue in ("1.5", "-1"):
        for side in ("below", "above"):
            row["isovalue"] = isovalue
            run = extract(tool, row, mesh, report, "--nan", side)
            if run.returncode != 0:
                wrong.append(
                    f"--nan {side} at {isovalue}: exit status {run.returncode}: "
                    f"{run.stderr.strip()}"
                )
                continue
            found = json.loads(report.read_text())
            finest = found["levels"][-1]
            is_same = finest["kinds"] == found["reference"]["kinds"]
            if not is_same or finest["certificate"]["passed"] is not True:
                wrong.append(f"--nan {side} at {isovalue}: the mesh is not certified")
            check = subprocess.run([tool, "check", mesh], capture_output=True, text=True)
            if check.returncode != 0:
                wrong.append(
                    f"--nan {side} at {isovalue}: `isoatlas check` exits with {check.returncode}")
            seen.append(json.dumps(finest["kinds"]))
        if len(seen) >= 2 and seen[-1] == seen[-2]:
            wrong.append(
                f"at {isovalue} the side of NaN makes no difference, though NaN is next to the data"
            )
    print("\n".join(wrong) or "ok")
    return 1 if wrong else 0


def same_bytes(tool, folder):
    chosen = {("vessels_aneurism.nrrd", "100"), ("ct_engine.nrrd", "128"),
              ("protein_iron.nhdr", "100")}
    rows = [row for row in table() if (row["file"], row["isovalue"]) in chosen]
    folder.mkdir(parents=True, exist_ok=True)

    def check(row):
        bytes_of = {}
        for threads in ("1", "2", "3", "1"):
            mesh, report = folder / "bytes.ply", folder / "bytes.json"
            mesh.unlink(missing_ok=True)
            run = extract(tool, row, mesh, report, "--threads", threads)
            if run.returncode != 0:
                yield f"exit status {run.returncode}: {run.stderr.strip()}"
                return
            bytes_of.setdefault(mesh.read_bytes(), []).append(threads)
        if len(bytes_of) != 1:
            yield f"the bytes depend on the run: threads {list(bytes_of.values())}"

    return report_all(rows, check)


def build_oracle(build):
    if not (ORACLE_SOURCE / "CMakeLists.txt").is_file():
        skip(f"no {ORACLE_SOURCE}; set ISOATLAS_TEST_ORACLE to the sources of the oracle")
    configure = subprocess.run(
        ["cmake", "-S", ORACLE_SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release"],
        capture_output=True, text=True)
    if configure.returncode != 0:
        # Its libraries are not dependencies of isoatlas. Without them the test is skipped.
        skip(
            f"the oracle cannot be configured here (it needs libcgal-dev, libgmp-dev, "
            f"zlib1g-dev):\n{configure.stdout}{configure.stderr}"
        )
    made = subprocess.run(["cmake", "--build", build, "--target", "oracle", "--parallel", "2"],
                          capture_output=True, text=True)
    print(made.stdout[-4000:], made.stderr[-4000:])
    return 0 if made.returncode == 0 else 1


# The oracle names the rules c (faces) and d (trilinear).
def check_with_oracle(oracle, folder, rule="d"):
    rows = table()
    if not oracle.is_file():
        skip(f"no {oracle}: the oracle was not built")

    def check(row):
        mesh = mesh_of(folder, row)
        if not mesh.is_file():
            yield "no mesh: regression.topology_table or faces_table makes it"
            return
        run = subprocess.run([
            oracle, "volume", DATA / row["file"], "--iso", row["isovalue"], "--mesh", mesh,
            "--mesh-space", "index", "--rules", rule, "--no-distance", "--require", rule, "--json"
        ], capture_output=True, text=True)
        if run.returncode != 0:
            output = run.stdout[-2000:] if run.returncode == 1 else ""
            yield (f"the exit status of the oracle is {run.returncode}: {run.stderr.strip()} "
                   f"{output}")
            return
        verdict = json.loads(run.stdout)["mesh"]["report"]
        for key in ("edge_manifold", "vertex_manifold", "consistently_oriented"):
            if verdict[key] is not True:
                yield f"{key} is {verdict[key]}"
        for key in ("faces_with_repeated_vertices", "duplicate_faces"):
            if verdict[key] != 0:
                yield f"{verdict[key]} {key}"

    return report_all(rows, check)


def check_faces_with_oracle(oracle, folder):
    return check_with_oracle(oracle, folder, "c")


def distance(tool, oracle, folder):
    chosen = {("head_igea_sdf.nrrd", "0"), ("neuron_dendrite.nrrd", "127.5"),
              ("ct_head_rotated.nrrd", "500.5"), ("protein_iron.nhdr", "128")}
    rows = [row for row in table() if (row["file"], row["isovalue"]) in chosen]
    if not oracle.is_file():
        skip(f"no {oracle}: the oracle was not built")
    folder.mkdir(parents=True, exist_ok=True)

    def check(row):
        mesh, volume = folder / "distance.ply", DATA / row["file"]
        run = extract(tool, row, mesh, folder / "distance.json", "--coarse", "--max-radius", "3vx")
        ours = subprocess.run(
            [tool, "check", mesh, "--volume", volume, "--iso", row["isovalue"], "--json"],
            capture_output=True, text=True)
        theirs = subprocess.run([
            oracle, "volume", volume, "--iso", row["isovalue"], "--mesh", mesh, "--mesh-space",
            "index", "--rules", "d", "--json"
        ], capture_output=True, text=True)
        if run.returncode or ours.returncode or theirs.returncode:
            yield (f"exit statuses {run.returncode}, {ours.returncode}, {theirs.returncode}: "
                   f"{run.stderr}{ours.stderr}{theirs.stderr}")
            return
        ours = json.loads(ours.stdout)["distance"]
        theirs = json.loads(theirs.stdout)["mesh"]["distance"]["physical"]
        for side, oracle_side in (("mesh_to_surface", "mesh_to_isosurface_newton"),
                                  ("surface_to_mesh", "isosurface_to_mesh")):
            # Maxima are taken over different samples. The other values depend on the sampling
            # density where the surface bends.
            for key, name, tolerance in (("mean", "mean", 0.04), ("root_mean_square", "rms", 0.04),
                                         ("p99", "p99", 0.05), ("maximum", "max", 0.15)):
                a, b = ours[side]["world"][key], theirs[oracle_side][name]
                if abs(a - b) > tolerance * b:
                    yield f"{side} {key} is {a}, but {b} according to the oracle"
        a, b = ours["normal_degrees"]["mean"], theirs["normal_deviation_deg"]["mean"]
        if abs(a - b) > 0.03 * b:
            yield f"the mean deviation of the normals is {a} degrees, the oracle has {b}"

    return report_all(rows, check)


if __name__ == "__main__":
    mode, arguments = sys.argv[1], [pathlib.Path(a).resolve() for a in sys.argv[2:]]
    modes = {
        "topology": topology,
        "faces": faces,
        "nan": nan,
        "bytes": same_bytes,
        "build-oracle": build_oracle,
        "oracle": check_with_oracle,
        "oracle-faces": check_faces_with_oracle,
        "distance": distance,
    }
    sys.exit(modes[mode](*arguments))
