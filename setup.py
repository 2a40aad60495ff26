# SPDX-License-Identifier: Apache-2.0
"""`pip install .`: the extension isoatlas._core is built by CMake. Everything else is in pyproject.toml.

CMAKE_ARGS is added to the arguments of CMake, CMAKE_BUILD_PARALLEL_LEVEL says how many compilers run at a time.
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
    return re.search(r"project\(isoatlas VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


def pybind11_arguments():
    """The distribution's package is where CMake looks; a package of pip's says where it is."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        folder = pathlib.Path(self.build_temp).resolve()
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        generator = ["-G", "Ninja"] if shutil.which("ninja") and not (folder / "CMakeCache.txt").exists() else []
        subprocess.run(
            [
                "cmake", "-S", ROOT, "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DISOATLAS_BUILD_PYTHON=ON",
                "-DISOATLAS_BUILD_TOOL=OFF", "-DISOATLAS_BUILD_TESTS=OFF", "-DISOATLAS_WARNINGS_AS_ERRORS=OFF",
                f"-DPython_EXECUTABLE={sys.executable}", *pybind11_arguments(), *shlex.split(os.environ.get("CMAKE_ARGS", "")),
            ],
            check=True,
        )
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run(["cmake", "--build", folder, "--target", "isoatlas_python", "--parallel", jobs], check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(folder / "python" / "isoatlas" / target.name, target)


setup(version=version(), ext_modules=[Extension("isoatlas._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
