#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A small study under each engine of plugins/cluster: one scene, two models, two shards each. One shard fails at its first run and is repeated;
under Slurm the node's daemon is killed and started again meanwhile. The results are those of runs without shards, to the last bit, times aside.

    tests/shards/study_engines.py GLINT PROJECT loop|submit|snakemake|slurm

Skipped (77), by name, where the engine is not installed, and Slurm without root. Slurm's daemons run with a key, sockets and ports of this test and
without systemd; all are ended by their process ids."""
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

NEEDED = {"loop": [], "submit": [], "snakemake": ["snakemake"],
          "slurm": ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel"]}
PATHS = os.environ["PATH"] + ":/usr/sbin:/sbin"
MODELS = ["limit-angle", "primal"]
SHARDS = 2
WAIT_SECONDS = 600  # for everything together, on a machine that does other work as well

# Stands for the program: the second shard of the first model fails once. Every run is noted. The pause keeps tasks running while a daemon is killed.
WRAPPER = """#!/bin/bash
echo "$*" >> "{folder}/runs.txt"
if [[ "$*" == *"--models limit-angle"*"--shard 2/2"* ]] && mkdir "{folder}/failed-once" 2>/dev/null; then
  echo "out of luck" >&2
  exit 1
fi
[ "$1" = merge ] || sleep {pause}
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
    study.write_text(json.dumps({"glint_study": 1, "glint": "./glint", "out": "results", "shards": SHARDS,
                                 "scenes": {"plane": "plane/scene.json"}, "models": MODELS, "arguments": ["--train", "0-3"]}))
    return study


def check_results(glint, folder):
    for model in MODELS:
        whole = folder / (model + ".json")
        common.run(glint, "evaluate", folder / "plane" / "scene.json", "--models", model, "--train", "0-3", "--json", whole)
        merged = folder / "results" / "plane" / (model + ".json")
        if common.check(merged.exists(), "%s is missing" % merged):
            a, b = common.masked(whole), common.masked(merged)
            a["input"] = b["input"] = "the same file"  # as each named it
            common.check(not common.first_difference(a, b), "%s: %s" % (model, common.first_difference(a, b)))
    runs = (folder / "runs.txt").read_text().splitlines()
    again = [r for r in runs if "--models limit-angle" in r and "--shard 2/2" in r]
    common.check(len(again) >= 2, "the shard that failed was repeated: %d runs" % len(again))


def study_py(project, study, *arguments):
    return subprocess.run([sys.executable, "-B", str(project / "plugins" / "cluster" / "study.py"), str(study), *arguments],
                          capture_output=True, text=True)


def loop(glint, project, folder):
    study = make_study(glint, project, folder, 0)
    say = lambda *a: study_py(project, study, *a)
    common.check(say("count").stdout == "4\n", "four shards")
    common.check(say("left").stdout == "1-4\n", "all are left")
    codes = [say("run", str(n)).returncode for n in range(1, 5)]
    common.check(codes == [0, 1, 0, 0], "the second fails: %s" % codes)
    common.check(say("left").stdout == "2\n", "it is left")
    merged = say("merge")
    common.check(merged.returncode == 1 and "shards 2 are missing" in merged.stdout, "merge names it: %s" % merged.stdout)
    common.check(say("run", "2").returncode == 0 and say("merge").returncode == 0, "repeated, then merged")
    common.check(say("left").stdout == "\n" and say("cost").returncode == 0, "nothing is left")
    check_results(glint, folder)
    for wrong, says in (({"shards": 0}, "shards"), ({"scenes": {"../x": "a"}}, "a name has"), ({"models": []}, "models"),
                        ({"typo": 1}, "typo: unknown key"), ({"glint_study": 2}, "is no study"), ({"arguments": "x"}, "arguments")):
        file = folder / "wrong.json"
        file.write_text(json.dumps({**json.loads(study.read_text()), **wrong}))
        done = study_py(project, file, "count")
        common.check(done.returncode == 2 and says in done.stderr and done.stderr.count("\n") == 1, "%s: %s" % (wrong, done.stderr))
    common.check(say("run", "5").returncode == 2 and say("run", "x").returncode == 2, "no such shard")


