# SPDX-License-Identifier: BSD-3-Clause
"""The program `glint`: where it is, whether it is new enough, and one command of it with progress and an end on request. No bpy here."""
import os
import re
import shutil
import signal
import subprocess
import threading
import time

from .failures import InputError

OLDEST = (0, 1, 0)
PATIENCE = 3.0  # s: `glint` ends 0.2 s after it is asked to; what does not is killed
KEPT = 65536  # bytes of output that are kept for messages


def find(path=""):
    """Absolute path of the program. path: what the preferences say, "" for the one on PATH."""
    if path:
        if os.path.isdir(path):
            path = os.path.join(path, "glint")
        if not os.path.isfile(path) or not os.access(path, os.X_OK):
            raise InputError(path, "", "is no program; name the program glint in the add-on's preferences")
        return os.path.abspath(path)
    found = shutil.which("glint")
    if not found:
        raise InputError("glint", "", "was not found on PATH; name the program in the add-on's preferences")
    return found


def version_of(program):
    """The version as three numbers; refuses a program that is another one, or too old."""
    try:
        done = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL,
                              check=False)
    except (OSError, subprocess.TimeoutExpired) as e:
        raise InputError(program, "", f"cannot be run: {e}") from None
    found = re.fullmatch(r"glint (\d+)\.(\d+)\.(\d+)\S*", done.stdout.strip())
    if done.returncode != 0 or not found:
        raise InputError(program, "", "does not answer `--version` as glint does; it is another program")
    version = tuple(int(n) for n in found.groups())
    if version < OLDEST:
        raise InputError(program, "", f"is glint {'.'.join(map(str, version))}; this add-on needs {'.'.join(map(str, OLDEST))} or newer")
    return version


class Job:
    """One command that runs beside Blender. poll() says whether it has ended; stage and part say how far it is; cancel() ends it.

    `glint` shows progress on a terminal only, so its standard error is a pseudo-terminal where the system has them."""

    def __init__(self, command, folder=None):
        self.stage, self.part, self.messages = "", None, []
        self.output = b""
        self.cancelled_at = None
        self.lock = threading.Lock()
        own_end = theirs = None
        try:
            import pty
            own_end, theirs = pty.openpty()
        except (ImportError, OSError):
            pass
        try:
            self.process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                            stderr=theirs if theirs is not None else subprocess.PIPE,
                                            start_new_session=os.name == "posix",
                                            env=dict(os.environ, NO_COLOR="1"))  # the lines are read, not looked at
        except OSError as e:
            if own_end is not None:
                os.close(own_end)
            raise InputError(command[0], "", f"cannot be run: {e.strerror or e}") from None
        finally:
            if theirs is not None:
                os.close(theirs)
        errors = own_end if own_end is not None else self.process.stderr.fileno()
        self.threads = [threading.Thread(target=self._read_errors, args=(errors, own_end is not None), daemon=True),
                        threading.Thread(target=self._read_output, daemon=True)]
        for thread in self.threads:
            thread.start()

    def _read_errors(self, handle, ours):
        rest = b""
        while True:
            try:
                data = os.read(handle, 4096)
            except OSError:  # the other end of a pseudo-terminal was closed
                break
            if not data:
                break
            parts = re.split(rb"[\r\n]", rest + data)
            rest = parts.pop()[-KEPT:]
            for part in parts + [rest]:
                self._line(part, part is not rest)
        self._line(rest, True)
        if ours:
            os.close(handle)

    def _line(self, data, whole):
        text = re.sub(r"\x1b\[[0-9;]*[Km]", "", data.decode("utf-8", "replace")).strip()
        if not text:
            return
        with self.lock:
            if text.startswith("glint: "):
                if whole and not text.startswith("glint: info: ") and len(self.messages) < 100:
                    self.messages.append(text[len("glint: "):])
                return
            counted = re.fullmatch(r"(.+?) (\d+) of (\d+)", text)
            if counted and int(counted[3]) > 0:
                self.stage, self.part = counted[1], min(1.0, int(counted[2]) / int(counted[3]))
            elif text.endswith(" ..."):
                self.stage, self.part = text[:-4], None

    def _read_output(self):
        while True:
            data = self.process.stdout.read1(65536)
            if not data:
                break
            self.output = (self.output + data)[-KEPT:]

    def progress(self):
        """Name of the stage, and its part from 0 to 1 or None where it is not known."""
        with self.lock:
            return self.stage, self.part

    def poll(self):
        """Exit code, None while it runs."""
        code = self.process.poll()
        if code is None and self.cancelled_at is not None and time.monotonic() - self.cancelled_at > PATIENCE:
            self._send(getattr(signal, "SIGKILL", signal.SIGTERM))
        if code is not None:
            for thread in self.threads:
                thread.join(timeout=1.0)
        return code

    def wait(self, seconds=None):
        """Exit code; waits for the end."""
        self.process.wait(seconds)
        return self.poll()

    def _send(self, number):
        try:
            if os.name == "posix":
                os.killpg(self.process.pid, number)
            else:
                self.process.terminate()
        except (ProcessLookupError, PermissionError):
            pass

    def cancel(self):
        """Asks it to stop: `glint` leaves no half-written file then."""
        if self.process.poll() is None and self.cancelled_at is None:
            self.cancelled_at = time.monotonic()
            self._send(signal.SIGTERM)


class Sequence:
    """Commands one after the other. steps: (label, command, exit codes that let the next one run)."""

    def __init__(self, steps):
        self.steps, self.number, self.job, self.failed, self.warnings = list(steps), -1, None, "", []
        self.cancelled = False
        self._next()

    def _next(self):
        self.number += 1
        self.job = Job(self.steps[self.number][1]) if self.number < len(self.steps) else None

    def done(self):
        """Whether all has ended; starts the next command where one has."""
        if self.job is None or self.failed or self.cancelled:
            return self.job is None or self.job.poll() is not None
        code = self.job.poll()
        if code is None:
            return False
        label, _, accepted = self.steps[self.number]
        if code not in accepted:
            said = [m for m in self.job.messages if not m.startswith("warning:")]
            self.failed = f"{label}: " + (said[-1] if said else f"glint ended with exit code {code}")
            return True
        self.warnings += [m for m in self.job.messages if "warning" in m[:20]]
        self._next()
        return self.job is None

    def progress(self):
        """Text, and the part of all from 0 to 1."""
        if self.job is None:
            return "done", 1.0
        stage, part = self.job.progress()
        label = self.steps[self.number][0]
        return f"{label}: {stage}" if stage else label, (self.number + (part or 0.0)) / len(self.steps)

    def cancel(self):
        if self.job is not None:
            self.cancelled = True
            self.job.cancel()

    def finish(self):
        """Waits for the end of all commands."""
        while not self.done():
            time.sleep(0.02)
