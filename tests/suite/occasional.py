#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Groups of tests that run when their code changed: occasional.txt names their entries and paths, occasional.stamps what the paths held when the
group last passed. tests/run_nightly runs all of them.

  tests/suite/occasional.py changed [GROUP...]   the groups (of these) that are to run; exit code 1 without any
  tests/suite/occasional.py stamp [GROUP...]     they (all) passed with the files as they are now; commit occasional.stamps

Content counts, not history: a clone without history, or one whose files were changed, decides alike."""
import hashlib
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent


class Group:
    def __init__(self, name, entries):
        self.name, self.entries, self.paths = name, re.compile(entries), []


def groups(file=HERE / "occasional.txt"):
    """Each group stands on a line "NAME REGEX", and its paths, from the root of the project, on indented lines behind it."""
    found = []
    for line in file.read_text(encoding="utf-8").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        if line[0].isspace():
            found[-1].paths += line.split()
        else:
            found.append(Group(*line.split()))
    return found


def digest(root, group):
    """A hash of names and contents of all files below the paths that git does not ignore; None where git does not tell."""
    asked = subprocess.run(["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", *group.paths],
                           capture_output=True)
    names = sorted(set(asked.stdout.split(b"\0")) - {b""})
    if asked.returncode or not names:
        return None
    whole = hashlib.sha256()
    for name in names:
        file = pathlib.Path(root) / name.decode("utf-8", "surrogateescape")
        if file.is_file():
            whole.update(name + b"\0" + hashlib.sha256(file.read_bytes()).digest())
    return whole.hexdigest()


def stamps(file=HERE / "occasional.stamps"):
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return dict(line.split() for line in lines if line and not line.startswith("#"))


def changed(root, some=None, stamped=None):
    """Groups whose paths hold something else than when they last passed."""
    stamped = stamps() if stamped is None else stamped
    return [g for g in (groups() if some is None else some) if stamped.get(g.name) is None or stamped[g.name] != digest(root, g)]


def stamp(root, names, file=HERE / "occasional.stamps"):
    new = stamps(file)
    for group in groups():
        if group.name in names:
            new[group.name] = digest(root, group)
    lines = ["# Written by tests/suite/occasional.py stamp: SHA-256 of what the paths of each group held when it last passed."]
    file.write_text("\n".join([*lines, *(f"{name} {value}" for name, value in sorted(new.items()) if value)]) + "\n", encoding="utf-8")


def main(arguments):
    known = {g.name: g for g in groups()}
    what, names = (arguments[0], arguments[1:]) if arguments else ("", [])
    unknown = [name for name in names if name not in known]
    if what not in ("changed", "stamp") or unknown:
        print(f"no group {unknown[0]}; known are {', '.join(known)}" if unknown else __doc__, file=sys.stderr)
        return 2
    root = HERE.parent.parent
    if what == "stamp":
        stamp(root, names or list(known))
        return 0
    which = [g.name for g in changed(root, [known[n] for n in names] or list(known.values()))]
    print("\n".join(which))
    return 0 if which else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
