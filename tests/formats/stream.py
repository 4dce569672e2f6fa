#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`glint predict --stream` as a tracker meets it: answers at once, wrong lines and lost tracking, the end, nobody who reads, Ctrl-C.

    tests/formats/stream.py GLINT SESSION      sessions/ellipsoid/ellipsoid.glint: one camera, one surface"""
import json
import math
import os
import pathlib
import select
import signal
import subprocess
import sys
import tempfile
import time

failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED: " + what)


def start(glint, session, *more, **pipes):
    return subprocess.Popen([glint, "predict", session, "--stream", *more],
                            **{"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **pipes})


def ask(process, line, seconds=60):
    """One line in, one line out, although the input goes on."""
    process.stdin.write(line if isinstance(line, bytes) else (json.dumps(line) + "\n").encode())
    process.stdin.flush()
    check(bool(select.select([process.stdout], [], [], seconds)[0]), "no answer while the stream goes on")
    return json.loads(process.stdout.readline())


def main():
    glint, session = sys.argv[1], pathlib.Path(sys.argv[2])
    scene = json.loads((session.parent / json.loads(session.read_text("utf-8"))["input"]["path"]).read_text("utf-8"))
    matrix, frame_id = scene["frames"][0]["camera_from_world"], scene["frames"][0]["id"]
    pose = {"id": "live", "time": 1.5, "camera_from_world": matrix}

    process = start(glint, session)
    answer = ask(process, pose)
    check(answer["status"] == "ok" and answer["id"] == "live" and answer["time"] == 1.5 and answer["frame"] is None, "a new id: %s" % answer)
    check({"light", "model", "peak", "coverage", "contour"} <= set(answer["highlights"][0]), "keys of a highlight")
    check(0 < answer["time_us"] < 1e7, "time_us")
    named = ask(process, dict(pose, id=frame_id))
    check(named["frame"] == 0 and named["highlights"] == answer["highlights"], "the id of a frame: its surface and lights are those of all")
    half = dict(scene["camera"], width=scene["camera"]["width"] // 2, fx=scene["camera"]["fx"] / 2, fy=scene["camera"]["fy"] / 2,
                cx=scene["camera"]["cx"] / 2, cy=scene["camera"]["cy"] / 2)
    smaller = ask(process, dict(pose, camera=half))
    # Half of the focal length and of the principal point: half of the pixels, as similar triangles say.
    for a, b in zip(answer["highlights"], smaller["highlights"]):
        if a["model"] in ("primal", "dual", "canonical") and len(a["contour"]) == len(b["contour"]):
            check(max(abs(u - 2 * v) for p, q in zip(a["contour"], b["contour"]) for u, v in zip(p, q)) < 1e-2,
                  "a camera of its own: " + a["model"])
    bent = ask(process, dict(pose, camera=dict(scene["camera"], distortion=[0.1, 0, 0, 0, 0])))
    check(all(len(h["contour_measured"]) == len(h["contour"]) for h in bent["highlights"]) and bent["highlights"], "contour_measured")
    # k1 alone: x (1 + k1 r^2), written out.
    camera = scene["camera"]
    worst = 0.0
    for ideal, measured in zip(bent["highlights"][0]["contour"], bent["highlights"][0]["contour_measured"]):
        x, y = (ideal[0] - camera["cx"]) / camera["fx"], (ideal[1] - camera["cy"]) / camera["fy"]
        factor = 1 + 0.1 * (x * x + y * y)
        worst = max(worst, math.dist(measured, [camera["cx"] + camera["fx"] * x * factor, camera["cy"] + camera["fy"] * y * factor]))
    check(worst < 1e-9, "the lens of contour_measured: %.3g px" % worst)

    away = [[-v for v in matrix[0]], matrix[1], [-v for v in matrix[2]], matrix[3]]  # turned by 180 degrees about its y
    behind = ask(process, dict(pose, camera_from_world=away))
    check(behind["status"] == "failed" and not behind["highlights"] and behind["reason"] and behind["failures"], "looking away: %s" % behind)

    wrong = [(b"{\"id\": \"7\", \"camera_from_world\": 5}\n", "7", "camera_from_world"), (b"{\"id\": \n", None, "not valid JSON"),
             (b"1 2 3\n", None, "8 numbers"), (b"\xff\xfe\x00{}\n", None, "standard input: line"),
             (b"{" + b" " * 70000 + b"}\n", None, "longer than"), (b"[" * 60000 + b"\n", None, "line"),
             (b"{\"a\":" * 9000 + b"\n", None, "nested deeper"), (json.dumps(dict(pose, id="x\x1b[31m")).encode() + b"\n", None, "control")]
    for line, known, reason in wrong:
        answer = ask(process, line)
        check(answer["status"] == "error" and answer["id"] == known and reason in answer["reason"] and answer["line"] > 0 and
              not answer["highlights"], "%s: %s" % (line[:40], answer))
    for line in (b"3.5 nan nan nan nan nan nan nan\n", json.dumps(dict(pose, camera_from_world=None)).encode() + b"\n",
                 json.dumps(dict(pose, camera_from_world=[[float("nan")] * 4] * 4)).encode() + b"\n"):
        answer = ask(process, line)
        check(answer["status"] == "failed" and "tracking was lost" in answer["reason"], "lost: %s" % answer)
    check(ask(process, pose)["status"] == "ok", "the stream goes on")
    rest, errors = process.communicate(b"\n# a comment\n" + json.dumps(pose).encode(), timeout=60)  # without a line end
    check(process.returncode == 0 and rest.count(b"\n") == 1, "the end: exit code %d, %d answers" % (process.returncode, rest.count(b"\n")))
    check(b"%d lines were wrong" % len(wrong) in errors, "wrong lines are counted: %r" % errors)
    check(rest.isascii(), "ASCII")

    # No pose at all; a file; a pipe with a name; what cannot be read.
    check(subprocess.run([glint, "predict", session, "--stream"], stdin=subprocess.DEVNULL, capture_output=True).stdout == b"", "no pose")
    with tempfile.TemporaryDirectory() as name:
        file = pathlib.Path(name) / "poses.txt"
        file.write_text("# TUM\n0.5 0 0 3 0 0 0 1\n" + json.dumps(pose) + "\n", "utf-8")
        done = subprocess.run([glint, "predict", session, "--stream", "--poses", file], capture_output=True)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        check(done.returncode == 0 and [line["id"] for line in lines] == ["0.5", "live"] and lines[1]["status"] == "ok", "a file: %s" % done)
        pipe = pathlib.Path(name) / "pipe"
        os.mkfifo(pipe)
        process = start(glint, session, "--poses", str(pipe), stdin=subprocess.DEVNULL)
        with open(pipe, "w", encoding="utf-8") as out:
            out.write(json.dumps(pose) + "\n")
            out.flush()
            check(json.loads(process.stdout.readline())["status"] == "ok", "a named pipe, still open")
        check(process.wait(60) == 0, "the end of a named pipe")
        for poses, reason in ((name, b"folder"), (str(file) + "x", b"cannot be opened")):
            done = subprocess.run([glint, "predict", session, "--stream", "--poses", poses], capture_output=True)
            check(done.returncode == 2 and reason in done.stderr and done.stderr.count(b"\n") == 1, "%s: %s" % (poses, done))
    for more in (["--out", "x"], ["--json", "-"], ["--frames", "0"], ["--masks", "x"]):
        done = subprocess.run([glint, "predict", session, "--stream", *more], stdin=subprocess.DEVNULL, capture_output=True)
        check(done.returncode == 2 and more[0].encode() in done.stderr, "%s: %s" % (more, done))
    done = subprocess.run([glint, "predict", session, "--poses", "-"], stdin=subprocess.DEVNULL, capture_output=True)
    check(done.returncode == 2 and b"needs --stream" in done.stderr, "--poses alone: %s" % done)

    # Standard deviations where they are asked for: of a frame's own pose those of `predict --json`.
    frame = scene["frames"][3]
    own = json.dumps({"id": frame["id"], "camera_from_world": frame["camera_from_world"]}).encode()
    bands = [json.loads(subprocess.run([glint, "predict", session, "--stream", *more], input=own, capture_output=True).stdout)["highlights"]
             for more in ([], ["--set", "predict.band=true"])]
    check(bands[0] and not any("sigma_px" in h for h in bands[0]), "sigma_px without being asked for")
    written = json.loads(subprocess.run([glint, "predict", session, "--frames", "3", "--json", "-"], capture_output=True).stdout)
    listed = {name: [h["sigma_px"] for f in frames for h in f["highlights"]] for name, frames in written["models"].items()}
    for h in bands[1]:
        check(len(h["sigma_px"]) == len(h["contour"]) and h["sigma_px"] in listed[h["model"]], "sigma_px of %s" % h["model"])
    check([h["contour"] for h in bands[0]] == [h["contour"] for h in bands[1]], "bands move no contour")

    # Frames with surfaces of their own: a pose of another place has no surface, and says so.
    several = session.parent.parent / "plane-to-cylinder" / "plane-to-cylinder.glint"
    frame = json.loads((several.parent / "scene.json").read_text("utf-8"))["frames"][3]
    process = start(glint, several)
    known = ask(process, {"id": frame["id"], "camera_from_world": frame["camera_from_world"]})
    unknown = ask(process, {"id": "live", "camera_from_world": frame["camera_from_world"]})
    process.communicate(timeout=60)
    check(known["frame"] == 3 and {h["model"] for h in known["highlights"]} == {"primal", "dual", "canonical", "limit-angle"},
          "a frame with its own surface: %s" % known["failures"])
    check({h["model"] for h in unknown["highlights"]} == {"primal"} and
          all("no surface" in f["reason"] for f in unknown["failures"]) and unknown["failures"], "no surface: %s" % unknown)

    # No model can be fitted: said before the first answer.
    with tempfile.TemporaryDirectory() as name:
        few = pathlib.Path(name) / "few.glint"
        few.write_text(json.dumps({"glint_session": 3, "input": {"path": str((session.parent / "scene.json").resolve())},
                                   "request": {"models": ["canonical"], "train": "0,1"}}), "utf-8")
        done = subprocess.run([glint, "predict", few, "--stream", "--allow-outside"], input=json.dumps(pose).encode(), capture_output=True)
        check(done.returncode == 3 and done.stdout == b"" and b"too few views" in done.stderr, "two views: %s" % done)

    # Nobody reads any more: it ends by itself, and says so in one line.
    process = start(glint, session)
    ask(process, pose)
    process.stdout.close()
    try:
        process.stdin.write((json.dumps(pose) + "\n").encode() * 2)
        process.stdin.flush()
    except BrokenPipeError:
        pass
    check(process.wait(60) == 2, "nobody reads: exit code %d" % process.returncode)
    said = process.stderr.read() if process.stderr else b""
    check(b"glint: standard output: was closed by its reader after 1 answer\n" in said, "nobody reads: it says so: %r" % said)

    # Ctrl-C while it waits for a pose: the quickest of three, as the machine may be busy.
    times = []
    for _ in range(3):
        process = start(glint, session)
        ask(process, pose)
        time.sleep(0.2)
        before = time.monotonic()
        process.send_signal(signal.SIGINT)
        code = process.wait(60)
        times.append(time.monotonic() - before)
        check(code == 130 and process.stdout.read() == b"", "Ctrl-C: exit code %d" % code)
    check(min(times) < 0.2, "Ctrl-C took %.3f s" % min(times))
    print("Ctrl-C ended the stream after %.0f ms" % (1e3 * min(times)))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
