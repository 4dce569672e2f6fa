#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Renders docs/trust.md from the pieces in docs/trust (format: docs/trust/README.md), and writes such pieces.

  docs/make_trust.py            renders the page; exit 1 if a piece is not in the format
  docs/make_trust.py --check    says whether the page matches the pieces; exit 1 if not
  docs/make_trust.py piece NAME --what TEXT --command TEXT [--row NAME COUNT FINDINGS NOTE]...
  docs/make_trust.py times NAME=SECONDS...
                                keeps in docs/trust/times.json how long these searches took; the times of others stay
  docs/make_trust.py row FILE --what TEXT --command TEXT --row NAME COUNT FINDINGS NOTE... [--needs NAME]...
                                adds these rows, each with today's date; other rows stay, and needed rows that are absent are shown as missing
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
page = root / "docs/trust.md"
pieces = root / "docs/trust"
times = pieces / "times.json"
begin, end = "<!-- table -->\n", "<!-- end of table -->\n"

# In the page's order: the piece, what it is about, and the command that writes it.
expected = [
    ("fuzz", "Fuzz targets of the readers", "tests/run_fuzz"),
    ("mutations", "Mutated inputs", "tests/run_mutations"),
    ("faults", "Injected faults", "tests/run_faults"),
    ("kills", "Kills at random", "tests/run_kills"),
    ("determinism", "Determinism", "tests/run_determinism"),
    ("asan", "The test-suite under the address and undefined-behaviour sanitizers, assertions on", "tests/run_sanitizers asan"),
    ("lsan", "The command line under the leak sanitizer", "tests/run_sanitizers lsan"),
    ("tsan", "Threads under the thread sanitizer", "tests/run_sanitizers tsan"),
    ("properties", "Property tests of the pipeline", "tests/run_nightly"),
]


class NotAPiece(Exception):
    pass


def checked(piece):
    """The piece, when it is of the format."""
    def text(value, name, empty=False):
        if not isinstance(value, str) or (not empty and not value) or any(ord(c) < 32 or ord(c) == 127 for c in value):
            raise NotAPiece(f"{name}: must be one line of text")
    if not isinstance(piece, dict):
        raise NotAPiece("must be an object")
    for key in ("what", "command", "date"):
        text(piece.get(key), key)
    try:
        if not re.fullmatch(r"\d{4}-\d\d-\d\d", piece["date"]):
            raise ValueError
        datetime.date.fromisoformat(piece["date"])
    except ValueError:
        raise NotAPiece("date: must be YYYY-MM-DD") from None
    rows = piece.get("rows")
    if not isinstance(rows, list) or not rows:
        raise NotAPiece("rows: must be a list with at least one row")
    for i, row in enumerate(rows):
        if not isinstance(row, dict):
            raise NotAPiece(f"rows[{i}]: must be an object")
        text(row.get("name"), f"rows[{i}].name")
        text(row.get("note"), f"rows[{i}].note", empty=True)
        for key in ("count", "findings"):
            value = row.get(key)
            if not isinstance(value, int) or isinstance(value, bool) or value < 0:
                raise NotAPiece(f"rows[{i}].{key}: must be a whole number, 0 or more")
    needed = piece.get("needs", [])
    if not isinstance(needed, list):
        raise NotAPiece("needs: must be a list")
    for i, name in enumerate(needed):
        text(name, f"needs[{i}]")
    return piece


def shown(text):
    """Plain text in a cell of a Markdown table."""
    return re.sub(r"([\\`*_<>\[\]|#])", r"\\\1", text)


def cell(code):
    """Code in a cell: a bar would end it."""
    return code.replace("|", "\\|")


def readers():
    """Those that tests/run_fuzz feeds: one that came after the last run is missing on the page until it has run, one that is gone is not
    on it."""
    script = root / "tests/run_fuzz"
    named = re.search(r"^all=\(([^)]*)\)$", script.read_text(encoding="utf-8"), re.MULTILINE) if script.exists() else None
    return named[1].split() if named else []


def render():
    """The table and the details, and what is wrong with pieces."""
    found, problems = {}, []
    for file in sorted(pieces.glob("*.json")):
        if file == times:
            continue
        try:
            found[file.stem] = checked(json.loads(file.read_text(encoding="utf-8")))
        except (ValueError, NotAPiece) as error:
            problems.append(f"docs/trust/{file.name}: {error}")
            found[file.stem] = None
    order = list(expected) + [(name, name, "") for name in found if name not in {e[0] for e in expected}]
    head = ["| what | tried | findings | date | command |", "|---|---:|---:|---|---|"]
    details = []
    for name, title, command in order:
        if name not in found:
            head.append(f"| {title} | missing | | | `{command}` |")
            continue
        piece = found[name]
        if piece is None:
            head.append(f"| {title} | not readable | | | `{command}` |")
            continue
        rows, needs = piece["rows"], piece.get("needs", [])
        if name == "fuzz" and readers():  # not those of the last run: some are new, some are gone
            needs = readers()
            rows = [row for row in rows if row["name"] in needs]
        count, findings = (sum(row[key] for row in rows) for key in ("count", "findings"))
        ran = piece["command"].replace("`", "'")
        absent = [needed for needed in needs if needed not in {row["name"] for row in rows}]
        open_ = f" ({len(absent)} rows are missing)" if absent else ""
        head.append(f"| [{shown(piece['what'])}](#{name.replace('_', '-')}){open_} | {count:,} | {findings:,} | {piece['date']} | `{cell(ran)}` |")
        details += ["", f"### {name.replace('_', ' ')}", f"{shown(piece['what'])}. {piece['date']}, `{ran}`.", "",
                    "| name | count | findings | note |", "|---|---:|---:|---|"]
        details += [f"| {shown(r['name'])} | {r['count']:,} | {r['findings']:,} | {shown(r['note'])} |" for r in rows]
        details += [f"| {shown(row)} | missing | | |" for row in absent]
    return "\n".join(head + duration() + details) + "\n", problems


