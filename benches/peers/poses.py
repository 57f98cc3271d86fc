"""Time and error of a pose from Python, by every way in one process: SciPy, Numba, MuJoCo, mechanim.

    pip install numpy scipy numba mujoco mechanim
    python benches/peers/poses.py

All sides take the same scenes, `benches/scenes`: their chains are read from the scene file, so that nobody's equations are
written by hand. SciPy's `fsolve` follows the poses from one to the next with three entries of the rotation and the
translation of each loop as equations; Numba compiles the same function. MuJoCo walks the chain of a single loop and gives
its Jacobian, and Newton's method is NumPy's; a chain that is shared by loops is no tree, so that the third scene has no
row there. mechanim gives every pose with its certificate, all in one call, and one call a pose from the start values.

Best of several runs on one core, in µs a pose, and the largest entry that the loops are open by, lengths over the
size, from one product in NumPy for all.
"""

import re
import time
import tomllib
from math import cos, pi, sin
from pathlib import Path

import mechanim
import mujoco
import numpy as np
from numba import njit
from scipy.optimize import fsolve

SCENES = Path(__file__).resolve().parent.parent / "scenes"
NAMES = [("slider-crank", 360), ("rssr", 360), ("three-loops", 300)]
RUNS = 3
STEP = re.compile(r"(inv)\(|([TR])([xyz])\(([^()]*)\)|(\w+)|(\))")


class Mechanism:
    """The loops of a scene as rows: rotation or translation, axis, sign, coordinate or -1, constant."""

    def __init__(self, name, count):
        self.path = SCENES / f"{name}.toml"
        text = tomllib.loads(self.path.read_text())
        constants = {"pi": pi}
        for key, value in text["parameters"].items():
            constants[key] = float(value)
        self.times = np.arange(count) / count * text["duration"]
        self.inputs = list(text["inputs"])
        scope = {"sin": np.sin, "cos": np.cos, "pi": pi, "t": self.times}
        self.drives = np.array([eval(f, scope) for f in text["inputs"].values()])
        self.chains = text.get("chains", {})
        loops = list(text["loops"].values())
        found = {w for c in [*self.chains.values(), *loops] for w in re.findall(r"\b[a-z]\w*", c)}
        known = {*constants, *self.inputs, *self.chains, "inv"}
        self.unknowns = [*text["guess"], *sorted(found - known - set(text["guess"]))]
        self.unknowns = [u for u in self.unknowns if u in found]
        guess = text["guess"]
        self.start = np.array([float(eval(str(guess.get(u, 0)), dict(constants))) for u in self.unknowns])
        self.constants = constants
        self.loops = [np.array(self.rows(loop)) for loop in loops]
        self.size = max(abs(r[4]) for loop in self.loops for r in loop)
        # A planar loop has three equations.
        self.planar = len(self.unknowns) == 3

    def rows(self, text):
        rows, stack = [], []
        for inverse, kind, axis, argument, chain, closing in STEP.findall(text):
            if inverse:
                stack.append(rows)
                rows = []
            elif closing:
                inner, rows = rows, stack.pop()
                rows += [(k, a, -s, q, c) for k, a, s, q, c in reversed(inner)]
            elif kind:
                rows.append((float(kind == "T"), float("xyz".index(axis)), *self.argument(argument)))
            else:
                rows += self.rows(self.chains[chain])
        return rows

    def argument(self, text):
        sign, name = (-1.0, text[1:]) if text.startswith("-") else (1.0, text)
        if name in self.unknowns:
            return sign, float(self.unknowns.index(name)), 0.0
        if name in self.inputs:
            return sign, float(len(self.unknowns) + self.inputs.index(name)), 0.0
        return sign, -1.0, float(eval(name, dict(self.constants)))


def product(rows, q):
    """The product of a chain, as lectures write it."""
    m = np.eye(4)
    for kind, axis, sign, index, constant in rows:
        value = sign * (q[int(index)] if index >= 0 else constant)
        step = np.eye(4)
        if kind:
            step[int(axis), 3] = value
        else:
            i, j = (int(axis) + 1) % 3, (int(axis) + 2) % 3
            step[i, i] = step[j, j] = cos(value)
            step[i, j], step[j, i] = -sin(value), sin(value)
        m = m @ step
    return m


compiled_product = njit(product)


def residual(loops, planar, size, of):
    def open_by(unknowns, drive):
        q = np.concatenate([unknowns, drive])
        parts = []
        for rows in loops:
            m = of(rows, q)
            if planar:
                parts += [m[1, 0], m[0, 3] / size, m[1, 3] / size]
            else:
                parts += [m[2, 1], m[0, 2], m[1, 0], m[0, 3] / size, m[1, 3] / size, m[2, 3] / size]
        return parts

    return open_by


def closure(scene, poses):
    """The largest entry by which any loop is no identity."""
    worst = 0.0
    for pose, drive in zip(poses, scene.drives.T):
        for rows in scene.loops:
            off = product(rows, np.concatenate([pose, drive])) - np.eye(4)
            off[:3, 3] /= scene.size
            worst = max(worst, np.abs(off).max())
    return worst


