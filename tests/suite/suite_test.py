#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""suite_test.py SAMPLE: tests of entry.py and suite.py. A case that is lost here would be a test that seems to pass."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

here = pathlib.Path(__file__).resolve().parent
sample = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(here))
import occasional  # noqa: E402

# The environment of whoever runs this test.
environment = {name: value for name, value in os.environ.items() if not name.startswith(("GLINT_TEST_", "GTEST_"))}


def statusOf(case):
    return "skipped" if case.find("skipped") is not None else "failed" if case.find("failure") is not None else case.get("status")


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)


class Entry(Folder):
    def run_(self, *arguments, program=sample, variables=()):
        done = subprocess.run([sys.executable, "-B", here / "entry.py", "--entry", "e", "--prefix", "p.", "--results", self.folder, *arguments, program],
                              text=True, capture_output=True, env={**environment, **dict(variables)})
        self.assertEqual(done.stderr, "")
        self.said = done.stdout
        self.cases = {case.get("name"): case for case in xml.parse(self.folder / "e.xml").getroot()}
        return done.returncode, {name: statusOf(case) for name, case in self.cases.items()}

    def testEveryCaseHasItsResult(self):
        code, results = self.run_("--cases", "Good.*:Bad.*")
        self.assertEqual(code, 1)
        self.assertEqual(results, {"p.Good.A": "run", "p.Good.B": "run", "p.Good.C": "run", "p.Good.DISABLED_D": "disabled", "p.Bad.Fails": "failed",
                                   "p.Bad.IsSkipped": "skipped"})
        self.assertIn("said before", self.said)
        self.assertIn("FAILED: p.Bad.Fails", self.said)
        self.assertNotIn("no end of line", self.said)
        self.assertIn("no end of line", (self.folder / "e.log").read_text())
        self.assertEqual(self.cases["p.Bad.IsSkipped"].find("skipped").get("message"), "no data beside the project")

    def testCodes(self):
        self.assertEqual(self.run_("--cases", "Good.A")[0], 0)
        self.assertEqual(self.run_("--cases", "Bad.IsSkipped")[0], 77)
        self.assertEqual(self.run_("--cases", "Bad.IsSkipped:Good.A")[0], 0)
        self.assertEqual(self.run_("--cases", "None.*"), (77, {}))

    def testWhatEndsTheProgramIsNamedAndTheOthersRun(self):
        code, results = self.run_("--cases", "Good.A:Ends.ByAborting:Ends.ByExit:Bad.IsSkipped:NoSuite.*:Alone.First")
        self.assertEqual(code, 1)
        self.assertEqual(results.pop("p.NoSuite.(SetUpTestSuite or TearDownTestSuite)"), "failed")
        self.assertIn("nothing to stand on", self.said)
        self.assertEqual(results, {"p.Good.A": "run", "p.Ends.ByAborting": "failed", "p.Ends.ByExit": "failed", "p.Bad.IsSkipped": "skipped",
                                   "p.NoSuite.IsNotRun": "skipped", "p.Alone.First": "run"})
        self.assertIn("signal 6", self.cases["p.Ends.ByAborting"].find("failure").get("message"))
        self.assertIn("exit code 0", self.cases["p.Ends.ByExit"].find("failure").get("message"))
        self.assertEqual(self.cases["p.Bad.IsSkipped"].find("skipped").get("message"), "no data beside the project")

    def testAHangIsNamedAndTheOthersRun(self):
        for seconds in ("2", "20", "200"):  # more where the machine is so busy that nothing else begins in time
            code, results = self.run_("--cases", "Good.A:Ends.Never:Alone.First", "--seconds", seconds)
            if list(results.values()).count("run") == 2:
                break
        self.assertEqual((code, results), (1, {"p.Good.A": "run", "p.Ends.Never": "failed", "p.Alone.First": "run"}))
        self.assertIn(f"no end within {seconds} s", self.cases["p.Ends.Never"].find("failure").get("message"))

    def testAnExitCodeAfterAllCasesIsAFailure(self):
        self.assertEqual(self.run_("--cases", "AtTheEnd.*"), (1, {"p.AtTheEnd.ComesAnExitCode": "run", "p.(its end)": "failed"}))
        self.assertIn("exit code 9", self.said)

    def testAProgramThatDoesNotStart(self):
        broken = self.folder / "broken"
        broken.write_text("#!/bin/sh\nexit 3\n")
        broken.chmod(0o755)
        code, results = self.run_(program=broken)
        self.assertEqual((code, set(results.values())), (1, {"failed"}))
        self.assertEqual(self.run_("--each", program=broken), (1, {"p.(its start)": "failed"}))
        self.assertEqual(self.run_(program=self.folder / "none"), (1, {"p.(its start)": "failed"}))

    def testShardsTogetherRunEveryCaseOnce(self):
        for cases in ("Good.*:Some/*", "Good.*:Ends.ByAborting:Ends.ByExit:Some/*:Bad.*:Alone.First"):
            together = {}
            for shard in range(3):
                for name, status in self.run_("--cases", cases, "--shards", "3", "--shard", str(shard))[1].items():
                    if status != "disabled":
                        self.assertNotIn(name, together)
                        together[name] = status
            self.assertEqual(together, {name: status for name, status in self.run_("--cases", cases)[1].items() if status != "disabled"})

    def testFilters(self):
        only = {"GLINT_TEST_FILTER": r"^p\.(Good\.[AB]|Ends)|Positive/2$", "GLINT_TEST_LEAVE_OUT": "Ends"}
        self.assertEqual(self.run_(variables=only), (0, {"p.Good.A": "run", "p.Good.B": "run", "p.Some/Numbers.ArePositive/2": "run"}))
        self.assertEqual(self.run_(variables={"GLINT_TEST_FILTER": "Nothing"}), (77, {}))
        names = [name for shard in "012" for name in self.run_("--shards", "3", "--shard", shard, variables={"GLINT_TEST_FILTER": "Numbers"})[1]]
        self.assertEqual(len(set(names)), 4)

    def testOneProcessForEachCase(self):
        self.assertEqual(self.run_("--cases", "Alone.*"), (1, {"p.Alone.First": "run", "p.Alone.Second": "failed"}))
        self.assertEqual(self.run_("--cases", "Alone.*", "--each"), (0, {"p.Alone.First": "run", "p.Alone.Second": "run"}))


