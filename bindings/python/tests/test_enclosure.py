"""Bands and curves: those of the program, and bands that hold pieces made at random."""

import csv
import signal
import threading
import time

import mechanim
import numpy as np
import pytest


def test_bands_are_those_of_the_program(program, tmp_path):
    out = tmp_path / "bands.csv"
    program("enclose", "gearshift", "--tolerance", "0.1", "--samples", "6", "--out", str(out))
    rows = list(csv.DictReader(out.read_text().splitlines()))
    found = mechanim.load("gearshift").enclose(0.1, samples=6)
    assert found.report["columns"] == list(rows[0]) and found.report["refusals"] == []
    names = [name[:-3] for name in rows[0] if name.endswith(".lo")]
    assert len(names) > 20
    for name in names:
        low, high = found[name].T
        for ending, values in ((".lo", low), (".hi", high)):
            assert [float(row[name + ending]) for row in rows] == list(values), name + ending


def test_no_piece_leaves_its_band():
    scene = mechanim.load("slider-crank")
    found = scene.enclose(0.1, vary=["r", "L"], times=[0.1, 0.4])
    random = np.random.default_rng(5)
    for r, length in random.uniform(-0.1, 0.1, (60, 2)):
        piece = scene.with_(r=40 + r, L=80 + length).solve(times=[0.1, 0.4])
        low, high = found["h"].T
        assert (low <= piece["h"]).all() and (piece["h"] <= high).all()


def test_what_cannot_be_enclosed_says_why():
    scene = mechanim.load("slider-crank")
    found = scene.enclose(60, vary=["r"], samples=8)
    assert "`r`" in found.report["refusals"][0] and np.isnan(found["h"]).any()
    with pytest.raises(mechanim.ArgumentError):
        scene.enclose(samples=3)
    with pytest.raises(mechanim.ArgumentError):
        found["no such name"]
    with pytest.raises(TypeError):
        scene.enclose(0.1, samples=3, times=[0.1])


def test_ctrl_c_ends_an_enclosure():
    scene = mechanim.load("gearshift")
    threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        scene.enclose(0.1, samples=100_000)
    assert time.monotonic() - begun < 5


def test_curves_are_those_of_the_program(program, tmp_path):
    out = tmp_path / "curves.svg"
    program("plot", "four-bar", "--y", "psi,d(psi,phi)", "--x", "phi", "--out", str(out))
    motion = mechanim.load("four-bar").solve(times=np.arange(361) / 360 * 4)
    assert motion.plot("psi", "d(psi,phi)", against="phi") == out.read_text()
    assert motion.plot().startswith("<svg")
    with pytest.raises(mechanim.MechanimError):
        motion.plot("no such name")
