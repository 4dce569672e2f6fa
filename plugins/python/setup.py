# SPDX-License-Identifier: BSD-3-Clause
"""pip install --no-build-isolation --no-deps .      in a virtual environment with system packages

CMake builds the libraries and the module; both go into the package, so that it needs nothing of the build folder. GLINT_BUILD=DIR takes a
build folder that exists, else build/python of the project is made."""
import os
import pathlib
import re
import shutil
import subprocess

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
VERSION = re.search(r'GLINT_VERSION "([0-9.]+)"', (ROOT / "core/base/version.h").read_text())[1]


class BuildByCMake(build_ext):
    def build_extension(self, ext):
        given = os.environ.get("GLINT_BUILD")
        build = pathlib.Path(given).resolve() if given else ROOT / "build/python"
        if not given:
            subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DGLINT_UNITY=ON",
                            "-DGLINT_GUI=OFF", "-DGLINT_TESTS=OFF", "-DGLINT_BENCH=OFF"], check=True)
        jobs = os.environ.get("GLINT_JOBS")
        subprocess.run(["cmake", "--build", build, "--target", "glint_python", *(["-j", jobs] if jobs else [])], check=True)
        staged = pathlib.Path(self.build_temp).resolve() / "staged"
        shutil.rmtree(staged, ignore_errors=True)
        subprocess.run(["cmake", "--install", build, "--component", "python_wheel", "--prefix", staged], check=True)
        module = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve()
        module.parent.mkdir(parents=True, exist_ok=True)
        for file in (staged / "glint").iterdir():
            # A package holds no links: each library once, under the name that programs ask for.
            if file.suffix == ".so" and not file.name.startswith("lib"):
                shutil.copy2(file, module)
            elif re.search(r"\.so\.\d+$", file.name):
                shutil.copy2(file, module.parent / file.name)


# What is built lies in the project's build folder, not among the sources.
work = ROOT / "build/python-package"
work.mkdir(parents=True, exist_ok=True)
setup(name="glint", version=VERSION, description="Specular highlights: lamps, virtual cameras, ellipsoids and predicted contours",
      license="BSD-3-Clause", python_requires=">=3.11", install_requires=["numpy"], packages=["glint"],
      package_data={"glint": ["*.pyi", "py.typed"]}, ext_modules=[Extension("glint._glint", [])],
      cmdclass={"build_ext": BuildByCMake},
      options={"build": {"build_base": str(work)}, "egg_info": {"egg_base": str(work)}, "bdist_wheel": {"dist_dir": str(work)}},
      zip_safe=False)