class Suite(Folder):
    """Real runs of ctest in a folder with two shards of the sample, two other tests and a program that is not built."""

    def setUp(self):
        super().setUp()
        lines = []

        def add(name, *command, properties=""):
            words = " ".join(f'"{word}"' for word in command)
            lines.append(f'add_test("{name}" {words})\nset_tests_properties("{name}" PROPERTIES SKIP_RETURN_CODE 77 {properties})\n')

        def addCases(name, program, *more, properties="", prefix="p."):
            add(name, sys.executable, "-B", here / "entry.py", "--entry", name, "--prefix", prefix, "--results", self.folder / "other", *more, program,
                properties=properties)

        cases = "Good.*:Bad.*:Some/*"
        addCases("p.1of2", sample, "--cases", cases, "--shards", "2", "--shard", "0")
        addCases("p.2of2", sample, "--cases", cases, "--shards", "2", "--shard", "1")
        addCases("missing", self.folder / "missing", prefix="m.")
        addCases("stuck", sample, "--cases", "Ends.Never", properties="TIMEOUT 2")
        add("widgets.some", "/bin/sh", "-c", "echo 'SKIP   : glint::gui::SomeTest::isBig() the screen is smaller'")
        add("absent", self.folder / "absent")
        add("python", "/bin/sh", "-c", "echo 'no jsonschema'; exit 77")
        (self.folder / "CTestTestfile.cmake").write_text("".join(lines))

    def run_(self, *arguments):
        done = subprocess.run([sys.executable, "-B", here / "suite.py", "--build", self.folder, *arguments], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, env=environment)
        return done.returncode, done.stdout

    def testWhatIsNotBuiltIsAFailureUnlessItIsLeftOut(self):
        code, said = self.run_()
        self.assertNotEqual(code, 0)
        self.assertIn("failed, 4:\n", said)
        for name in ("p.Bad.Fails", "m.(its start)", "p.(stuck left no results)", "absent"):
            self.assertIn(f"  {name}\n", said)
        code, said = self.run_("--built", "--leave-out", "Ends|Fails")
        self.assertEqual(code, 0, said)
        self.assertIn("not built, left out: missing absent\n", said)
        self.assertTrue(said.endswith("10 tests: 8 passed, 0 failed, 2 skipped\n"), said)

    def testNamesWhatFailedAndWhatWasSkippedWithTheReason(self):
        code, said = self.run_("--leave-out", "Ends", "--junit", str(self.folder / "results.xml"), "-j", "2")
        self.assertNotEqual(code, 0)
        self.assertIn("skipped, 1: no data beside the project\n  p.Bad.IsSkipped\n", said)
        self.assertIn("skipped, 1: no jsonschema\n  python\n", said)
        self.assertIn("skipped, 1: the screen is smaller\n  widgets.some SomeTest::isBig()\n", said)
        self.assertIn("failed, 1:\n  p.Bad.Fails\n", said)
        self.assertTrue(said.endswith("11 tests: 8 passed, 1 failed, 2 skipped\n"), said)
        results = {case.get("name"): statusOf(case) for case in xml.parse(self.folder / "results.xml").getroot()}
        self.assertEqual(len(results), 11)
        self.assertEqual((results["p.Some/Numbers.ArePositive/3"], results["p.Bad.Fails"], results["widgets.some"], results["python"]),
                         ("run", "failed", "run", "skipped"))

    def testAFilterTakesCasesAndOtherTests(self):
        code, said = self.run_("--filter", r"Good\.A$|^widgets\.")
        self.assertEqual(code, 0)
        self.assertTrue(said.endswith("2 tests: 2 passed, 0 failed\n"), said)
        self.assertNotEqual(self.run_("--filter", "NoSuchTest")[0], 0)
        self.assertEqual(self.run_("--filter", "(")[0], 2)

    def testAnEntryThatCtestEndsIsAFailure(self):
        old = self.folder / "Testing/cases/stuck.xml"
        old.parent.mkdir(parents=True)
        old.write_text('<testsuite><testcase name="p.Ends.Never" status="run"/></testsuite>')
        os.utime(old, (1, 1))
        code, said = self.run_("--filter", r"^p\.(Ends|Good)")
        self.assertNotEqual(code, 0)
        self.assertIn("failed, 1:\n  p.(stuck left no results)\n", said)
        self.assertTrue(said.endswith("4 tests: 3 passed, 1 failed\n"), said)

    def testLists(self):
        code, said = self.run_("--list", "--filter", r"Positive|^p")
        self.assertEqual(code, 0)
        self.assertEqual(said.split(), sorted(["p.Good.A", "p.Good.B", "p.Good.C", "p.Bad.Fails", "p.Bad.IsSkipped", "p.Ends.Never", "python",
                                               *(f"p.Some/Numbers.ArePositive/{i}" for i in range(4))]))


