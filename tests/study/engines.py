#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A small study under each engine of plugins/cluster: one scene, two models, two groups of settings. One task fails at its first run and is
repeated; under Slurm the node's daemon is killed and started again meanwhile. Results and table are those of plain runs of `glint evaluate`.

    tests/study/engines.py GLINT PROJECT local|submit|snakemake|slurm

Skipped (77), by name, where the engine is not installed, and Slurm without root. Slurm's daemons run with a key, sockets and ports of this test and
without systemd; all are ended by their process ids."""
import csv
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

import common

NEEDED = {"local": [], "submit": [], "snakemake": ["snakemake"],
          "slurm": ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel"]}
PATHS = os.environ["PATH"] + ":/usr/sbin:/sbin"
MODELS = ["limit-angle", "primal"]
GROUPS = {"usual": [], "coarse": ["predict.directions=24"]}
WAIT_SECONDS = 600  # for everything together, on a machine that does other work as well

# Stands for the program: the second task of the first model fails once. Every run is noted. The pause keeps tasks running while a daemon is killed.
WRAPPER = """#!/bin/bash
echo "$*" >> "{folder}/runs.txt"
if [[ "$*" == *"--models limit-angle"*"directions=24"* ]] && mkdir "{folder}/failed-once" 2>/dev/null; then
  echo "out of luck" >&2
  exit 1
