#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that the DEPENDS line of each module allows its #includes, and that there is no cycle.

Modules are the folders of src/. Each public header (isoatlas/...) belongs to a module, see PUBLIC.
That module, the modules that depend on it, applications, tests and benchmarks may include it.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SRC = ROOT / "src"

# The module to which each public header belongs.
PUBLIC = {
    "error.h": "core",
    "run_control.h": "core",
    "version.h": "core",
    "volume.h": "core",
    "component_extents.h": "core",
    "mesh.h": "core",
    "certificate.h": "core",
    "hierarchy.h": "core",
    "measure.h": "core",
    "refine.h": "core",
    "length_unit.h": "core",
    "field.h": "core",
    "normals.h": "core",
    "export.h": "core",
    "volume_source.h": "core",
    "json.h": "report",
    "self_intersections.h": "geometry",
    "options.h": "levels",
    "report.h": "levels",
    "extract.h": "api",
    "blocks.h": "api",
    "mask_field.h": "mask",
    "block_file.h": "stored",
    "isoatlas.h": "api",
    "text_file.h": "files",
    "volume_file.h": "volume_files",
    "volume_reader.h": "volume_files",
    "mesh_file.h": "mesh_files",
    "neuroglancer.h": "mesh_files",
    "vtkIsoAtlas.h": "vtk_filter",
}
# Headers of libraries, and the modules that may include them.
PRIVATE_LIBRARIES = {
    r"tbb/": {"core"},
    r"itk": set(),
    r"(dcmtk|charls|openjpeg|nifti|tiff|png|blosc|zstd|hdf5)": {"volume_files"},
    r"openssl/": {"files"},
    r"pugixml": {"volume_files", "mesh_files"},
    r"(tiny_gltf|zip\.h|draco/)": {"mesh_files"},
    r"vtk[A-Z]": {"drawing", "vtk_filter"},
    r"(expat|lzma)\.h": {"files"},
    r"lz4\.h": {"files", "volume_files"},
    r"X11/": {"drawing"},
    r"meshoptimizer": {"page"},
    r"nlohmann/": {"volume_files", "mesh_files", "report", "page"},
    r"CGAL/": {"geometry"},
    r"boost/crc": {"volume_files"},
    r"boost/multiprecision": {"core"},
    r"CLI/": set(),
}


def depends():
    """The modules named by the DEPENDS line of each module."""
    out = {}
    for path in sorted(SRC.glob("*/CMakeLists.txt")):
        text = path.read_text()
        match = re.search(r"isoatlas_module\((\w+)(.*?)\)", text, re.S)
        if not match:
            continue
        listed = re.search(r"DEPENDS([\w\s]*?)(LINK|\)|$)", match.group(2) + ")", re.S)
        out[match.group(1)] = set(listed.group(1).split()) if listed else set()
    return out


def closure(module, graph, seen=()):
    """The module with all modules that it depends on, directly or indirectly."""
    if module in seen:
        raise SystemExit(f"cycle between modules: {' -> '.join([*seen, module])}")
    out = {module}
    for other in graph.get(module, ()):
        out |= closure(other, graph, (*seen, module))
    return out


def main():
    graph = depends()
    problems = []
    for module, others in graph.items():
        for other in sorted(others - graph.keys()):
            where = f"src/{module}/CMakeLists.txt"
            problems.append(f"{where}: DEPENDS names the unknown module {other}")
    reach = {module: closure(module, graph) for module in graph}
    checked = 0
    for module in graph:
        for path in sorted((SRC / module).iterdir()):
            if path.suffix not in (".h", ".cpp", ".inl"):
                continue
            for number, line in enumerate(path.read_text().splitlines(), 1):
                match = re.match(r'\s*#\s*include\s*["<]([^">]+)[">]', line)
                if not match:
                    continue
                checked += 1
                include = match.group(1)
                where = f"{path.relative_to(ROOT)}:{number}"
                top, _, rest = include.partition("/")
                if top == "isoatlas":
                    owner = PUBLIC.get(rest)
                    if owner is None:
                        problems.append(
                            f"{where}: the public header {include} has no module, "
                            "add it to PUBLIC of scripts/check_layers.py"
                        )
                    elif owner not in reach[module]:
                        problems.append(
                            f"{where}: {module} may not include {include} of module {owner}"
                        )
                elif rest and (SRC / top).is_dir():
                    if top not in reach[module]:
                        names = " ".join(sorted(graph[module])) or "nothing"
                        problems.append(
                            f"{where}: {module} may not include {include}; "
                            f"DEPENDS of {module}: {names}"
                        )
                for pattern, allowed in PRIVATE_LIBRARIES.items():
                    if re.match(pattern, include) and module not in allowed:
                        names = ", ".join(sorted(allowed)) or "apps"
                        problems.append(f"{where}: only {names} may include {include}")
    for problem in problems:
        print(problem)
    print(f"{checked} includes in {len(graph)} modules, {len(problems)} problems")
    return 1 if problems or checked == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
