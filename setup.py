# SPDX-License-Identifier: Apache-2.0
"""Builds the extension isoatlas._core with CMake for `pip install .`.

Everything else is in pyproject.toml. The environment variable CMAKE_ARGS is added to the arguments
of CMake; CMAKE_BUILD_PARALLEL_LEVEL is the number of compilers that run at a time.
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


def copy_samples(folder):
    """The volumes of isoatlas.examples."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("LICENSE-samples.txt", "embryo.nrrd", "protein_iron.nhdr", "protein_iron.raw"):
        shutil.copy2(ROOT / "samples" / name, folder / name)


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        folder = pathlib.Path(self.build_temp).resolve()
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        is_configured = (folder / "CMakeCache.txt").exists()
        options = ["-G", "Ninja"] if shutil.which("ninja") and not is_configured else []
        options += ["-DCMAKE_BUILD_TYPE=Release", "-DISOATLAS_BUILD_PYTHON=ON"]
        options += ["-DISOATLAS_BUILD_TOOL=OFF", "-DISOATLAS_BUILD_TESTS=OFF"]
        options += ["-DISOATLAS_UNITY_BUILD=ON"]
        options += ["-DISOATLAS_WARNINGS_AS_ERRORS=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
        options += pybind11_arguments() + shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run(["cmake", "-S", ROOT, "-B", folder, *options], check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        build = ["cmake", "--build", folder, "--target", "isoatlas_python", "--parallel", jobs]
        subprocess.run(build, check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(folder / "python" / "isoatlas" / target.name, target)
        copy_samples(target.parent / "samples")


setup(
    version=version(),
    ext_modules=[Extension("isoatlas._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