fi
sleep {pause}
exec "{glint}" "$@"
"""


def until(holds, what, seconds=WAIT_SECONDS):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if holds():
            return True
        time.sleep(0.5)
    return common.check(False, "waited %d s for: %s" % (seconds, what))


def make_study(glint, project, folder, pause):
    wrapper = folder / "glint"
    wrapper.write_text(WRAPPER.format(folder=folder, glint=pathlib.Path(glint).resolve(), pause=pause))
    wrapper.chmod(0o755)
    shutil.copytree(project / "sessions" / "lessons" / "plane", folder / "plane")
    study = folder / "study.json"
    study.write_text(json.dumps({"glint_study": 1, "glint": "./glint", "scenes": {"plane": "plane/scene.json"}, "models": MODELS,
                                 "settings": GROUPS, "arguments": ["--train", "0-3"]}))
    return study


def check_results(glint, folder):
    with open(folder / "results" / "table.csv", encoding="utf-8", newline="") as table:
        rows = {(row["model"], row["settings"]): row for row in csv.DictReader(table)}
    common.check(len(rows) == 4, "four rows: %s" % sorted(rows))
    for model in MODELS:
        for group, settings in GROUPS.items():
            plain = folder / (model + group + ".json")
            common.run(glint, "evaluate", folder / "plane" / "scene.json", "--models", model, "--train", "0-3",
                       *[a for s in settings for a in ("--set", s)], "--json", plain)
            result = folder / "results" / "tasks" / "plane" / model / (group + ".json")
            if not common.check(result.exists(), "%s is missing" % result):
                continue
            a, b = common.masked(plain), common.masked(result)
            a["input"] = b["input"] = "the same file"  # as each named it
            common.check(not common.first_difference(a, b), "%s: %s" % (model, common.first_difference(a, b)))
            said = json.loads(plain.read_text())["models"][model]
            row = rows[(model, group)]
            common.check(row["status"] == said["status"] and row["mean_pct"] == "%.6g" % said["summary"]["contour_error_pct"]["mean"]
                         and row["predicted"] == str(said["summary"]["predicted"]), "the row of %s, %s: %s" % (model, group, row))
    runs = (folder / "runs.txt").read_text().splitlines()
    again = [r for r in runs if "--models limit-angle" in r and "directions=24" in r]
    common.check(len(again) >= 2, "the task that failed was repeated: %d runs" % len(again))


def study_py(project, *arguments, **more):
    return subprocess.run([sys.executable, "-B", str(project / "plugins" / "cluster" / "study.py"), *map(str, arguments)],
                          capture_output=True, text=True, timeout=WAIT_SECONDS, **more)


def local(glint, project, folder):
    study, results = make_study(glint, project, folder, 0), folder / "results"
    (folder / "failed-once").mkdir()  # later
    say = lambda *a: study_py(project, *a)
    done = say(study, "--engine", "local", "-o", results, "-j", "2")
    common.check(done.returncode == 0 and "4 tasks, 0 of them not done" in done.stdout, "all are done: %s%s" % (done.stdout, done.stderr))
    runs = len((folder / "runs.txt").read_text().splitlines())
    common.check(runs == 4, "each task ran once: %d" % runs)
    common.check(say(study, "--engine", "local", "-o", results).returncode == 0
                 and len((folder / "runs.txt").read_text().splitlines()) == runs, "what is there is not computed again")
    common.check(say("left", results).stdout == "", "nothing is left")
    # A result that is lost, and a task that fails.
    shutil.rmtree(results / "tasks" / "plane" / "primal")
    (folder / "failed-once").rmdir()
    failed = say("run", results, "2")
    common.check(failed.returncode == 1, "the second task fails: %s" % failed.stderr)
    common.check(say("left", results).stdout == "2\n3\n4\n", "three are left")
    table = say("collect", results, "-o", folder / "table.html")
    page = (folder / "table.html").read_text()
    common.check(table.returncode == 1 and "plane, limit-angle, coarse: failed: exit code 1: out of luck" in table.stdout
                 and "plane, primal, usual: missing" in table.stdout, "the table names them: %s" % table.stdout)
    common.check("2 missing" in page and "out of luck" in page and "<script" not in page, "the page names them")
    common.check(say("collect", results, "-o", folder / "table.txt").returncode == 2, "no such table")
    common.check(say(study, "--engine", "local", "-o", results, "-j", "2").returncode == 0, "what was left is done")
    check_results(glint, folder)
    # Another command for the same task is another task; a folder of others stays as it is.
    changed = json.loads(study.read_text())
    changed["settings"]["usual"] = ["predict.directions=36"]
    study.write_text(json.dumps(changed))
    before = len((folder / "runs.txt").read_text().splitlines())
    common.check(say(study, "--engine", "local", "-o", results).returncode == 0
                 and len((folder / "runs.txt").read_text().splitlines()) == before + 2, "changed tasks are done again")
    common.check(say(study, "--engine", "local", "-o", folder / "plane").returncode == 2 and not (folder / "plane" / "study.json").exists(),
                 "a folder of others")
    # Data without an answer are a result; input that is wrong is not tried again.
    wrong = {**changed, "scenes": {"none": "no-such.json"}, "models": ["primal"], "settings": {"usual": []}}
    (folder / "wrong.json").write_text(json.dumps(wrong))
    done = say(folder / "wrong.json", "--engine", "local", "-o", folder / "wrong")
    runs = [r for r in (folder / "runs.txt").read_text().splitlines() if "no-such" in r]
    common.check(done.returncode == 1 and "failed: exit code 2" in done.stdout and len(runs) == 1, "wrong input, once: %s" % done.stdout)
    refused(say, folder, changed)


def refused(say, folder, study):
    for wrong, says in (({"scenes": {"../x": "a"}}, "a name has"), ({"models": []}, "models"), ({"shards": 2}, "shards: unknown key"),
                        ({"glint_study": 2}, "is no study"), ({"arguments": "x"}, "arguments"), ({"settings": {"a": "b=c"}}, "settings.a")):
        file = folder / "wrong.json"
        file.write_text(json.dumps({**study, **wrong}))
        done = say(file, "--engine", "local", "-o", folder / "never")
        common.check(done.returncode == 2 and says in done.stderr and done.stderr.count("\n") == 1, "%s: %s" % (wrong, done.stderr))
    file.write_text(json.dumps(study))
    for arguments in ((file,), (file, "--engine", "cloud", "-o", "x"), (file, "--engine", "local", "-o", "x", "--fast"),
                      ("run", folder / "results", "5"), ("run", folder / "results", "x"), ("left", folder), ("collect", folder / "results")):
        done = say(*arguments)
        common.check(done.returncode == 2 and done.stderr.count("\n") == 1, "%s: %s" % (arguments, done.stderr))
    common.check(not (folder / "never").exists(), "nothing was written")


def snakemake(glint, project, folder):
    study = make_study(glint, project, folder, 0)
    environment = {**os.environ, "HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    # /usr/bin first: the package's Python modules are those of the system's Python.
    environment["PATH"] = "/usr/bin:" + environment["PATH"]
    command = (study, "--engine", "snakemake", "-o", folder / "results", "-j", "4")
    done = study_py(project, *command, env=environment)
    common.check(done.returncode == 0, "snakemake: %s%s" % (done.stdout[-1000:], done.stderr[-2000:]))
    check_results(glint, folder)
    runs = len((folder / "runs.txt").read_text().splitlines())
    done = study_py(project, *command, env=environment)
    common.check(done.returncode == 0 and len((folder / "runs.txt").read_text().splitlines()) == runs, "what is there is not computed again")


CONF = """ClusterName=glint
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SlurmdTimeout=60
KillWait=2
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=60 State=UP
"""


class Cluster:
    """munged, slurmctld and slurmd of one test, in its folder."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = {}
        sockets = [socket.socket() for _ in range(2)]
        for s in sockets:
            s.bind(("127.0.0.1", 0))
        ports = [s.getsockname()[1] for s in sockets]
        for s in sockets:
            s.close()
        key = folder / "munge.key"
        key.touch(mode=0o400)
        key.write_bytes(os.urandom(256))
        for name in ("state", "spool"):
            (folder / name).mkdir()
        self.conf = folder / "slurm.conf"
        self.conf.write_text(CONF.format(host=socket.gethostname().split(".")[0], ports=ports, folder=folder))
        self.environment = {**os.environ, "PATH": PATHS, "SLURM_CONF": str(self.conf)}

    def start(self, name, *arguments):
        log = open(self.folder / (name + ".output"), "ab")
        self.processes[name] = subprocess.Popen([name, *map(str, arguments)], stdout=log, stderr=log, env=self.environment,
                                                start_new_session=True)

    def start_all(self):
        f = self.folder
        self.start("munged", "--foreground", "--force", "--key-file=%s" % (f / "munge.key"), "--socket=%s" % (f / "munge.socket"),
                   "--pid-file=%s" % (f / "munge.pid"), "--log-file=%s" % (f / "munge.log"), "--seed-file=%s" % (f / "munge.seed"))
        until(lambda: (f / "munge.socket").exists(), "munged", 60)
        self.start("slurmctld", "-D", "-f", self.conf)
        self.start_node()
        return until(lambda: self.say("sinfo", "-h", "-o", "%T").strip() == "idle", "an idle node", 120)

    def start_node(self):
        self.start("slurmd", "-D", "-f", self.conf)

    def say(self, *command):
        return subprocess.run(command, capture_output=True, text=True, env=self.environment, timeout=60).stdout

    def kill_node(self):
        self.processes["slurmd"].send_signal(signal.SIGKILL)
        self.processes["slurmd"].wait()

    def own(self):
        """Processes of this test that are left: what names its folder, such as the steps of jobs."""
        found = []
        for entry in pathlib.Path("/proc").iterdir():
            if entry.name.isdigit() and int(entry.name) != os.getpid():
                try:
                    line = (entry / "cmdline").read_bytes() + b" " + (entry / "environ").read_bytes()
                except OSError:
                    continue
                if str(self.folder).encode() in line:
                    found.append(int(entry.name))
        return found

    def end_all(self):
        for name in ("slurmd", "slurmctld", "munged"):
            process = self.processes.get(name)
            if process and process.poll() is None:
                process.terminate()
        for process in self.processes.values():
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        for pid in self.own():
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        until(lambda: not self.own(), "the end of all processes", 30)

    def logs(self):
        for name in ("munged.output", "slurmctld.log", "slurmd.log", "slurmd.output", "slurmctld.output"):
            if (self.folder / name).exists():
                print("---- %s\n%s" % (name, (self.folder / name).read_text(errors="replace")[-3000:]))


