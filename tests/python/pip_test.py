#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""pip_test.py SOURCE BUILD WORK: `pip install` of plugins/python into a new virtual environment with system packages, from a build tree that
exists, without a network. The installed module answers from another folder, with libraries of its own, and leaves the sources as they were."""
import os
import pathlib
import shutil
import subprocess
import sys


def run(*words, **more):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False, **more)
    if done.returncode:
        sys.exit(f"{words[0]} ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def main():
    source, build, work = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
    if not list(build.glob("python/glint/_glint.*.so")):
        print("skipped: the Python module was not built; it needs python3-dev, python3-numpy and pybind11-dev")
        sys.exit(77)
    missing = [p for p in ("python3-venv", "python3-pip", "python3-setuptools", "python3-wheel")
               if subprocess.run(["dpkg-query", "-W", p], capture_output=True, check=False).returncode]
    if missing:
        print("skipped: not installed: " + ", ".join(missing))
        sys.exit(77)
    before = sorted(p for p in (source / "plugins/python").rglob("*") if "__pycache__" not in p.parts)
    shutil.rmtree(work, ignore_errors=True)
    run(sys.executable, "-m", "venv", "--system-site-packages", work / "venv")
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "LD_LIBRARY_PATH")}
    run(work / "venv/bin/pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--disable-pip-version-check", source / "plugins/python",
        env={**environment, "GLINT_BUILD": str(build)})
    assert before == sorted(p for p in (source / "plugins/python").rglob("*") if "__pycache__" not in p.parts), "pip left files among the sources"
    said = run(work / "venv/bin/python", "-c", f"""
import glint, pathlib
print(glint.__file__)
inspection = glint.inspect(glint.open({str(source / 'sessions/plane/plane.glint')!r}), ["dual"])
assert inspection.summary("dual")["predicted"] == 2
glint.write_labels(inspection, {str(work / 'labels')!r}, "coco,masks")  # pictures need the library that nothing links
print(*sorted({{line.split()[-1] for line in open("/proc/self/maps") if "libglint" in line}}))
assert (pathlib.Path(glint.__file__).parent / "py.typed").exists()
""", cwd="/", env=environment).split()
    outside = [path for path in said if not pathlib.Path(path).is_relative_to(work / "venv")]
    assert not outside and len(said) >= 4 and any("libglint-codecs" in path for path in said), f"not of the virtual environment: {outside}; {said}"
    print(*said, sep="\n")


main()
