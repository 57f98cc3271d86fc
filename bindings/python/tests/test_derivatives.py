"""Derivatives through the loops against central differences, and in an optimisation."""

import mechanim
import numpy as np
import pytest
from scipy.optimize import minimize

CASES = [
    ("slider-crank", ["h"], ["r", "L"]),
    ("four-bar", None, None),
    ("gearshift", ["M.x", "M.y", "M.z"], ["L6s", "ZR1"]),
    ("seven-r", None, None),
]


def parameters_of(scene):
    section = scene.text.split("[parameters]", 1)
    if len(section) < 2:
        return []
    lines = section[1].split("\n[", 1)[0].splitlines()
    names = [line.split("=")[0].strip() for line in lines if "=" in line and not line.startswith("#")]
    return names[:3]


@pytest.mark.parametrize("name, values, parameters", CASES)
def test_central_differences(name, values, parameters):
    scene = mechanim.load(name)
    motion = scene.solve(samples=7)
    values = values or scene.unknowns
    parameters = parameters or parameters_of(scene)
    slopes = motion.jacobian(values, parameters)
    assert slopes.shape == (7, len(values), len(parameters))
    for k, parameter in enumerate(parameters):
        line = next(row for row in scene.text.splitlines() if row.split("=")[0].strip() == parameter)
        try:
            nominal = float(line.split("=")[1].split("#")[0])
        except ValueError:
            continue
        step = 1e-5 * max(1.0, abs(nominal))
        ahead, behind = (scene.with_(**{parameter: nominal + s}).solve(samples=7) for s in (step, -step))
        for j, value in enumerate(values):
            difference = (ahead[value] - behind[value]) / (2 * step)
            scale = np.abs(slopes[:, j, k]).max() + 1.0
            assert np.abs(difference - slopes[:, j, k]).max() < 1e-7 * scale, (value, parameter)


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
