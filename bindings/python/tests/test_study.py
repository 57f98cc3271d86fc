"""Studies: the figures of the program, the lecture's optimum by SciPy, and Ctrl-C."""

import csv
import json
import signal
import threading
import time

import mechanim
import numpy as np
import pytest
from scipy.optimize import minimize


def test_figures_are_those_of_the_program(program, tmp_path):
    found = mechanim.load("gearshift").study("L4", "L5d").sensitivity()
    out = tmp_path / "s.json"
    program("sensitivity", "gearshift", "--vary", "L4,L5d", "--out", str(out))
    report = json.loads(out.read_text())
    assert report["measures"].keys() == found.measures.keys()
    slopes = {row["dimension"]: row["derivatives"] for row in report["dimensions"]}
    for name, value in found.measures.items():
        assert report["measures"][name] == value
        row = found[name]
        for k, variable in enumerate(found.variables):
            assert row[k] == found.derivative(name, variable) == slopes[variable][name]
    with pytest.raises(mechanim.ArgumentError):
        found.derivative("F", "L9")


def test_scipy_finds_the_optimum_of_the_lecture():
    scene = mechanim.load("gearshift")

    def objective(x):
        found = scene.with_(L6s=x[0], ZR1=x[1]).study("L6s", "ZR1").sensitivity()
        return found.measures["F"], [found.derivative("F", name) for name in ("L6s", "ZR1")]

    best = minimize(objective, [110.0, 270.0], jac=True, method="BFGS", options={"gtol": 1e-9})
    assert best.fun == pytest.approx(6.50998e-5, rel=1e-4)
    assert np.abs(best.x - [62.913, 236.431]).max() < 0.01


def test_the_own_optimiser_ends_there_too_and_proves_it():
    best = mechanim.load("gearshift").study("L6s", "ZR1").optimise(within=None)
    before, after = best.objective
    assert before > 5e-2 and after == pytest.approx(6.50998e-5, rel=1e-4)
    assert best.values["L6s"] == pytest.approx(62.913, abs=0.01)
    better = mechanim.loads(best.scene_text).study("L6s", "ZR1").sensitivity()
    assert better.measures["F"] == pytest.approx(after, rel=1e-9)


def test_bands_hold_what_is_found():
    found = mechanim.load("gearshift").study("L4").tolerance(0.01, pieces=200)
    assert 0.0 <= found.yield_share <= 1.0
    for name in found.measures:
        figures = found[name]
        low, high = figures["band"]
        least, greatest = figures["found"]
        assert low <= least <= figures["nominal"] <= greatest <= high
    with pytest.raises(KeyError):
        found["no such measure"]


@pytest.mark.parametrize("options", [{"method": "downhill"}, {"method": "bfgs", "iterations": -1}])
def test_bad_options_are_refused(options):
    with pytest.raises((ValueError, OverflowError)):
        mechanim.load("gearshift").study("L6s").optimise(**options)


def test_ctrl_c_ends_a_search():
    study = mechanim.load("gearshift").study("all")
    threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        study.tolerance(0.1, pieces=20_000_000)
    assert time.monotonic() - begun < 5.0


def test_rows_as_parquet(program, tmp_path):
    """Every reader finds in the Parquet file what the CSV says, bit by bit, and where nothing is, a null."""
    design = ["--design", "grid:crank=20..200:9,ex=0..90:3", "--outputs", "K.x,K.y", "--samples", "5"]
    for name in ("rows.csv", "rows.parquet", "again.parquet"):
        program("sweep", "four-bar", *design, "--out", str(tmp_path / name))
    path = str(tmp_path / "rows.parquet")
    assert (tmp_path / "rows.parquet").read_bytes() == (tmp_path / "again.parquet").read_bytes()
    with open(tmp_path / "rows.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert any(row["status"] != "ok" for row in rows) and any(row["status"] == "ok" for row in rows)

    def agree(read):
        assert list(read) == list(rows[0])
        for name, cells in read.items():
            for cell, row in zip(cells, rows, strict=True):
                text = row[name]
                if name == "status":
                    assert cell == text
                elif text == "":
                    assert cell is None
                else:
                    assert float(cell) == float(text)

    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(path)
    agree(table.to_pydict())
    about = {key.decode(): value.decode() for key, value in table.schema.metadata.items()}
    assert about["mechanim.scene"] == "four-bar" and len(about["mechanim.identity"]) >= 32
    assert json.loads(about["mechanim.units"])
    polars = pytest.importorskip("polars")
    agree(polars.read_parquet(path).to_dict(as_series=False))
    duckdb = pytest.importorskip("duckdb")
    found = duckdb.sql(f"select * from read_parquet('{path}')")
    agree(dict(zip(found.columns, zip(*found.fetchall()))))