# Runs what it is given at once, with the environment of its caller, as a cluster of one node would: an array's tasks one after the other.
SBATCH = r"""#!/usr/bin/env python3
import os, re, subprocess, sys
script, wrap, tasks, output, environment = None, None, [None], "", dict(os.environ)
for word in sys.argv[1:]:
    name, _, value = word.partition("=")
    if name == "--wrap":
        wrap = value
    elif name == "--array":
        tasks = [n for part in value.split(",") for a, b in [(part.split("-") * 2)[:2]] for n in range(int(a), int(b) + 1)]
    elif name == "--output":
        output = value
    elif name == "--export":  # Slurm's list: ALL, and NAME=VALUE between commas
        environment.update(part.split("=", 1) for part in value.split(",") if "=" in part)
    elif not word.startswith("--"):
        script = word
for n in tasks:
    file = re.sub("%[%aA]", lambda m: {"%%": "%", "%a": str(n), "%A": "1"}[m.group()], output)
    again = os.path.join(os.path.dirname(sys.argv[0]), "again")
    for repeats in "012":
        with open(file, "a") as log:
            given = {**environment, "SLURM_ARRAY_TASK_ID": str(n), "SLURM_JOB_ID": "1", "SLURM_RESTART_COUNT": repeats}
            subprocess.run(["sh", "-c", wrap] if wrap else ["bash", script], env=given, stdout=log, stderr=log)
        if not os.path.exists(again):
            break
        os.remove(again)
print("1")
"""
SCONTROL = """#!/bin/sh
touch "$(dirname "$0")/again" && kill "$PPID"
"""


