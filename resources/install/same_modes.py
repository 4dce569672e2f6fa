#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the members of Debian packages the mode that dpkg-deb gives them, 0644: CPack writes that of its own files, which the builder's umask decides.

    same_modes.py PACKAGE.deb...
"""
import sys

MAGIC = b"!<arch>\n"
HEADER, MODE, SIZE, END = 60, slice(40, 48), slice(48, 58), slice(58, 60)  # of a member in a common archive (ar)


def main():
    for name in sys.argv[1:]:
        with open(name, "r+b") as package:
            if package.read(len(MAGIC)) != MAGIC:
                sys.exit(f"{name}: no Debian package")
            at = len(MAGIC)
            while header := package.read(HEADER):
                if len(header) != HEADER or header[END] != b"`\n":
                    sys.exit(f"{name}: damaged at byte {at}")
                package.seek(at + MODE.start)
                package.write(b"100644".ljust(MODE.stop - MODE.start))
                size = int(header[SIZE])
                at += HEADER + size + size % 2
                package.seek(at)


main()
