"""Exact motion of spatial mechanisms from their equations, as NumPy arrays.

>>> import mechanim
>>> scene = mechanim.load("slider-crank", L=120)
>>> motion = scene.solve(samples=36)
>>> motion["h"].shape
(36,)
>>> bool((motion.error_bound < 1e-10).all())
True
"""

from ._mechanim import (
    Assembly,
    Check,
    Enclosure,
    Motion,
    Optimum,
    PairClearance,
    Scene,
    Sensitivity,
    Study,
    Table,
    Tolerance,
    load,
    loads,
    scenes,
)
from .errors import (
    ArgumentError,
    FileError,
    LimitError,
    MechanimError,
    MechanismError,
    MotionWarning,
    SceneError,
    SceneWarning,
    UnknownNameError,
)

__all__ = [
    "ArgumentError",
    "Assembly",
    "Check",
    "Enclosure",
    "FileError",
    "LimitError",
    "MechanimError",
    "MechanismError",
    "Motion",
    "MotionWarning",
    "Optimum",
    "PairClearance",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Sensitivity",
    "Study",
    "Table",
    "Tolerance",
    "UnknownNameError",
    "load",
    "loads",
    "scenes",
]
__version__ = "0.1.0"
