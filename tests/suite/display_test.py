#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The display of the test suite takes every connection. An X server without -noreset starts again when its last client leaves, and refuses
whoever connects meanwhile: two clients that come and go lost 123 of 800 connections so. Arguments: the folder of the sources."""
import ctypes
import ctypes.util
import shutil
import subprocess
import sys
import time

CONNECTIONS = 150  # of each client; without -noreset about one in seven fails, so that none of 300 would be a miracle


def connect():
    name = ctypes.util.find_library("X11")
    if not name:
        print("skipped: there is no libX11")
        return 77
    x11 = ctypes.CDLL(name)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    refused = 0
    for i in range(CONNECTIONS):
        display = x11.XOpenDisplay(None)
        if display:
            x11.XCloseDisplay(display)
        else:
            refused += 1
        time.sleep(0.002 * (i % 5))
    if refused:
        print(f"{refused} of {CONNECTIONS} connections were refused")
    return 1 if refused else 0


def main():
    if sys.argv[1] == "--connect":
        return connect()
    if not shutil.which("xvfb-run"):
        print("skipped: there is no xvfb-run")
        return 77
    two_clients = f'. "$0/resources/setup/common.sh"; on_virtual_display bash -c \'"$0" -B "$1" --connect & "$0" -B "$1" --connect; a=$?; wait $! || a=$?; exit $a\' "$1" "$2"'
    return subprocess.run(["bash", "-c", two_clients, sys.argv[1], sys.executable, __file__], check=False).returncode


sys.exit(main())
