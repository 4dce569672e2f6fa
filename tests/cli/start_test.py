# SPDX-License-Identifier: BSD-3-Clause
"""Which libraries a start loads, and what the program says when the one of the codecs is missing.

start_test.py GLINT LIBRARIES SESSIONS
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def run(*command, **environment):
    return subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                          env={**os.environ, **environment})


def loaded(*command):
    """Names of the libraries that the loader reads for it (ld.so(8), LD_DEBUG=files)."""
    done = run(*command, LD_DEBUG="files")
    assert done.returncode == 0, done.stderr[-2000:]
    return set(re.findall(r"calling init: \S*/([^/\s]+)\n", done.stderr))


def main():
    glint, libraries, sessions = (pathlib.Path(word) for word in sys.argv[1:])
    plane = sessions / "lessons/plane/plane.glint"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        # Frames of this session are PNG files.
        for command in ([glint, "--version"], [glint, "detect", plane], [glint, "evaluate", plane, "--models", "dual"]):
            names = loaded(*command)
            assert any(n.startswith("libglint-core") for n in names), names
            assert not [n for n in names if re.match("libglint-codecs|libopencv_(imgcodecs|videoio)|libgdal|libavcodec", n)], (command, names)
        names = loaded(glint, "detect", plane, "--out", folder / "written")
        assert any(n.startswith("libglint-codecs") for n in names), names

        # The library is missing: what needs none of it goes on, the rest is refused in one line that names the file.
        for part in ("bin", "lib", "theirs"):
            (folder / part).mkdir()
        shutil.copy2(glint, folder / "bin")
        for library in libraries.glob("libglint-*.so.0"):
            shutil.copy2(library, folder / ("lib" if "codecs" in library.name else "theirs"))  # bin/../lib is not asked
        alone, path = folder / "bin/glint", {"LD_LIBRARY_PATH": str(folder / "theirs")}
        assert run(alone, "detect", plane, **path).returncode == 0
        assert run(glint, "synth", sessions / "lessons/plane/spec.json", "--out", folder / "floats").returncode == 0
        assert list((folder / "floats").rglob("*.tiff"))
        written = folder / "refused"
        for command in (["detect", plane, "--out", written], ["detect", folder / "floats/scene.json"]):
            refused = run(alone, *command, **path)
            assert refused.returncode == 2 and refused.stderr.count("\n") == 1, refused
            assert refused.stderr.startswith(f"glint: {folder}/theirs/libglint-codecs.so.0: cannot be loaded: "), refused
            assert refused.stderr.count("libglint-codecs") == 1, refused
            assert refused.stderr.endswith("; without it Glint writes no images or videos, and reads only PNG and JPEG\n"), refused
        assert not written.exists()
        # One of another version is refused, too.
        (folder / "other.c").write_text('const char* table[8] = {"0.0.9"};\nconst void* glint_codecs(void) { return table; }\n')
        if shutil.which("cc"):
            assert run("cc", "-shared", "-fPIC", folder / "other.c", "-o", folder / "theirs/libglint-codecs.so.0").returncode == 0
            refused = run(alone, "detect", plane, "--out", written, **path)
            assert refused.returncode == 2 and "libglint-codecs.so.0: is of Glint 0.0.9, not of " in refused.stderr, refused


main()