class Occasional(Folder):
    """Groups that run when their code changed. A group that is forgotten would be a test that never runs."""

    def git(self, *arguments):
        subprocess.run(["git", "-C", self.folder, "-c", "user.name=a", "-c", "user.email=a@b", *arguments], check=True, capture_output=True)

    def setUp(self):
        super().setUp()
        self.git("init", "-q")
        for name, text in (("a/one.cpp", "1"), ("a/two.cpp", "2"), ("b/three.cpp", "3")):
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_text(text)
        self.git("add", ".")
        self.git("commit", "-qm", "all")
        (self.folder / "groups.txt").write_text("# words\nfirst ^f\\.\n  a\n\nsecond ^s\\.\n  b/*.cpp\n")
        self.groups = occasional.groups(self.folder / "groups.txt")
        self.stamps = {g.name: occasional.digest(self.folder, g) for g in self.groups}

    def names(self, stamps=None):
        return [g.name for g in occasional.changed(self.folder, self.groups, self.stamps if stamps is None else stamps)]

    def testContentOfTheirPathsAlone(self):
        self.assertEqual(self.names(), [])
        self.assertEqual(self.names({}), ["first", "second"])
        (self.folder / "b/three.cpp").write_text("4")
        self.assertEqual(self.names(), ["second"], "not committed")
        self.git("commit", "-qam", "b")
        self.assertEqual(self.names(), ["second"])
        (self.folder / "b/three.cpp").write_text("3")
        self.assertEqual(self.names(), [], "as it was")
        (self.folder / "a/new.cpp").write_text("")
        self.assertEqual(self.names(), ["first"], "a new file")
        (self.folder / "a/new.cpp").unlink()
        (self.folder / "a/two.cpp").rename(self.folder / "a/2.cpp")
        self.assertEqual(self.names(), ["first"], "another name")

    def testWithoutGitEverythingRuns(self):
        shutil.rmtree(self.folder / ".git")
        self.assertEqual(self.names(), ["first", "second"])

    def testTheListNamesEntriesAndPathsThatAre(self):
        root = here.parent.parent
        scripts = "".join(file.read_text() for file in root.glob("tests/**/CMakeLists.txt"))
        for group in occasional.groups():
            for path in group.paths:
                self.assertTrue((root / path).exists(), f"{group.name}: {path}")
            words = re.findall(r"[a-z_]{4,}", group.entries.pattern)
            for word in words:
                self.assertIn(word, scripts, group.name)
        names = [group.name for group in occasional.groups()]
        self.assertEqual(len(set(names)), len(names))
        self.assertLessEqual(set(occasional.stamps()), set(names))


unittest.main()
