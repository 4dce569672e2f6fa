#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of what turns runs of machines into docs/trust.md: tests/test_rows.py and docs/make_trust.py. A row that is lost, or a part that looks
like a whole, would be a machine that seems to have found nothing."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

root = pathlib.Path(__file__).resolve().parent.parent.parent

# Programs of three and one test and one that was not built, as CTest lists them.
PROGRAMS = {"core_base": "A.\n  One\n  Two\nB.\n  One\n", "io": "Ply.\n  Reads\n", "viz": None}


def junit(*cases):
    inner = {"passed": "", "failed": "<failure message=''/>", "skipped": "<skipped message=''/>"}
    status = {"passed": "run", "failed": "fail", "skipped": "notrun"}
    return "<testsuite>" + "".join(f'<testcase name="{n}" status="{status[s]}">{inner[s]}</testcase>' for n, s in cases) + "</testsuite>"


class TestRows(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        entries = ""
        for name, cases in PROGRAMS.items():
            program = self.folder / name
            if cases:
                program.write_text(f"#!/bin/sh\ncat <<'END'\n{cases}END\n", encoding="utf-8")
                program.chmod(0o755)
            entries += f'add_test("{name}" "{sys.executable}" "{root}/tests/suite/entry.py" "--entry" "{name}" "--prefix" "{name}." "--results" "x" "{program}")\n'
        (self.folder / "CTestTestfile.cmake").write_text(entries + 'add_test("rules.layers" "/bin/true")\n', encoding="utf-8")

    def rows(self, *arguments, results=None):
        if results is not None:
            (self.folder / "results.xml").write_text(results, encoding="utf-8")
            arguments += (str(self.folder / "results.xml"),)
        done = subprocess.run([sys.executable, "-B", root / "tests/test_rows.py", "--build", self.folder, *arguments], text=True, check=True,
                              stdout=subprocess.PIPE, env={name: value for name, value in os.environ.items() if not name.startswith("GLINT_TEST_")})
        return [tuple(line.split("\t")) for line in done.stdout.splitlines()]

    def testCountsAndNamesWhatFailed(self):
        results = junit(("core_base.A.One", "passed"), ("core_base.A.Two", "failed"), ("core_base.B.One", "skipped"), ("io.Ply.Reads", "passed"))
        self.assertEqual(self.rows(results=results), [("core_base", "2", "1", "tests; 1 skipped: core_base.A.Two"), ("io", "1", "0", "tests")])

    def testATestThatRanAgainCountsAsInTheLastFile(self):
        earlier = self.folder / "earlier.xml"
        earlier.write_text(junit(("core_base.A.One", "passed"), ("core_base.A.Two", "failed"), ("core_base.B.One", "passed")), encoding="utf-8")
        self.assertEqual(self.rows(str(earlier), results=junit(("core_base.A.Two", "passed"))), [("core_base", "3", "0", "tests")])

    def testAPartSaysThatItIsOne(self):
        self.assertEqual(self.rows(results=junit(("core_base.A.One", "passed"))), [("core_base, 1 of 3 tests", "1", "0", "tests")])

    def testReportsOfAnyProcessAreFindings(self):
        reports = self.folder / "reports"
        reports.mkdir()
        self.assertEqual(self.rows("--reports", str(reports), results=junit(("io.Ply.Reads", "passed"))), [("io", "1", "0", "tests")])
        (reports / "report.17").write_text("AddressSanitizer", encoding="utf-8")
        self.assertEqual(self.rows("--reports", str(reports), results=junit(("io.Ply.Reads", "passed")))[1][:3], ("reports of the sanitizer", "1", "1"))

    def testProgramsThatAreNotBuiltAreNeeded(self):
        self.assertEqual(self.rows("--programs"), [("core_base",), ("io",), ("rules",), ("viz",)])
        self.assertEqual(self.rows("--programs", "--pattern", r"^core_base\.B"), [("core_base",)])
        self.assertEqual(self.rows("--programs", "--pattern", r"^viz\."), [("viz",)])
        self.assertEqual(self.rows("--programs", "--leave-out", r"^io\."), [("core_base",), ("rules",), ("viz",)])


class MakeTrust(unittest.TestCase):
    """In a folder of its own, with the program's copy: it looks for its pieces beside itself."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.pieces = self.folder / "docs/trust"
        self.pieces.mkdir(parents=True)
        shutil.copy(root / "docs/make_trust.py", self.folder / "docs")
        (self.folder / "docs/trust.md").write_text("# Trust\n<!-- table -->\n<!-- end of table -->\n", encoding="utf-8")

    def run_(self, *arguments):
        return subprocess.run([sys.executable, self.folder / "docs/make_trust.py", *map(str, arguments)], text=True, capture_output=True)

    def addRows(self, *rows, needs=()):
        options = [word for row in rows for word in ("--row", *map(str, row))] + [f"--needs={name}" for name in needs]
        return self.run_("row", self.pieces / "asan.json", "--what", "Sanitizer", "--command", "tests/run_sanitizers asan", *options)

    def piece(self):
        return json.loads((self.pieces / "asan.json").read_text(encoding="utf-8"))

    def page(self):
        done = self.run_()
        return done, (self.folder / "docs/trust.md").read_text(encoding="utf-8")

    def testWhatNeverRanIsMissing(self):
        done, page = self.page()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(page.count("| missing |"), 9)
        self.assertEqual(self.addRows(("io", 16, 0, "tests"), needs=("io", "gui")).returncode, 0)
        _, page = self.page()
        self.assertIn("[Sanitizer](#asan) (1 rows are missing) | 16 | 0 |", page)
        self.assertIn("| gui | missing | | |", page)

    def testRowsOfALaterRunReplaceThoseOfTheirName(self):
        self.addRows(("io", 16, 2, "tests"), ("gui", 5, 0, "tests"))
        self.addRows(("io", 16, 0, "tests"))
        self.assertEqual({row["name"]: (row["count"], row["findings"]) for row in self.piece()["rows"]}, {"gui": (5, 0), "io": (16, 0)})

    # A part that was run before the whole would count its tests twice.
    def testAWholeReplacesItsParts(self):
        self.addRows(("io, 3 of 16 tests", 3, 1, "tests"), ("io_more, 3 of 4 tests", 3, 0, "tests"))
        self.addRows(("io", 16, 0, "tests"))
        self.assertEqual([row["name"] for row in self.piece()["rows"]], ["io_more, 3 of 4 tests", "io"])

    def testBadPiecesAreNamedAndNotShownAsClean(self):
        for text in ("{", "[]", '{"what": "w", "command": "c", "date": "2026-02-30", "rows": []}',
                     '{"what": "w", "command": "c", "date": "2026-02-28", "rows": [{"name": "a", "note": "", "count": -1, "findings": 0}]}'):
            (self.pieces / "asan.json").write_text(text, encoding="utf-8")
            done, page = self.page()
            self.assertEqual(done.returncode, 1, text)
            self.assertIn("docs/trust/asan.json", done.stderr)
            self.assertIn("| not readable |", page)

    def testRowsMustBeNumbers(self):
        self.assertNotEqual(self.addRows(("io", "-1", 0, "tests")).returncode, 0)
        self.assertNotEqual(self.addRows(("io", "many", 0, "tests")).returncode, 0)
        self.assertFalse((self.pieces / "asan.json").exists())

    def testCheckSeesAPageThatIsOld(self):
        self.addRows(("io", 16, 0, "tests"))
        self.assertEqual(self.run_("--check").returncode, 1)
        self.page()
        self.assertEqual(self.run_("--check").returncode, 0)

    def testTimesOfTheLastRunAreShown(self):
        self.addRows(("io", 16, 0, "tests"))
        self.assertNotIn("Minutes", self.page()[1])
        self.run_("times", "fuzz=600", "suite=60")
        self.run_("times", "suite=3000")
        _, page = self.page()
        self.assertRegex(page, r"Minutes of `tests/run_nightly` on \d+ cores: fuzz 10 \([-0-9]+\), suite 50 \([-0-9]+\); together 1.0 hours.")
        self.assertEqual(self.run_("--check").returncode, 0)

    # A reader that is newer than the last run must not look as if it had been fed, and one that is gone must not count.
    def testReadersThatWereNeverFedAreMissingAndThoseThatAreGoneDoNotCount(self):
        (self.folder / "tests").mkdir()
        (self.folder / "tests/run_fuzz").write_text("#!/bin/sh\nall=(ply nvm)\n", encoding="utf-8")
        self.run_("row", self.pieces / "fuzz.json", "--what", "Readers", "--command", "tests/run_fuzz", "--row", "ply", "10", "0", "", "--needs=ply",
                  "--row", "gone", "5", "1", "", "--needs=gone")
        _, page = self.page()
        self.assertIn("[Readers](#fuzz) (1 rows are missing) | 10 | 0 |", page)
        self.assertIn("| nvm | missing | | |", page)
        self.assertNotIn("gone", page)

    def testTheShippedPageIsWhatItsPiecesGive(self):
        done = subprocess.run([sys.executable, root / "docs/make_trust.py", "--check"], text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)


class Readers(unittest.TestCase):
    """A reader of files stands in five places. One that is left out of one of them would never be fed there."""

    def setUp(self):
        self.all = re.findall(r'^      \{"(\w+)", Form::', (root / "tests/fuzz/readers.cpp").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertGreater(len(self.all), 25)

    def testTheNightlyScriptFeedsEveryOne(self):
        listed = re.search(r"^all=\((.*)\)$", (root / "tests/run_fuzz").read_text(encoding="utf-8"), re.MULTILINE)[1].split()
        self.assertEqual(sorted(listed), sorted(self.all))
        self.assertIn("fuzz", re.search(r"^all=\((.*)\)$", (root / "tests/run_nightly").read_text(encoding="utf-8"), re.MULTILINE)[1].split())

    def testEveryTestRunFeedsEveryOne(self):
        loops = re.findall(r"^foreach\(reader (.*)\)$", (root / "tests/fuzz/CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(sorted(" ".join(loops).split()), sorted(self.all))

    def testEveryOneHasACorpus(self):
        for reader in self.all:
            corpus = root / "tests/fuzz/corpus" / ("image" if reader == "image_header" else reader)
            self.assertTrue(corpus.is_dir() and any(corpus.iterdir()), reader)

    def testThePageHasARowForEveryOne(self):
        page = (root / "docs/trust.md").read_text(encoding="utf-8").replace("\\", "")
        part = page[page.index("### fuzz"):page.index("### mutations")]
        for reader in self.all:
            self.assertIn(f"\n| {reader} | ", part)


if __name__ == "__main__":
    unittest.main()
