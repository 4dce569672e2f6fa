#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The words of sources and pages: no habit that reads as translated, the field's terms, lines and cells that a screen can hold.

  tests/rules/words.py [ROOT]      exit code 1 where a line breaks a rule (each is printed with its rule)

A habit or an old term that is meant, such as a key of a file format, stands in quotation marks or backticks: the rules for terms skip it."""
import pathlib
import re
import sys

FOLDERS = ("core", "io", "viz", "gui", "cli", "plugins", "bench", "tests", "docs", "resources")
SUFFIXES = (".h", ".cpp", ".py", ".md", ".cmake", ".txt", ".json")
MOST_COLUMNS, MOST_CELL = 130, 200
HABITS = {  # pattern: what to write
    r"\b(is|are) none\b": "'... is none': say what is missing, or what happens without it",
    r"\b[Aa]s of\b": "'as of': 'as in', 'as for', 'like'",
    r"(^\s*|(///?<?|#|\"|[|]|[^\"'`][.;]) ?)Of (?=[a-z`])": "a sentence that begins with 'Of': give it its subject",
}
TERMS = {
    r"(?<![\"`])\b[Pp]arting\b(?![\"`])|\bPart(ing|ed)[A-Z]": "specular separation",
    r"[Tt]ongue": "streak",
    r"(?<![a-zA-Z])[Ss]kirt|[a-z]Skirt": "flank",
}
# They name habits and old terms, to see that they are found.
EXEMPT = ("tests/rules/words.py", "tests/rules/rules_selftest.cmake")


def faults(name, text):
    """(line, rule) of what one file breaks."""
    cpp = name.endswith((".h", ".cpp"))
    for number, line in enumerate(text.split("\n"), 1):
        for pattern, advice in HABITS.items():
            if re.search(pattern, line):
                yield number, advice
        for pattern, term in TERMS.items():
            if re.search(pattern, line):
                yield number, f"the field's term is '{term}'"
        if cpp and len(line) > MOST_COLUMNS:
            yield number, f"{len(line)} columns, more than {MOST_COLUMNS}"
        if name.endswith(".md") and line.startswith("|"):
            longest = max(len(cell.strip()) for cell in re.split(r"(?<!\\)[|]", line))
            if longest >= MOST_CELL:
                yield number, f"a cell of {longest} characters; under {MOST_CELL}, or a sentence below the table"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2])
    files = [path for folder in FOLDERS for path in sorted((root / folder).rglob("*")) if path.suffix in SUFFIXES and path.is_file()]
    count = broken = 0
    for path in files:
        name = str(path.relative_to(root))
        if name in EXEMPT:
            continue
        count += 1
        for number, rule in faults(name, path.read_text(errors="replace")):
            broken += 1
            print(f"{name}:{number}: {rule}")
    print(f"{count} files, {broken} lines to change")
    sys.exit(1 if broken else 0)


main()