def submit(glint, project, folder):
    """Slurm's engine with a stand-in for Slurm: names with the characters that its options and shells take for their own."""
    binaries = folder / "bin"
    binaries.mkdir()
    for name, text in (("sbatch", SBATCH), ("scontrol", SCONTROL)):
        (binaries / name).write_text(text)
        (binaries / name).chmod(0o755)
    odd = folder / "it's 50%a, a study"
    odd.mkdir()
    shutil.copytree(project / "plugins" / "cluster", odd / "cluster")
    study = make_study(glint, project, odd, 0)
    done = subprocess.run([str(odd / "cluster" / "study.py"), str(study), "--engine", "slurm", "-o", str(odd / "results")], capture_output=True,
                          text=True, timeout=300, env={**os.environ, "PATH": "%s:%s" % (binaries, os.environ["PATH"])})
    common.check(done.returncode == 0 and "4 tasks" in done.stdout, "study.py: %s%s" % (done.stdout, done.stderr))
    logs = {f.name: f.read_text() for f in (odd / "results" / "logs").iterdir()}
    common.check("0 of them not done" in logs.get("table.txt", ""), "the table says what it has: %s" % logs)
    check_results(glint, odd)


def slurm(glint, project, folder):
    if os.geteuid() != 0:
        print("skipped: Slurm's daemons need root")
        return 77
    if not os.path.ismount("/sys/fs/cgroup"):
        print("skipped: slurmd needs a file system of control groups at /sys/fs/cgroup")
        return 77
    cluster = Cluster(folder)
    try:
        study = make_study(glint, project, folder, 5)
        if not cluster.start_all():
            return cluster.logs()
        done = study_py(project, study, "--engine", "slurm", "-o", folder / "results", env=cluster.environment)
        if not common.check(done.returncode == 0 and "4 tasks" in done.stdout, "study.py: %s%s" % (done.stdout, done.stderr)):
            return cluster.logs()
        # Not as soon as Slurm says that it runs: a task that the daemon has not started yet would be a lost launch, which Slurm notices late.
        until(lambda: (folder / "runs.txt").exists(), "a task that computes")
        cluster.kill_node()
        time.sleep(2)
        cluster.start_node()
        if not until(lambda: not cluster.say("squeue", "-h").strip() and (folder / "results" / "table.csv").exists(), "the study"):
            print(cluster.say("squeue", "-o", "%i %j %T %r"))
            return cluster.logs()
        check_results(glint, folder)
        logs = "".join(f.read_text() for f in (folder / "results" / "logs").iterdir())
        common.check("it is repeated" in logs, "Slurm repeated it: %s" % logs)
        common.check("0 of them not done" in logs, "the table says what it has: %s" % logs)
    finally:
        if cluster.processes:
            cluster.say("scancel", "--user=root")
        cluster.end_all()
    common.check(not cluster.own(), "all processes are ended")


def main():
    glint, project, engine = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
    missing = [name for name in NEEDED[engine] if not shutil.which(name, path=PATHS)]
    if missing:
        print("skipped: %s is not installed (resources/setup/packages-hosts.txt)" % ", ".join(missing))
        return 77
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # a test that is ended from outside ends its daemons, too
    # Short, because a socket's path has at most 107 bytes.
    folder = pathlib.Path(tempfile.mkdtemp(prefix="glint-study-"))
    try:
        code = {"local": local, "submit": submit, "snakemake": snakemake, "slurm": slurm}[engine](glint, project, folder)
        return code if code == 77 else common.finish()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
