#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A type's name is defined once in its namespace, whatever the room: two definitions are one to the linker, which keeps either.

  tests/rules/type_names.py ROOT
"""
import pathlib
import re
import sys

FOLDERS = ("core", "viz", "gui", "cli", "plugins")
IGNORED = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
TOKEN = re.compile(r"\bnamespace\s*([\w:]*)\s*\{|"
                   r"\b(?:struct|class|enum(?:\s+(?:class|struct))?)\s+(?:\[\[[^\]]*\]\]\s*)?(?:alignas\([^)]*\)\s*)?"
                   r"((?:\w+::)*\w+)\s*(?:final\s*)?(?::(?!:)[^;{}()]*)?\{|([{}])")


def blank(match):
    return re.sub(r"[^\n]", " ", match.group())


def definitions(text):
    """(qualified name, line) of the types that are defined in named namespaces, outside of other types and functions."""
    text = IGNORED.sub(blank, text)
    scopes = []  # a namespace's name, "" of an anonymous one, None for anything else
    for token in TOKEN.finditer(text):
        space, name, brace = token.groups()
        if brace == "}":
            if scopes:
                scopes.pop()
            continue
        if name and all(scopes):
            yield "::".join([*scopes, name]), text.count("\n", 0, token.start()) + 1
        scopes.append(space if space is not None else None)


def faults(root):
    found = {}
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in (".h", ".cpp"):
                for name, line in definitions(file.read_text()):
                    found.setdefault(name, []).append(f"{file.relative_to(root)}:{line}")
    return [f"{places[0]}: {name} is defined in {', '.join(places[1:])} too"
            for name, places in sorted(found.items()) if len(places) > 1], len(found)


def main():
    lines, count = faults(pathlib.Path(sys.argv[1]))
    if count == 0:
        lines.append("type_names.py finds no type at all: the search itself is broken")
    print("\n".join(lines) or f"type names: {count} types, each defined once")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
