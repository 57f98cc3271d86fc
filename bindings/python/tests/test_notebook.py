"""The notebook runs from top to bottom and shows what it shows in its file."""

import ast
import json
import re
from pathlib import Path
from typing import Any

import numpy as np

NOTEBOOK = Path(__file__).parent.parent / "examples" / "first-steps.ipynb"
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


def run(source: str, names: dict) -> Any:
    """Runs a cell; the value of its last line if that is an expression."""
    cell = ast.parse(source)
    last = cell.body[-1]
    if not isinstance(last, ast.Expr):
        exec(compile(cell, "cell", "exec"), names)
        return None
    cell.body.pop()
    exec(compile(cell, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names)


def test_cells_show_what_the_file_has():
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    names: dict = {}
    shown = 0
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        value = run("".join(cell["source"]), names)
        for output in cell["outputs"]:
            data = output["data"]
            kept = "".join(data["text/plain"])
            found = [float(n) for n in NUMBER.findall(repr(value))]
            wanted = [float(n) for n in NUMBER.findall(kept)]
            assert NUMBER.sub("", repr(value)).split() == NUMBER.sub("", kept).split()
            assert np.allclose(found, wanted, rtol=1e-4, atol=1e-7)
            if "image/png" in data:
                assert value._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"
            shown += 1
    assert shown >= 7
