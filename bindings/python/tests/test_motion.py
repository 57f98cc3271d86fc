"""Motions as arrays: the program's numbers, closed forms, samples without a pose."""

import csv
import io
import math
from decimal import Decimal, getcontext

import mechanim
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

SCENES = ["slider-crank", "four-bar", "gearshift", "seven-r", "bennett", "peaucellier"]


@pytest.mark.parametrize("name", SCENES)
def test_every_column_is_the_programs(name, program):
    motion = mechanim.load(name).solve(samples=12)
    printed = list(csv.DictReader(io.StringIO(program("solve", name, "--samples", "12", "--out", "-"))))
    assert len(printed) == len(motion) == 12
    assert set(motion.columns) <= set(printed[0])
    for column in motion.columns:
        text = np.array([float(row[column]) for row in printed])
        assert (text == motion[column]).all(), column
    bounds = np.array([float(row["error_bound"]) for row in printed])
    assert (motion.error_bound == bounds).all()


def cosine_and_sine(x: Decimal) -> tuple[Decimal, Decimal]:
    terms, term, k = [Decimal(1)], Decimal(1), 0
    while abs(term) > Decimal(10) ** -45:
        k += 1
        term = term * x / k
        terms.append(term)
    cos = sum(t * (-1) ** (k // 2) for k, t in enumerate(terms) if k % 2 == 0)
    sin = sum(t * (-1) ** (k // 2) for k, t in enumerate(terms) if k % 2 == 1)
    return Decimal(cos), Decimal(sin)


@pytest.mark.parametrize("unit", ["rad", "deg"])
def test_bounds_hold_for_the_numbers_returned(unit):
    getcontext().prec = 50
    pi = Decimal("3.14159265358979323846264338327950288419716939937511")
    text = mechanim.load("slider-crank").text.replace('angle = "rad"', f'angle = "{unit}"')
    scene = mechanim.loads(text, r=40, L=100)
    top = 6.0 if unit == "rad" else 350.0
    motion = scene.solve(inputs={"phi": np.linspace(0, top, 400)})
    for phi, h, bound in zip(motion["phi"], motion["h"], motion.error_bound, strict=True):
        angle = Decimal(repr(float(phi))) * (1 if unit == "rad" else pi / 180)
        cos, sin = cosine_and_sine(angle)
        exact = 40 * cos + (Decimal(100) ** 2 - (40 * sin) ** 2).sqrt()
        assert abs(Decimal(float(h)) - exact) <= Decimal(float(bound)), phi


@pytest.mark.parametrize("name", ["slider-crank", "gearshift", "four-bar"])
def test_every_time_has_its_row(name):
    scene = mechanim.load(name)
    lists = [np.linspace(0, scene.duration, n) for n in range(2, 30)]
    lists += [np.arange(20) * 0.1, np.arange(20) * 0.05, np.array([0.1, 0.1, 0.3, 3 * 0.1])]
    for times in lists:
        motion = scene.solve(times=times)
        assert motion.times.tolist() == times.tolist()
        assert len(motion[motion.columns[0]]) == len(times)


def test_rows_of_inputs_are_as_many_as_given():
    scene = mechanim.load("slider-crank")
    for step in (0.1, 0.05, 0.3):
        times = np.arange(25) * step
        motion = scene.solve(inputs={"phi": np.arange(25.0)}, times=times)
        assert motion["phi"].tolist() == np.arange(25.0).tolist()
    assert scene.solve(inputs={"phi": 0.5}, times=[0, 1, 2])["phi"].tolist() == [0.5] * 3
    masked = np.ma.masked_array([1.0, 2.0], mask=[False, True])
    for wrong in (np.zeros((2, 2)), np.array(["0.1"]), np.array([1j]), masked):
        with pytest.raises((mechanim.ArgumentError, TypeError), match="phi"):
            scene.solve(inputs={"phi": wrong})


def test_gaps_are_told_for_given_times_too():
    scene = mechanim.load("slider-crank", r=40, L=30)
    with pytest.warns(mechanim.MotionWarning) as told:
        motion = scene.solve(times=[0.0, scene.duration])
    assert not motion.is_whole and motion.events
    assert told[0].filename == __file__


def test_values_are_those_of_the_closed_form():
    scene = mechanim.load("slider-crank", r=40, L=120)
    motion = scene.solve(samples=50)
    phi = motion["phi"]
    h = 40 * np.cos(phi) + np.sqrt(120**2 - (40 * np.sin(phi)) ** 2)
    assert np.abs(motion["h"] - h).max() < 1e-12
    assert motion.is_whole and motion.closure_error < 1e-13
    assert set(motion.status) == {"certified"}
    assert motion.poses.shape == (50, len(scene.bodies), 4, 4)
    assert np.allclose(motion.poses[:, :, 3], [0, 0, 0, 1])
    rotations = motion.poses[:, :, :3, :3]
    assert np.allclose(rotations @ rotations.swapaxes(-1, -2), np.eye(3), atol=1e-12)


def test_samples_without_a_pose_are_nan_and_warned_about():
    scene = mechanim.load("slider-crank", r=40, L=30)
    with pytest.warns(mechanim.MotionWarning, match="have no pose"):
        motion = scene.solve(samples=40)
    missing = np.isnan(motion["h"])
    assert missing.any() and not missing.all()
    assert (missing == (np.array(motion.status) == "no pose")).all()
    assert (missing == np.isnan(motion.error_bound)).all()
    assert motion.events


def test_rows_of_inputs():
    scene = mechanim.load("slider-crank")
    wanted = [0.0, 0.3, 0.1, -0.2]
    motion = scene.solve(inputs={"phi": wanted})
    assert motion["phi"].tolist() == pytest.approx(wanted, abs=1e-15)
    at = scene.solve(inputs={"phi": np.array(wanted)}, times=[0, 1, 5, 6])
    assert at.times.tolist() == [0, 1, 5, 6]
    assert np.abs(at["h"] - motion["h"]).max() < 1e-12
    with pytest.raises(mechanim.ArgumentError, match="phi"):
        scene.solve(inputs={"phy": wanted})
    with pytest.raises(mechanim.ArgumentError, match="3 values for 4"):
        scene.solve(inputs={"phi": [1, 2, 3]}, times=[0, 1, 2, 3])


@settings(max_examples=25, deadline=None)
@given(st.floats(5, 60), st.floats(70, 300), st.floats(-20, 20))
def test_any_slider_crank(r, length, phi):
    motion = mechanim.load("slider-crank", r=r, L=length).solve(inputs={"phi": [0.0, phi / 10]})
    at = motion["phi"]
    exact = r * np.cos(at) + np.sqrt(length**2 - (r * np.sin(at)) ** 2)
    assert np.abs(motion["h"] - exact).max() < 1e-11 * length


def test_rates_and_measures():
    motion = mechanim.load("slider-crank").solve(samples=2001)
    slope = np.gradient(motion["h"], motion.times, edge_order=2)
    assert np.abs(motion.rate("h") - slope).max() < 1e-3 * np.abs(slope).max()
    measured = mechanim.load("gearshift").solve(samples=9).measures["F"]
    assert measured is not None and math.isfinite(measured)
