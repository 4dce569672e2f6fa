# SPDX-License-Identifier: BSD-3-Clause
"""Long work: other threads run on, progress is told, and it stops when it is asked to."""
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import glint
import scenes

SESSIONS = pathlib.Path(__file__).resolve().parents[2] / "sessions"
LONG = SESSIONS / "two-lamps/two-lamps.glint"  # seconds


def test_progress_counts_up():
    events = []
    glint.inspect(glint.open(SESSIONS / "plane/plane.glint"), ["dual"], progress=lambda *event: events.append(event))
    assert {stage for stage, _, _ in events} >= {"detect", "fit dual"}
    for stage in {stage for stage, _, _ in events}:
        done = [d for s, d, _ in events if s == stage]
        assert done[0] == 0 and all(isinstance(d, int) for d in done)
    assert all(d <= total for _, d, total in events if total)


@pytest.mark.parametrize("after", [0, 3])
def test_a_function_that_returns_false_stops(after):
    calls = []

    def stop(*event):
        calls.append(event)
        return len(calls) <= after

    with pytest.raises(glint.Stopped):
        glint.inspect(glint.open(LONG), progress=stop)
    assert len(calls) == after + 1  # not asked again
    assert isinstance(glint.Stopped("x"), glint.Error)


def test_a_function_that_returns_nothing_goes_on():
    assert glint.inspect(glint.open(SESSIONS / "plane/plane.glint"), ["dual"], progress=lambda *_: None).train


def test_what_a_function_raises_comes_out():
    class Mine(Exception):
        pass

    def fail(stage, done, total):
        if done == 2:
            raise Mine("from the callback")

    with pytest.raises(Mine, match="from the callback"):
        glint.inspect(glint.open(LONG), progress=fail)


def test_a_wrong_function_is_refused():
    with pytest.raises(TypeError, match="progress: expected a function"):
        glint.inspect(glint.open(LONG), progress=3)
    with pytest.raises(TypeError):  # takes other arguments
        glint.inspect(glint.open(LONG), progress=lambda: True)


def test_another_thread_runs_on():
    """While a computation runs in this thread, another one counts: the interpreter's lock is released."""
    ticks, stop = [], threading.Event()

    def count():
        while not stop.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    scene = glint.open(LONG)
    thread = threading.Thread(target=count)
    thread.start()
    try:
        start = time.monotonic()
        glint.inspect(scene, ["limit-angle"])  # without a progress function: nothing hands the lock over but Glint itself
        end = time.monotonic()
    finally:
        stop.set()
        thread.join()
    inside = [t for t in ticks if start < t < end]
    assert end - start > 0.2, "too short to tell"
    # Evenly: at no time was the lock held for most of the work. A held one gives a single gap as long as the work.
    assert max(np.diff([start, *inside, end])) < 0.5 * (end - start) and len(inside) > 20


def test_two_inspections_at_once_are_the_same_as_one_after_the_other():
    scene = glint.open(SESSIONS / "ellipsoid/ellipsoid.glint")
    one = glint.inspect(scene, ["dual", "canonical"])
    results = [None, None]

    def work(i):
        results[i] = glint.inspect(scene, ["dual", "canonical"])

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    for other in results:
        for model in ("dual", "canonical"):
            assert np.array_equal(one.models[model].fits[0].fit.q_dual, other.models[model].fits[0].fit.q_dual)


@pytest.mark.parametrize("progress", ["None", "lambda *event: None"])
def test_ctrl_c_stops_the_computation(progress):
    script = f"""
import sys, time, glint
scene = glint.open({str(SESSIONS / 'vase/vase.glint')!r})
print("ready", flush=True)
try:
    glint.inspect(scene, progress={progress})
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(0)
print("went on to the end")
"""
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    assert child.communicate(timeout=60)[0] == "interrupted\n" and child.returncode == 0


def test_rays_can_be_stopped():
    surface = glint.mesh(*scenes.grid_mesh(40))
    with pytest.raises(glint.Stopped):
        surface.first_hits([[0, 0, 1]], np.tile([[0.0, 0, -1]], (5000, 1)), progress=lambda *_: False)
