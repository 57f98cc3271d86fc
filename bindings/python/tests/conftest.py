"""The program that every column is compared with."""

import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest


def _program() -> str:
    beside = Path(sysconfig.get_path("scripts")) / "mechanim"
    found = str(beside) if beside.exists() else shutil.which("mechanim")
    assert found, "the wheel installs the program"
    return found


@pytest.fixture
def program():
    """Runs the program of the wheel and gives what it prints."""

    def run(*arguments: str) -> str:
        done = subprocess.run([_program(), *arguments], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture
def python() -> str:
    return sys.executable
