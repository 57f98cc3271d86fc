"""What the Python package costs: its import, a pose in one call of many and in a call of its own, designs on two threads,
and how soon Ctrl-C ends a long call.

    pip install mechanim
    python benches/peers/package.py

A pose of many stands beside the column "solve" of `cargo bench --bench pose`. Best of several runs.
"""

import os
import signal
import subprocess
import sys
import threading
import time

import mechanim
import numpy as np

RUNS = 7


def best(run, runs=RUNS):
    times = []
    for _ in range(runs):
        begun = time.perf_counter()
        run()
        times.append(time.perf_counter() - begun)
    return min(times)


def import_time():
    """Milliseconds of `import mechanim` beyond those of its only requirement."""
    script = "import time, numpy; a = time.perf_counter(); import mechanim; print(1e3*(time.perf_counter() - a))"
    runs = [subprocess.run([sys.executable, "-c", script], capture_output=True, text=True) for _ in range(RUNS)]
    return min(float(run.stdout) for run in runs)


def one_call_a_pose(scene):
    """Microseconds of a call that solves one pose from the start values."""
    row = {name: np.array([value]) for name, value in zip(scene.inputs, first_inputs(scene))}
    calls = 200
    return best(lambda: [scene.solve(inputs=row) for _ in range(calls)]) / calls * 1e6


def first_inputs(scene):
    motion = scene.solve(samples=2)
    return [motion[name][0] for name in scene.inputs]


def answer_to_interrupt(work):
    """Milliseconds from Ctrl-C, 0.8 s after the start of `work`, to the exception."""
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.8, interrupt)
    timer.start()
    try:
        work()
    except KeyboardInterrupt:
        return 1e3 * (time.monotonic() - sent[0])
    finally:
        timer.cancel()
    raise SystemExit("the work ended before it was interrupted")


def main():
    print(f"import mechanim: {import_time():.1f} ms beyond numpy's")
    print()
    print("| scene | µs a pose, one call | µs a call, one pose |")
    print("|---|---|---|")
    for name in ["slider-crank", "seven-r", "gearshift"]:
        scene = mechanim.load(name)
        count = 2000
        many = best(lambda: scene.solve(samples=count)) / count * 1e6
        print(f"| {name} | {many:.1f} | {one_call_a_pose(scene):.1f} |")
    scene = mechanim.load("gearshift")
    designs = {"L4": 880 + 0.001 * np.arange(8000)}
    one, two = (best(lambda: scene.sweep(designs, ["M.x"], samples=27, threads=n), 3) for n in (1, 2))
    print()
    print(f"sweep of 8000 gearshifts with 27 poses: {one:.2f} s on one thread, {two:.2f} s on two: {one / two:.2f} times")
    long = {
        "solve": lambda: scene.solve(samples=400_000),
        "check": lambda: mechanim.load("dyads").check(samples=20_000, motion=True),
        "sweep": lambda: mechanim.load("slider-crank").sweep({"L": [90.0] * 200_000}, ["h"], samples=60),
    }
    waits = [f"{name} {max(answer_to_interrupt(work) for _ in range(RUNS)):.0f}" for name, work in long.items()]
    print(f"Ctrl-C ends a long call, longest of {RUNS} waits in ms: " + ", ".join(waits))


main()
