"""Exceptions and warnings of mechanim."""

from __future__ import annotations


class MechanimError(Exception):
    """What mechanim refuses. ``hints`` say what may help."""

    def __init__(self, message: str = "", hints: list[str] | None = None) -> None:
        super().__init__(message, hints or [])
        self.message = message
        self.hints: list[str] = list(hints or [])

    def __str__(self) -> str:
        return "\n".join([self.message, *(f"hint: {hint}" for hint in self.hints)])


class SceneError(MechanimError, ValueError):
    """The text of a scene has mistakes: one line for each, ``name:line:column: message``. Or there is no such scene or file."""


class MechanismError(MechanimError, ValueError):
    """The equations do not determine the mechanism."""


class ArgumentError(MechanimError, ValueError):
    """A name that the scene does not have, or a value that does not fit."""


class UnknownNameError(ArgumentError, KeyError):
    """A result has nothing of that name: ``motion["hh"]``."""


class LimitError(MechanimError, RuntimeError):
    """A limit of the run is exceeded: samples, memory, pixels."""


class FileError(MechanimError, OSError):
    """A file that cannot be written, or a picture that cannot be drawn."""


class SceneWarning(UserWarning):
    """Something in a scene is odd, but usable."""


class MotionWarning(UserWarning):
    """Some samples have no pose: their values are NaN."""
