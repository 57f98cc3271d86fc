"""Time and error of optimisers on the gearshift's objective F(L6s, ZR1), beside `mechanim optimise` in one run.

    pip install numpy scipy numba
    python benches/peers/optimisers.py target/release/mechanim

The SciPy side is written as the authors of the lecture would: the chains as products of 4x4 matrices, three
entries of the rotation and the translation of each loop as equations (18 of them), `fsolve` from pose to pose, then the
sums of the tracks. `numba` compiles the equations; the rest is SciPy's. Each side runs by itself on one core; CPU
seconds include everything from process start for mechanim, and leave compilation and imports out for SciPy. mechanim
also proves its result and checks the clearances of its bodies; SciPy's side does neither, so that there is a row without
the clearances, too.
"""

import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
from numba import njit
from scipy.optimize import differential_evolution, fsolve, minimize

BEST = 6.5099789e-5  # 40-digit arithmetic, Nelder-Mead to the end
START = np.array([110.0, 270.0])
BOUNDS = [(20.0, 200.0), (200.0, 340.0)]
TRACKS = [0.2, 0.0, -0.2]
SHIFTS = np.linspace(-17.0, 17.0, 9)

L3k, L4, L5d, XR1, YR1 = 60.0, 880.0, 110.0, 930.0, 60.0
L5h, L6v, L7, L4v, L4s = 100.0, 130.0, 297.0, 65.0, 795.0
L6r, L6h, L8r, L8s = 120.0, 30.0, 30.0, 65.0
XS1, YS1, ZS1 = 1080.0, 70.0, 285.0
HANDLE = np.array([-40.0, 0.0, 430.0, 1.0])


@njit
def turn(axis, angle):
    m = np.eye(4)
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


@njit
def shift(x, y, z):
    m = np.eye(4)
    m[0, 3], m[1, 3], m[2, 3] = x, y, z
    return m


@njit
def chains(a, p, phi, l6s, zr1):
    t14 = shift(p, 0, 0) @ turn(0, phi) @ turn(1, a[0]) @ shift(L3k, 0, 0) @ turn(2, a[1])
    t45 = shift(L4, 0, 0) @ turn(0, a[2]) @ turn(1, a[3]) @ turn(2, a[4]) @ shift(0, 0, L5d)
    t51 = turn(1, a[5]) @ shift(-XR1, -YR1, -zr1)
    t15 = shift(XR1, YR1, zr1) @ turn(1, -a[5])
    t56 = shift(0, 0, L5h) @ turn(0, a[6]) @ turn(1, a[7]) @ turn(2, a[8])
    t67 = shift(-l6s, L6v, 0) @ turn(0, a[9]) @ turn(1, a[10]) @ turn(2, a[11])
    t74 = shift(0, 0, -L7) @ turn(0, a[12]) @ turn(1, a[13]) @ shift(-L4s, L4v, 0)
    t68 = shift(L6r, 0, L6h) @ turn(1, a[14]) @ shift(L8r, 0, -L8s)
    t81 = turn(0, a[15]) @ turn(1, a[16]) @ turn(2, a[17]) @ shift(-XS1, -YS1, -ZS1)
    return t14 @ t45 @ t51, t45 @ t56 @ t67 @ t74, t15 @ t56 @ t68 @ t81, t15 @ t56 @ t68


@njit
def equations(a, p, phi, l6s, zr1):
    one, two, three, _ = chains(a, p, phi, l6s, zr1)
    rows = np.empty(18)
    k = 0
    for m in (one, two, three):
        rows[k], rows[k + 1], rows[k + 2] = m[0, 1], m[0, 2], m[1, 2]
        rows[k + 3], rows[k + 4], rows[k + 5] = m[0, 3] / 100, m[1, 3] / 100, m[2, 3] / 100
        k += 6
    return rows


class Objective:
    """F by `fsolve`, every pose from its neighbour, every mechanism from the one before."""

    def __init__(self):
        self.calls = 0
        self.neutral = np.zeros(18)

    def pose(self, a, p, phi, x):
        a, info, found, _ = fsolve(equations, a, args=(p, phi, *x), full_output=True, xtol=1e-12)
        if found != 1 and np.abs(info["fvec"]).max() > 1e-9:
            raise ArithmeticError
        return a

    def __call__(self, x):
        self.calls += 1
        try:
            self.neutral = self.pose(self.neutral, 0.0, 0.0, x)
            return sum(self.track(phi, x) for phi in TRACKS)
        except ArithmeticError:
            self.neutral = np.zeros(18)
            return 10.0

    def track(self, phi, x):
        middle = self.pose(self.neutral, 0.0, phi, x)
        points = np.empty((9, 2))
        for way in (range(4, 9), range(3, -1, -1)):
            a = middle
            for k in way:
                a = self.pose(a, SHIFTS[k], phi, x)
                points[k] = (chains(a, SHIFTS[k], phi, *x)[3] @ HANDLE)[:2]
        chord = points[8] - points[0]
        length = np.hypot(*chord)
        off = points - points[0]
        bows = (off[:, 1] * chord[0] - off[:, 0] * chord[1]) / length
        bow = bows[np.argmax(np.abs(bows))]
        return (chord[1] / length) ** 2 + (bow / length) ** 2


def scipy_runs():
    return [
        ("Nelder-Mead", lambda f: minimize(f, START, method="Nelder-Mead", bounds=BOUNDS)),
        ("BFGS, default options", lambda f: minimize(f, START, method="BFGS")),
        ("BFGS, gtol 1e-9", lambda f: minimize(f, START, method="BFGS", options={"gtol": 1e-9})),
        ("L-BFGS-B", lambda f: minimize(f, START, method="L-BFGS-B", bounds=BOUNDS)),
        ("L-BFGS-B, ftol 1e-15", lambda f: minimize(f, START, method="L-BFGS-B", bounds=BOUNDS,
                                                    options={"ftol": 1e-15, "gtol": 1e-12})),
        ("differential_evolution", lambda f: differential_evolution(f, BOUNDS, seed=1)),
    ]


def children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def mechanim_runs(program):
    scene = subprocess.run([program, "scenes", "gearshift"], check=True, capture_output=True).stdout
    bare = scene.split(b"[clearance]")[0]
    for name, text in (("mechanim", bare), ("mechanim, with clearances", scene)):
        for method in ("nelder-mead", "bfgs", "evolution"):
            best, report = math.inf, None
            for _ in range(5):
                with tempfile.TemporaryDirectory() as folder:
                    out = os.path.join(folder, "report.json")
                    before = children()
                    subprocess.run([program, "optimise", "-", "--method", method, "--json", out],
                                   input=text, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                    best = min(best, children() - before)
                    report = json.load(open(out))
            yield name, method, report["evaluations"], best, report["to"]


def row(who, method, calls, seconds, value):
    print(f"| {who} | {method} | {calls} | {seconds:.3f} | {value:.6e} | {abs(value - BEST) / BEST:.1e} |", flush=True)


def main():
    program = sys.argv[1]
    first = Objective()
    print(f"F at the start: {first(START):.9e} (5.592044069e-02)\n")
    print("| program | method | evaluations | CPU s | F | error |")
    print("|---|---|---|---|---|---|")
    for name, run in scipy_runs():
        objective = Objective()
        before = time.process_time()
        found = run(objective)
        row("SciPy", name, objective.calls, time.process_time() - before, found.fun)
    for found in mechanim_runs(program):
        row(*found)


main()
