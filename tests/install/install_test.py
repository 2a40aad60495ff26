#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Installs the build into an empty folder and builds programs against it, as other projects do."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ.get("ISOATLAS_BUILD", ROOT / "build/release"))
CMAKE = os.environ.get("CMAKE", "cmake")
CXX = os.environ.get("CXX", "g++")
CONSUMER = ROOT / "examples/consumer"
EXPECTED = "296 triangles, genus 0\n1422 triangles, genus 1\n"


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          **options)
    if done.returncode != 0:
        raise AssertionError(
            f"{' '.join(map(str, command))}: "
            f"{done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
        )
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.top = pathlib.Path(cls.folder.name)
        cls.prefix = cls.top / "prefix"
        run(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        cls.libraries = next(path.parent for path in cls.prefix.rglob("libisoatlas.so"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def build(self, name, cmake_text, source):
        folder = self.top / name
        folder.mkdir()
        (folder / "CMakeLists.txt").write_text(cmake_text)
        (folder / "main.cpp").write_text(source)
        run(CMAKE, "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={CXX}")
        run(CMAKE, "--build", folder / "build")
        return folder / "build" / "main"

    def test_find_package(self):
        build = self.top / "consumer"
        run(CMAKE, "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={CXX}")
        run(CMAKE, "--build", build)
        self.assertEqual(run(build / "consumer"), EXPECTED)

    def test_static_library(self):
        cmake_text = ("cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
                      "find_package(isoatlas CONFIG REQUIRED)\n"
                      "add_executable(main main.cpp)\n"
                      "target_link_libraries(main PRIVATE isoatlas::static)\n")
        main = self.build("static", cmake_text, (CONSUMER / "main.cpp").read_text())
        self.assertEqual(run(main), EXPECTED)
        self.assertNotIn("libisoatlas", run("ldd", main))

    def test_component_io(self):
        if not list(self.prefix.rglob("libisoatlas_io.so")):
            self.skipTest("built without ISOATLAS_BUILD_IO")
        main = self.build(
            "io", "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
            "find_package(isoatlas CONFIG REQUIRED COMPONENTS core io)\n"
            "add_executable(main main.cpp)\ntarget_link_libraries(main PRIVATE isoatlas::io)\n",
            r"""
#include <isoatlas/io.h>
#include <isoatlas/isoatlas.h>
#include <cstring>
#include <iostream>
int main(int, char** argv) {
  const isoatlas::Volume volume = isoatlas::read_volume(argv[1]);
  isoatlas::write_mesh(isoatlas::extract(volume, 100).mesh(), argv[2]);
  std::cout << isoatlas::mesh_topology(isoatlas::read_mesh(argv[2])).genus() << '\n';
  std::cout << isoatlas::to_json(isoatlas::extract(volume, 100).report).substr(0, 1) << '\n';
  try {
    isoatlas::read_volume("missing.nrrd");  // an error thrown by the library
  } catch (const isoatlas::Error& error) {
    std::cout << (error.code() == isoatlas::ErrorCode::bad_file) << '\n';
  }
}
""")
        self.assertEqual(run(main, ROOT / "samples/protein_iron.nhdr", self.top / "mesh.ply"),
                         "8\n{\n1\n")

    def test_unknown_component_is_refused(self):
        folder = self.top / "unknown"
        folder.mkdir()
        (folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
            "find_package(isoatlas CONFIG REQUIRED COMPONENTS nothing)\n")
        done = subprocess.run(
            [CMAKE, "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"],
            capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("nothing", done.stderr)

    def test_pkg_config(self):
        environment = {
            **os.environ, "PKG_CONFIG_PATH": str(self.libraries / "pkgconfig"),
            "LD_LIBRARY_PATH": str(self.libraries)
        }
        flags = run("pkg-config", "--cflags", "--libs", "isoatlas", env=environment).split()
        program = self.top / "by_pkg_config"
        run(CXX, "-std=c++20", CONSUMER / "main.cpp", *flags, "-o", program)
        self.assertEqual(run(program, env=environment), EXPECTED)

    def test_no_trace_of_the_source_folder(self):
        for path in [
                *self.prefix.rglob("*.cmake"), *self.prefix.rglob("*.pc"), *self.prefix.rglob("*.h")
        ]:
            text = path.read_text()
            self.assertNotIn(str(ROOT), text, path)
            self.assertNotIn(str(BUILD), text, path)
        for header in self.prefix.rglob("*.h"):
            self.assertNotIn("detail/", header.read_text(), header)

    def test_only_public_names_are_exported(self):
        for library in self.libraries.glob("libisoatlas*.so"):
            names = run("nm", "-DC", "--defined-only", library)
            self.assertNotIn("isoatlas::detail::", names, library)
        self.assertIn("SONAME", run("readelf", "-d", self.libraries / "libisoatlas.so"))
        self.assertRegex(run("readelf", "-d", self.libraries / "libisoatlas.so"),
                         r"libisoatlas\.so\.\d+\.\d+")

    def test_manual_pages_and_completions(self):
        if not (self.prefix / "bin/isoatlas").exists():
            self.skipTest("built without ISOATLAS_BUILD_TOOL")
        self.assertIn("isoatlas \\- isosurfaces",
                      (self.prefix / "share/man/man1/isoatlas.1").read_text())
        page = (self.prefix / "share/man/man1/isoatlas-extract.1").read_text()
        for text in (".SH NAME\nisoatlas\\-extract \\- ", ".SH EXIT STATUS\n",
                     "\\-\\-max\\-distance"):
            self.assertIn(text, page)
        script = self.prefix / "share/bash-completion/completions/isoatlas"

        def complete(*words):
            """The completions of the last word, as the shell prints them."""
            line = " ".join(words)
            return run("bash", "-c", f'source {script}; COMP_WORDS=({line}); '
                       f'COMP_CWORD={len(words) - 1}; _isoatlas; echo "${{COMPREPLY[@]}}"')

        self.assertEqual(complete("isoatlas", "extract", "--pla"), "--placement\n")
        self.assertEqual(complete("isoatlas", "extract", "--placement", "b"), "balanced\n")
        self.assertEqual(complete("isoatlas", "ex"), "extract\n")


@unittest.skipUnless(os.environ.get("ISOATLAS_TEST_SUBFOLDER"),
                     "builds the library again: set ISOATLAS_TEST_SUBFOLDER=1")
class Subfolder(unittest.TestCase):
    """add_subdirectory builds the core without tests and file readers, in the given build type."""

    def test_add_subdirectory(self):
        with tempfile.TemporaryDirectory() as folder:
            top = pathlib.Path(folder)
            (top / "CMakeLists.txt").write_text(
                "cmake_minimum_required(VERSION 3.16)\nproject(main CXX)\n"
                f"add_subdirectory({ROOT} isoatlas)\n"
                f"add_executable(main {CONSUMER}/main.cpp)\n"
                "target_link_libraries(main PRIVATE isoatlas::isoatlas)\n"
                "get_target_property(type isoatlas_static TYPE)\n"
                "message(STATUS \"type=${type} build=[${CMAKE_BUILD_TYPE}]\")\n")
            printed = run(CMAKE, "-S", top, "-B", top / "build", f"-DCMAKE_CXX_COMPILER={CXX}",
                          "-DISOATLAS_UNITY_BUILD=ON", "-G", "Ninja")
            self.assertIn("type=STATIC_LIBRARY build=[]", printed)
            self.assertNotIn("VTK", printed)
            run(CMAKE, "--build", top / "build", "--target", "main")
            self.assertEqual(run(top / "build/main"), EXPECTED)


@unittest.skipUnless(os.environ.get("ISOATLAS_TEST_CLANG"),
                     "builds the library again: set ISOATLAS_TEST_CLANG=1")
class Clang(unittest.TestCase):
    """The core builds without a warning with clang 14 and libc++, and gives the same meshes."""

    def test_core_and_examples(self):
        compiler = shutil.which("clang++-14")
        if not compiler:
            self.skipTest("clang++-14 is not installed")
        with tempfile.TemporaryDirectory() as folder:
            top = pathlib.Path(folder)
            run(CMAKE, "-S", ROOT, "-B", top / "build", "-G", "Ninja",
                "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_CXX_COMPILER={compiler}",
                "-DCMAKE_CXX_FLAGS=-stdlib=libc++", "-DISOATLAS_WARNINGS_AS_ERRORS=ON",
                "-DISOATLAS_UNITY_BUILD=ON", "-DISOATLAS_BUILD_IO=OFF", "-DISOATLAS_BUILD_TOOL=OFF",
                "-DISOATLAS_BUILD_TESTS=OFF", "-DISOATLAS_BUILD_PAGE=OFF")
            run(CMAKE, "--build", top / "build")
            self.assertIn("libc++", run("ldd", top / "build/src/libisoatlas.so"))
            for example in ("consumer", "implicit_field", "edge_length_field", "custom_metric"):
                run(compiler, "-std=c++20", "-stdlib=libc++", f"-I{ROOT}/include",
                    f"-I{top}/build/include", ROOT / "examples" / example / "main.cpp",
                    f"-L{top}/build/src", "-lisoatlas", f"-Wl,-rpath,{top}/build/src", "-o",
                    top / example)
                self.assertEqual(run(top / example), run(BUILD / "bin" / f"example_{example}"))
            self.assertEqual(run(top / "consumer"), EXPECTED)


if __name__ == "__main__":
    unittest.main()
