#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""plugins/blender/make_zip.py FILE.zip: the add-on as Blender installs it. The same sources give the same bytes."""
import os
import pathlib
import sys
import zipfile

FOLDER = pathlib.Path(__file__).resolve().parent / "glint_blender"
TIME = (1980, 1, 1, 0, 0, 0)  # the first that a zip can state


def main():
    target = pathlib.Path(sys.argv[1])
    unfinished = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as file:
            for path in sorted(FOLDER.iterdir()):
                if path.suffix in (".py", ".toml"):
                    entry = zipfile.ZipInfo(f"{FOLDER.name}/{path.name}", TIME)
                    entry.external_attr = 0o644 << 16
                    entry.compress_type = zipfile.ZIP_DEFLATED
                    file.writestr(entry, path.read_bytes())
        os.replace(unfinished, target)
    finally:
        unfinished.unlink(missing_ok=True)
    print(target)


if len(sys.argv) != 2:
    sys.exit(__doc__)
main()