def duration():
    """What the searches of tests/run_nightly took when each ran last."""
    if not times.exists():
        return []
    took = json.loads(times.read_text(encoding="utf-8"))
    said = [f"{name} {one['seconds'] / 60:.0f} ({one['date']})" for name, one in took.items()]
    return ["", f"Minutes of `tests/run_nightly` on {max(one['cores'] for one in took.values())} cores: {', '.join(said)}; together {sum(one['seconds'] for one in took.values()) / 3600:.1f} hours."]


def writeTimes(arguments):
    took = json.loads(times.read_text(encoding="utf-8")) if times.exists() else {}
    for name, seconds in (pair.split("=") for pair in arguments.times):
        took[name] = {"seconds": int(seconds), "date": today(), "cores": os.cpu_count()}
    pieces.mkdir(exist_ok=True)
    replaceFile(times, json.dumps(took, indent=2) + "\n")


def replaceFile(file, text):
    temporary = file.with_name(file.name + ".new")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, file)


def write(file, arguments, earlier, note, needs):
    """A piece with the rows of the command line after those of `earlier` that have other names."""
    rows = []
    for name, count, findings, text in arguments.row:
        if not (count.isascii() and count.isdigit() and findings.isascii() and findings.isdigit()):
            sys.exit(f"make_trust.py: --row {name}: COUNT and FINDINGS must be whole numbers, 0 or more")
        rows.append({"name": name, "count": int(count), "findings": int(findings), "note": text + note})
    kept = [row for row in earlier if row["name"] not in {row["name"] for row in rows}]
    piece = {"what": arguments.what, "command": arguments.command, "date": today(), "rows": kept + rows}
    if needs:
        piece["needs"] = needs
    try:
        checked(piece)
    except NotAPiece as error:
        sys.exit(f"make_trust.py: {error}")
    replaceFile(file, json.dumps(piece, indent=2, ensure_ascii=False) + "\n")


def today():
    return datetime.datetime.now(datetime.timezone.utc).date().isoformat()


def writePiece(arguments):
    if not re.fullmatch(r"[a-z][a-z0-9_]*", arguments.name):
        sys.exit("make_trust.py: NAME: lower-case letters, digits and _ only")
    pieces.mkdir(exist_ok=True)
    write(pieces / f"{arguments.name}.json", arguments, [], "", [])


def writeRows(arguments):
    """Rows of a piece that takes several runs: the piece need not be there, and other rows stay."""
    file = pathlib.Path(arguments.file)
    earlier = checked(json.loads(file.read_text(encoding="utf-8"))) if file.exists() else {"rows": []}
    whole = {row[0] for row in arguments.row}
    # A part that ran before the whole is in it ("io, 3 of 16 tests" in "io").
    kept = [row for row in earlier["rows"] if re.sub(r", \d+ of \d+ tests$", "", row["name"]) not in whole
            or row["name"] in whole]
    write(file, arguments, kept, f", {today()}", arguments.needs or earlier.get("needs", []))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if the page does not match the pieces")
    commands = parser.add_subparsers(dest="verb")
    piece = commands.add_parser("piece", help="write docs/trust/NAME.json")
    piece.add_argument("name")
    piece.add_argument("--what", required=True)
    piece.add_argument("--command", required=True)
    piece.add_argument("--row", nargs=4, action="append", default=[], metavar=("NAME", "COUNT", "FINDINGS", "NOTE"))
    row = commands.add_parser("row", help="add rows to the piece in a file, or replace rows of the same names")
    row.add_argument("file")
    row.add_argument("--what", required=True)
    row.add_argument("--command", required=True)
    row.add_argument("--row", nargs=4, action="append", required=True, metavar=("NAME", "COUNT", "FINDINGS", "NOTE"))
    row.add_argument("--needs", action="append", default=[], metavar="NAME", help="a row that a complete piece needs")
    took = commands.add_parser("times", help="how long searches took")
    took.add_argument("times", nargs="*", metavar="NAME=SECONDS")
    arguments = parser.parse_args()
    if arguments.verb == "piece":
        return writePiece(arguments)
    if arguments.verb == "row":
        return writeRows(arguments)
    if arguments.verb == "times":
        return writeTimes(arguments)
    body, problems = render()
    head, rest = page.read_text(encoding="utf-8").split(begin)
    text = head + begin + body + end + rest.split(end)[1]
    for problem in problems:
        print(f"make_trust.py: {problem}", file=sys.stderr)
    if arguments.check:
        if text != page.read_text(encoding="utf-8"):
            print("make_trust.py: docs/trust.md does not match docs/trust/*.json: run docs/make_trust.py", file=sys.stderr)
            return 1
    else:
        replaceFile(page, text)
    return 1 if problems else 0


sys.exit(main())
