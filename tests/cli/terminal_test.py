# SPDX-License-Identifier: BSD-3-Clause
"""What a person sees on a terminal and a script never: colours, "wrote FILE".

terminal_test.py GLINT SESSIONS
"""
import os
import pathlib
import pty
import subprocess
import sys
import tempfile


def on_terminal(command, **environment):
    """What the command writes to a terminal that is its standard error."""
    ours, theirs = pty.openpty()
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=theirs, check=False, env={**os.environ, "TERM": "xterm", "NO_COLOR": "", **environment})
    os.close(theirs)
    told = b""
    try:
        while part := os.read(ours, 4096):
            told += part
    except OSError:  # the end of a terminal
        pass
    os.close(ours)
    return done.returncode, told.decode()


def main():
    glint, sessions = sys.argv[1], pathlib.Path(sys.argv[2])
    code, told = on_terminal([glint, "evaluat"])
    assert code == 2 and told.startswith("\x1b[1;31mglint:\x1b[0m 'evaluat' is not a command; did you mean 'evaluate'?"), told
    for environment in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        code, told = on_terminal([glint, "evaluat"], **environment)
        assert code == 2 and "\x1b" not in told and told.startswith("glint: 'evaluat'"), (environment, told)
    with tempfile.TemporaryDirectory() as name:
        session, report = sessions / "lessons/plane/plane.glint", pathlib.Path(name) / "report.html"
        command = [glint, "evaluate", session, "--models", "dual", "--html", report]
        code, told = on_terminal(command)
        assert code == 0 and f"glint: wrote {report}" in told and report.is_file(), told
        piped = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=True)
        assert piped.stderr == "" and "\x1b" not in piped.stdout, piped
        first, head = piped.stdout.splitlines()[:2]
        assert first == "contour errors of held-out frames (2); trained on 4 of 6 frames (0000-0003); % of a highlight's diameter", first
        row = piped.stdout.splitlines()[2].split()
        assert head.split()[0] == "model" and row[0] == "dual"
        assert all(len(number.split(".")[1]) == 3 for number in row[2:7]), row
        wrong = subprocess.run([glint, "evaluat"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        assert wrong.stderr.startswith("glint: ") and "\x1b" not in wrong.stderr, wrong


main()