def snakemake(glint, project, folder):
    study = make_study(glint, project, folder, 0)
    command = ["snakemake", "-s", str(project / "plugins" / "cluster" / "Snakefile"), "--cores", "4", "--config", "study=" + str(study)]
    environment = {**os.environ, "HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    # /usr/bin first: the package's Python modules are those of the system's Python.
    environment["PATH"] = "/usr/bin:" + environment["PATH"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment, timeout=WAIT_SECONDS)
    common.check(done.returncode == 0, "snakemake: %s" % done.stderr[-2000:])
    check_results(glint, folder)
    runs = len((folder / "runs.txt").read_text().splitlines())
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment, timeout=WAIT_SECONDS)
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
    file = re.sub("%%|%a", lambda m: "%" if m.group() == "%%" else str(n), output)
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
    """submit.sh with a stand-in for Slurm: names with the characters that its options and shells take for their own."""
    binaries = folder / "bin"
    binaries.mkdir()
    for name, text in (("sbatch", SBATCH), ("scontrol", SCONTROL)):
        (binaries / name).write_text(text)
        (binaries / name).chmod(0o755)
    odd = folder / "it's 50%a, a study"
    odd.mkdir()
    shutil.copytree(project / "plugins" / "cluster", odd / "cluster")
    study = make_study(glint, project, odd, 2)
    done = subprocess.run([str(odd / "cluster" / "submit.sh"), str(study)], capture_output=True, text=True, timeout=300,
                          env={**os.environ, "PATH": "%s:%s" % (binaries, os.environ["PATH"])})
    common.check(done.returncode == 0, "submit.sh: %s%s" % (done.stdout, done.stderr))
    logs = {f.name: f.read_text() for f in (odd / "logs").iterdir()} if (odd / "logs").is_dir() else {}
    common.check("plane, limit-angle: " in logs.get("merge.txt", ""), "the merge says what it merged: %s" % logs)
    check_results(glint, odd)


def slurm(glint, project, folder):
    if os.geteuid() != 0:
        print("skipped: Slurm's daemons need root")
        return 77
    if not os.path.ismount("/sys/fs/cgroup"):
        print("skipped: slurmd needs a file system of control groups at /sys/fs/cgroup")
        return 77
    if os.environ.get("GLINT_TEST_SLURM") != "1":
        print("skipped: it waits for Slurm's timers for seven minutes; GLINT_TEST_SLURM=1 runs it, as the nightly script does")
        return 77
    cluster = Cluster(folder)
    try:
        study = make_study(glint, project, folder, 5)
        if not cluster.start_all():
            return cluster.logs()
        done = subprocess.run([str(project / "plugins" / "cluster" / "submit.sh"), str(study)], capture_output=True, text=True,
                              env=cluster.environment, timeout=120)
        if not common.check(done.returncode == 0 and "shards 1-4" in done.stdout, "submit.sh: %s%s" % (done.stdout, done.stderr)):
            return cluster.logs()
        # Not as soon as Slurm says that it runs: a task that the daemon has not started yet would be a lost launch, which Slurm notices late.
        until(lambda: (folder / "runs.txt").exists(), "a task that computes")
        cluster.kill_node()
        time.sleep(2)
        cluster.start_node()
        if not until(lambda: not cluster.say("squeue", "-h").strip() and (folder / "logs" / "merge.txt").exists(), "the study"):
            print(cluster.say("squeue", "-o", "%i %j %T %r"))
            return cluster.logs()
        check_results(glint, folder)
        logs = "".join(f.read_text() for f in (folder / "logs").iterdir())
        common.check("it is repeated" in logs, "Slurm repeated it: %s" % logs)
        common.check("plane, limit-angle: " in logs, "the merge says what it merged: %s" % logs)
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
        code = {"loop": loop, "submit": submit, "snakemake": snakemake, "slurm": slurm}[engine](glint, project, folder)
        return code if code == 77 else common.finish()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