def by_fsolve(scene, of):
    function = residual(scene.loops, scene.planar, scene.size, of)

    def run():
        here, poses = scene.start, []
        for drive in scene.drives.T:
            here = fsolve(function, here, args=(drive,))
            poses.append(here)
        return np.array(poses)

    return run


def by_mujoco(scene):
    """Every joint a body of its own along the chain; Newton's method brings the last frame back to the first."""
    if len(scene.loops) > 1:
        return None
    axes, xml, depth, shift = ["1 0 0", "0 1 0", "0 0 1"], "", 0, np.eye(4)
    order, signs = [], []
    for kind, axis, sign, index, constant in scene.loops[0]:
        row = np.array([(kind, axis, sign, -1.0, constant)])
        if index < 0:
            shift = shift @ product(row, ())
            continue
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, shift[:3, :3].flatten())
        place = " ".join(map(repr, map(float, shift[:3, 3]))), " ".join(map(repr, map(float, quat)))
        joint = "slide" if kind else "hinge"
        xml += f'<body pos="{place[0]}" quat="{place[1]}"><joint type="{joint}" axis="{axes[int(axis)]}"/>'
        xml += '<geom size="1" mass="1"/>'
        order.append(int(index))
        signs.append(sign)
        depth, shift = depth + 1, np.eye(4)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, shift[:3, :3].flatten())
    place = " ".join(map(repr, map(float, shift[:3, 3]))), " ".join(map(repr, map(float, quat)))
    xml += f'<site name="end" pos="{place[0]}" quat="{place[1]}"/>' + "</body>" * depth
    model = mujoco.MjModel.from_xml_string(f'<mujoco><compiler angle="radian"/><worldbody>{xml}</worldbody></mujoco>')
    data = mujoco.MjData(model)
    order, signs = np.array(order), np.array(signs)
    free = np.array([np.flatnonzero(order == k)[0] for k in range(len(scene.unknowns))])
    rows = [2, 3, 4] if scene.planar else [0, 1, 2, 3, 4, 5]
    moves, turns, angle, quat = np.zeros((3, model.nv)), np.zeros((3, model.nv)), np.zeros(3), np.zeros(4)

    def run():
        q, poses = scene.start.copy(), []
        for drive in scene.drives.T:
            for _ in range(20):
                data.qpos[:] = signs * np.concatenate([q, drive])[order]
                mujoco.mj_kinematics(model, data)
                mujoco.mj_comPos(model, data)
                mujoco.mj_jacSite(model, data, moves, turns, 0)
                mujoco.mju_mat2Quat(quat, data.site_xmat[0])
                mujoco.mju_quat2Vel(angle, quat, 1.0)
                off = np.concatenate([angle, data.site_xpos[0]])[rows]
                if np.abs(off[: len(off) - 3 if not scene.planar else 1]).max() < 1e-13 and np.abs(off).max() < 1e-11:
                    break
                jacobian = np.concatenate([turns, moves])[rows][:, free]
                q -= signs[free] * np.linalg.solve(jacobian, off)
            poses.append(q.copy())
        return np.array(poses)

    return run


def by_mechanim(scene):
    solver = mechanim.load(scene.path)

    def run():
        motion = solver.solve(times=scene.times)
        return np.array([motion[name] for name in scene.unknowns]).T

    return run


def one_by_one(scene):
    """A call a pose, each from the start values of the scene."""
    solver = mechanim.load(scene.path)
    drives = dict(zip(scene.inputs, scene.drives))

    def run():
        poses = []
        for k in range(len(scene.times)):
            motion = solver.solve(inputs={name: values[k : k + 1] for name, values in drives.items()})
            poses.append([motion[name][0] for name in scene.unknowns])
        return np.array(poses)

    return run


def main():
    scenes = [Mechanism(*name) for name in NAMES]
    ways = {
        "SciPy `fsolve` on NumPy products": lambda s: by_fsolve(s, product),
        "SciPy `fsolve` on products that Numba compiles": lambda s: by_fsolve(s, compiled_product),
        "MuJoCo's Jacobian and NumPy Newton": by_mujoco,
        "mechanim, all poses in one call, certified": by_mechanim,
        "mechanim, a call a pose, certified": one_by_one,
    }
    print("| way | " + " | ".join(f"{name}, {len(s.unknowns)} unknowns" for (name, _), s in zip(NAMES, scenes)) + " |")
    print("|---" * (1 + len(NAMES)) + "|")
    for way, make in ways.items():
        cells = []
        for scene in scenes:
            run = make(scene)
            if run is None:
                cells.append("-")
                continue
            poses, best = run(), float("inf")
            for _ in range(RUNS):
                begun = time.perf_counter()
                run()
                best = min(best, time.perf_counter() - begun)
            cells.append(f"{best / len(scene.times) * 1e6:.1f} / {closure(scene, poses):.0e}")
        print(f"| {way} | " + " | ".join(cells) + " |", flush=True)


main()
