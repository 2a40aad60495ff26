# SPDX-License-Identifier: Apache-2.0
"""Builds the extension isoatlas._core and the command-line tool with CMake for `pip install .`.

Everything else is in pyproject.toml. The environment variable CMAKE_ARGS is added to the arguments
of CMake; with -DISOATLAS_BUILD_TOOL=OFF in it, only the extension is built.
CMAKE_BUILD_PARALLEL_LEVEL is the number of compilers that run at a time. ISOATLAS_CMAKE_FOLDER is
the build folder of CMake, which a later build can reuse.
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


def version():
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"project\(isoatlas VERSION ([\d.]+)", text).group(1)


def pybind11_arguments():
    """The option with the folder of pip's pybind11; CMake finds the distribution's without it."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


def copy_files(source, target, names):
    for name in names:
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source / name, target / name)


# The volumes of isoatlas.examples.
SAMPLES = ("LICENSE-samples.txt", "embryo.nrrd", "protein_iron.nhdr", "protein_iron.raw")
# The tool, what it loads to draw pictures, and the module of 3D Slicer.
TOOL_FILES = ("bin/isoatlas", "lib/isoatlas/isoatlas_picture.so", "slicer/IsoAtlas")


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        folder = os.environ.get("ISOATLAS_CMAKE_FOLDER") or self.build_temp
        folder = pathlib.Path(folder).resolve()
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        is_configured = (folder / "CMakeCache.txt").exists()
        options = ["-G", "Ninja"] if shutil.which("ninja") and not is_configured else []
        options += ["-DCMAKE_BUILD_TYPE=Release", "-DISOATLAS_BUILD_PYTHON=ON"]
        options += ["-DISOATLAS_BUILD_TOOL=ON", "-DISOATLAS_BUILD_VTK_FILTER=OFF"]
        options += ["-DISOATLAS_BUILD_TESTS=OFF", "-DISOATLAS_INSTALL=OFF"]
        options += ["-DCMAKE_INSTALL_BINDIR=bin", "-DCMAKE_INSTALL_LIBDIR=lib"]
        options += ["-DISOATLAS_UNITY_BUILD=ON"]
        options += ["-DISOATLAS_WARNINGS_AS_ERRORS=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
        options += pybind11_arguments() + shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run(["cmake", "-S", ROOT, "-B", folder, *options], check=True)
        cache = (folder / "CMakeCache.txt").read_text()
        has_tool = re.search(r"^ISOATLAS_BUILD_TOOL:BOOL=(ON|1|TRUE|YES)$", cache, re.M | re.I)
        targets = ["isoatlas_python", *(["isoatlas_tool"] if has_tool else [])]
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        build = ["cmake", "--build", folder, "--target", *targets, "--parallel", jobs]
        subprocess.run(build, check=True)
        copy_files(folder / "python" / "isoatlas", target.parent, [target.name])
        copy_files(ROOT / "samples", target.parent / "samples", SAMPLES)
        if has_tool:
            copy_files(folder, target.parent / "_tool", TOOL_FILES)


setup(
    version=version(),
    ext_modules=[Extension("isoatlas._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
