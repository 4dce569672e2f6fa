#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Functions over 60 lines, outside of tests, must stand in tests/rules/long_functions.txt with their reason: FILE: FUNCTION: REASON.

  tests/rules/long_functions.py [ROOT]      exit code 1 where one is missing, or one that is listed is short by now

Relies on the layout of clang-format: a function of a file or a namespace starts and ends in column 0, one of a class in column 2."""
import pathlib
import re
import sys

MOST = 60
FOLDERS = ("core", "io", "viz", "gui", "cli", "bench")
NO_FUNCTION = re.compile(r"\s*(namespace|class|struct|enum|union|extern|using|template <[^>]*>$)\b|.*[=,(]\s*\{+$|.*\breturn\b.*\{$|.*= \{\{$")


def functions(lines, indent):
    """(name, first line, number of lines) of the functions whose bodies stand at that indentation."""
    start, head = None, 0
    pad = " " * indent
    in_class = indent == 0
    for number, line in enumerate(lines):
        if indent and line[:1] not in ("", " ", "#", "/"):
            in_class = bool(re.match(r"(class|struct)\b.*\{$", line)) or in_class and re.match(r"(public|private|protected)", line) is not None
        if not in_class:
            continue
        if start is None:
            own = line.startswith(pad) and len(line) > indent and line[indent] not in " }/#"
            if own:
                head = number
            if line.endswith("{") and (own or line.startswith(pad + "    ")):
                text = " ".join(part.strip() for part in lines[head:number + 1])
                if "(" in text and not re.search(r"[;{}]", text[:-1].replace("{}", "")) and not NO_FUNCTION.match(text):
                    start = (head, text)
        elif line == pad + "}":
            name = re.sub(r"\s*\(.*", "", re.sub(r"\boperator\(\)", "operator-call", start[1]))
            yield name.split()[-1].lstrip("*&"), start[0] + 1, number - start[0] + 1
            start = None


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2])
    found = {}
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".cpp", ".h"):
                continue
            lines = path.read_text().split("\n")
            for indent in (0, 2):
                for name, line, count in functions(lines, indent):
                    if count > MOST:
                        found[f"{path.relative_to(root)}: {name}"] = (line, count)
    listed = {}
    list_file = root / "tests/rules/long_functions.txt"
    for line in list_file.read_text().split("\n") if list_file.exists() else []:
        if line and not line.startswith("#"):
            place, name, reason = line.split(": ", 2)
            listed[f"{place}: {name}"] = reason
    wrong = [f"{key}: {found[key][1]} lines (line {found[key][0]}), over {MOST}: split it, or give its reason in long_functions.txt"
             for key in found if key not in listed]
    wrong += [f"{key}: not over {MOST} lines, or gone; take it out of long_functions.txt" for key in listed if key not in found]
    print("\n".join(wrong) or f"{len(found)} functions over {MOST} lines, each with its reason")
    sys.exit(1 if wrong else 0)


main()
