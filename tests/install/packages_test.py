#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the Debian packages twice from one build: the same bytes. Then: what each must and must not contain, lintian without errors, and the
programs of the unpacked packages run a session, with the packages' own libraries."""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
HOLDS = {  # package -> patterns of files that it must contain
    "libglint0": [rf"lib/.*/libglint-{library}\.so\.0\.\d" for library in ("codecs", "core", "io")],
    "libglint-dev": [r"include/glint-[\d.]+/core/pipeline/inspection\.h", r"cmake/Glint/GlintConfig\.cmake", r"libglint-core\.so$", r"libglint-viz\.a$",
                     r"share/glint/examples/cpp/session_errors\.cpp", r"share/glint/examples/plugins/example/example\.cpp"],
    "glint": [r"bin/glint$", r"man1/glint\.1\.gz", r"man1/glint-evaluate\.1\.gz", r"bash-completion/completions/glint$", r"zsh/vendor-completions/_glint$",
              r"fish/vendor_completions\.d/glint\.fish$", r"share/glint/sessions/vase/vase\.glint"],
    "glint-inspector": [r"bin/glint-inspector$", r"man1/glint-inspector\.1\.gz", r"applications/glint-inspector\.desktop", r"mime/packages/glint\.xml",
                        r"metainfo/glint-inspector\.metainfo\.xml", r"icons/hicolor/scalable/apps/glint\.svg"],
}
PYTHON = [r"dist-packages/glint/_glint\..*\.so$", r"dist-packages/glint/__init__\.py$", r"dist-packages/glint/py\.typed$"]
PARAVIEW = [r"share/glint/paraview/glint_paraview\.py$", r"share/glint/paraview/glint_paraview_blocks\.py$", r"share/glint/paraview/glint_paraview_vtk\.py$",
            r"share/glint/paraview/setup_paraview\.py$"]
EVERY = [r"share/doc/{name}/copyright", r"share/doc/{name}/changelog\.gz"]


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}")
    return done.stdout


def packed(build, folder, umask):
    environment = {key: value for key, value in os.environ.items() if key != "SOURCE_DATE_EPOCH"}
    run("cpack", "--config", build / "CPackConfig.cmake", "-B", folder, env=environment, preexec_fn=lambda: os.umask(umask))
    return sorted(folder.glob("*.deb"))


def check_contents(package, files):
    name = package.name.split("_")[0]
    for pattern in HOLDS.get(name, []) + [p.format(name=re.escape(name)) for p in EVERY]:
        if not any(re.search(pattern, file) for file in files):
            sys.exit(f"{name} has no file like {pattern}")
    outside = [file for file in files if not file.startswith("./usr/")]
    if outside:
        sys.exit(f"{name} has files outside of usr: {outside}")


def check_lintian(packages):
    if not shutil.which("lintian"):
        print("lintian is not installed: not checked")
        return
    told = run("lintian", "--allow-root", "--fail-on", "error", "--tag-display-limit", "0", *packages)
    print(told.strip() or "lintian: nothing")


def check_use(packages, folder):
    root = folder / "root"
    for package in packages:
        run("dpkg-deb", "-x", package, root)
    libraries = next(root.glob("usr/lib/*/libglint-core.so.0")).parent
    environment = dict(os.environ, LD_LIBRARY_PATH=str(libraries))
    loaded = run("ldd", root / "usr/bin/glint", env=environment)
    if str(libraries / "libglint-core.so.0") not in loaded:
        sys.exit("the program does not use the package's library")
    told = run(root / "usr/bin/glint", "replay", root / "usr/share/glint/sessions/plane-to-cylinder/plane-to-cylinder.glint", env=environment)
    print(told.strip().splitlines()[-1])
    # Pictures need the library that nothing links.
    run(root / "usr/bin/glint", "detect", root / "usr/share/glint/sessions/plane/plane.glint", "--out", folder / "pictures", env=environment)
    if not list((folder / "pictures").rglob("*.png")):
        sys.exit("the program of the packages writes no pictures")
    if shutil.which("desktop-file-validate"):
        run("desktop-file-validate", root / "usr/share/applications/glint-inspector.desktop")
    if shutil.which("appstreamcli"):
        run("appstreamcli", "validate", "--no-net", root / "usr/share/metainfo/glint-inspector.metainfo.xml")
    modules = root / "usr/lib/python3/dist-packages"
    if modules.is_dir() and shutil.which("python3"):
        told = run("/usr/bin/python3", "-c", "import glint; print('python3 imports glint', glint.__version__, 'from', glint.__file__)",
                   env=dict(environment, PYTHONPATH=str(modules), PYTHONDONTWRITEBYTECODE="1"))
        if str(modules) not in told:
            sys.exit(f"python3 imports another glint: {told}")
        print("python3 imports the package's module")
    setup = root / "usr/share/glint/paraview/setup_paraview.py"
    if setup.exists():  # mends the loader in the user's own folder alone, and takes it back
        home = folder / "home"
        home.mkdir()
        for step in "--mend-loader", "--undo":
            run("/usr/bin/python3", setup, step, env=dict(environment, HOME=str(home)))
            if (step == "--undo") == bool(list(home.rglob("glint_paraview_loader.pth"))):
                sys.exit(f"setup_paraview.py {step}: did nothing")
        print("the package mends ParaView's loader, and takes it back")
    # Double click: the system's table leads from *.glint to the inspector.
    if shutil.which("update-mime-database"):
        run("update-mime-database", root / "usr/share/mime")
        if "application/x-glint-session:*.glint" not in (root / "usr/share/mime/globs").read_text():
            sys.exit("*.glint has no MIME type")
    if "MimeType=application/x-glint-session;" not in (root / "usr/share/applications/glint-inspector.desktop").read_text():
        sys.exit("the inspector does not open sessions")
    # The completion offers commands, options and the words of an option.
    script = 'source "$1"; COMP_WORDS=(glint evaluate --source ""); COMP_CWORD=3; _glint; echo "${COMPREPLY[@]}"'
    words = run("bash", "-c", script, "bash", root / "usr/share/bash-completion/completions/glint").split()
    if words != ["radiance", "image"]:
        sys.exit(f"completion of --source: {words}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    if not shutil.which("dpkg-shlibdeps"):
        print("skipped: no dpkg-shlibdeps (package dpkg-dev)")
        sys.exit(SKIPPED)
    if (options.build / "python/glint").is_dir():  # the module is part of this build
        HOLDS["python3-glint"] = PYTHON
        HOLDS["glint-paraview"] = PARAVIEW
    folder = pathlib.Path(tempfile.mkdtemp(prefix="glint_packages_"))
    try:
        packages = packed(options.build.resolve(), folder / "first", 0o022)
        again = packed(options.build.resolve(), folder / "second", 0o077)  # of a builder who keeps what he writes to himself
        if not set(HOLDS) <= {p.name.split("_")[0] for p in packages}:
            sys.exit(f"packages are missing: {[p.name for p in packages]}")
        for one, other in zip(packages, again, strict=True):
            if one.read_bytes() != other.read_bytes():
                sys.exit(f"{one.name}: made twice, the bytes differ")
            files = [line.split()[5] for line in run("dpkg-deb", "-c", one).splitlines() if not line.startswith("d")]
            check_contents(one, files)
            print(f"{one.name}: {len(files)} files, {one.stat().st_size / 1e6:.1f} MB, the same bytes twice")
        check_lintian(packages)
        check_use(packages, folder)
    finally:
        shutil.rmtree(folder)


main()
