# SPDX-License-Identifier: MIT
"""Has CMake build the Python module, the program and its plugins, and lays them into the package, whose folder is then
an installation of its own: palpate/{__init__.py, _palpate.so, bin, lib, share}."""

import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


class ByCMake(build_ext):
    def run(self):
        package = pathlib.Path(self.build_lib).resolve() / "palpate"
        build = os.environ.get("PALPATE_BUILD")  # of this Python, made already
        if build is None:
            build = str(ROOT / "build" / f"python{sys.version_info.major}.{sys.version_info.minor}")
            settings = ["-DCMAKE_BUILD_TYPE=Release", f"-DPython_EXECUTABLE={sys.executable}"]
            try:
                import pybind11
                settings.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
            except ImportError:
                pass  # Debian's pybind11-dev is found without
            cmake("-S", str(ROOT), "-B", build, "-G", "Ninja", *settings)
        cmake("--build", build, "--target", "palpate_complete")
        cmake("--install", build, "--prefix", str(package), "--component", "program")
        module = list(pathlib.Path(build, "python", "palpate").glob("_palpate.*"))
        if len(module) != 1:
            sys.exit("palpate: the module was not built: pybind11 or NumPy is missing (packages.txt, [python])")
        shutil.copy(module[0], package)


def cmake(*words):
    subprocess.run(["cmake", *words], check=True)


# The sources of the module are CMake's; an extension without any makes the package one of this machine.
setup(packages=["palpate"], package_dir={"palpate": "framework/python/palpate"},
      package_data={"palpate": ["__init__.pyi", "py.typed"]}, ext_modules=[Extension("palpate._palpate", [])],
      cmdclass={"build_ext": ByCMake})
