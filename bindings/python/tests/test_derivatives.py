"""Derivatives through the loops against central differences, and in an optimisation."""

import mechanim
import numpy as np
import pytest
from scipy.optimize import minimize

# Parameters of each scene; all values that it has are compared.
CASES = {
    "slider-crank": ["r", "L"],
    "four-bar": ["crank", "coupler", "rocker", "ground", "ex"],
    "gearshift": ["L4", "L6s", "ZR1"],
    "seven-r": ["b1", "c1", "gamma1", "c2"],
    "torus-torus": ["r1", "gamma1", "q2", "c2"],
    "sphere-torus": ["b1", "c2", "gamma2", "s2"],
    "sphere-sphere": ["b1", "c2"],
    "rsur": ["b1", "c1", "c2", "s"],
    "rrsrr": ["b1", "gamma1", "r1", "c2"],
    "twin-steer": ["L2a", "L3", "YP"],
}


def nominal(scene, name):
    rows = [row.split("=", 1) for row in scene.text.splitlines() if row.split("=")[0].strip() == name]
    return float(rows[0][1].split("#")[0])


@pytest.mark.parametrize("name", CASES)
def test_central_differences(name):
    scene = mechanim.load(name)
    motion = scene.solve(samples=7)
    values, parameters = motion.columns, CASES[name]
    slopes = motion.jacobian(values, parameters)
    assert slopes.shape == (7, len(values), len(parameters))
    for k, parameter in enumerate(parameters):
        middle = nominal(scene, parameter)
        step = 1e-5 * max(1.0, abs(middle))
        ends = [scene.with_(**{parameter: middle + s * step}).solve(samples=7) for s in (2, 1, -1, -2)]
        for j, value in enumerate(values):
            far, near, below, farthest = (end[value] for end in ends)
            # Of fourth order, so that the step may be large against rounding.
            difference = (8 * (near - below) - (far - farthest)) / (12 * step)
            scale = np.abs(slopes[:, j, k]).max() + 1.0
            assert np.abs(difference - slopes[:, j, k]).max() < 1e-7 * scale, (value, parameter)


def test_a_traced_point_has_three_coordinates():
    motion = mechanim.load("gearshift").solve(samples=5)
    assert "M" in motion and motion["M"].shape == (5, 3)
    assert (motion["M"][:, 1] == motion["M.y"]).all()
    whole = motion.jacobian("M", ["L6s", "ZR1"])
    assert whole.shape == (5, 3, 2)
    assert (whole == motion.jacobian(["M.x", "M.y", "M.z"], ["L6s", "ZR1"])).all()
    weights = np.arange(15.0).reshape(5, 3)
    found = motion.vjp({"M": weights}, ["L6s", "ZR1"])
    assert np.allclose(found, np.einsum("nc,ncp->p", weights, whole), rtol=1e-13)
    for wrong in (weights[:, 0], weights.T, weights.ravel()):
        with pytest.raises(mechanim.ArgumentError, match="shape"):
            motion.vjp({"M": wrong}, ["L6s"])
    with pytest.raises(TypeError, match="complex"):
        motion.vjp({"M": 1j * weights}, ["L6s"])
    assert (whole == motion.jacobian(["M"], ["L6s", "ZR1"])).all()
    with pytest.raises(TypeError, match="list of names"):
        motion.jacobian("M", "L6s")


DRIVEN = """
duration = 1
units = { length = "mm" }
[parameters]
g = 2
R = 40
c = 3
[inputs]
phi = "g*t"
[chains]
crank = "Rz(phi) Tx(R)"
rod = "Rz(alpha) Tx(100)"
[loops]
A = "crank rod Rz(beta) Tx(-h)"
[guess]
h = 130
[[bodies]]
name = "rod"
frame = "crank Rz(alpha)"
shapes = [{ sphere = { center = [50, 0, 0], radius = 5 } }]
[[bodies]]
name = "ball"
frame = "Tx(300)"
shapes = [{ sphere = { radius = "c" } }]
[outputs]
gap = { distance = ["rod", "ball"] }
v = "d(h, phi)"
w = "2*v"
"""


def test_what_a_derivative_would_leave_out_is_refused():
    scene = mechanim.loads(DRIVEN)
    motion = scene.solve(times=[0.0, 0.5, 1.0])
    with pytest.raises(mechanim.ArgumentError, match="drive"):
        motion.jacobian("h", ["g"])
    for name in ("v", "w"):
        with pytest.raises(mechanim.ArgumentError, match="rates"):
            motion.jacobian(name, ["R"])
    # The distance of two balls falls with a radius one to one; solids are changed by small steps.
    assert motion.jacobian("gap", ["c"]).ravel() == pytest.approx([-1, -1, -1], abs=1e-8)
    # Rows of inputs do not depend on what the drive is made of.
    driven = scene.solve(inputs={"phi": [0.0, 1.0]})
    assert (driven.jacobian("h", ["g"]) == 0).all()


def test_one_name_has_no_axis_and_vjp_is_the_sum():
    motion = mechanim.load("gearshift").solve(samples=5)
    one = motion.jacobian("M.x", ["L6s", "ZR1"])
    assert one.shape == (5, 2)
    weights = np.arange(5.0)
    both = motion.jacobian(["M.x", "M.z"], ["L6s", "ZR1"])
    expected = weights @ both[:, 0] - weights @ both[:, 1]
    found = motion.vjp({"M.x": weights, "M.z": -weights}, ["L6s", "ZR1"])
    assert np.allclose(found, expected, rtol=1e-13)


def test_unknown_names_are_told():
    motion = mechanim.load("slider-crank").solve(samples=2)
    with pytest.raises(mechanim.ArgumentError) as wrong:
        motion.jacobian("hh", ["r"])
    assert any("h" in hint for hint in wrong.value.hints)
    with pytest.raises(mechanim.MechanimError):
        motion.jacobian("h", ["q"])


def test_dimensions_are_found_again():
    scene = mechanim.load("slider-crank")
    target = scene.with_(r=42, L=118).solve(samples=40)["h"]

    def misfit(x):
        motion = scene.with_(r=x[0], L=x[1]).solve(samples=40)
        off = motion["h"] - target
        return off @ off, motion.vjp({"h": 2 * off}, ["r", "L"])

    found = minimize(misfit, [40.0, 100.0], jac=True)
    assert np.abs(found.x - [42, 118]).max() < 1e-5
