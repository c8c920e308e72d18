"""The program vbond as a process: where it is, and what it says when it fails."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from . import _vbond


class ProgramError(_vbond.Error):
    """The program ended with `status`, and said this."""

    def __init__(self, text: str, status: int):
        super().__init__(text)
        self.status = status


def find_program() -> str:
    """The program: $VBOND_PROGRAM, that of the build tree or installation that this package is in, or on the PATH."""
    here = Path(__file__).parent
    beside = [here.parents[1] / "vbond", *(folder / "bin" / "vbond" for folder in here.parents)]
    for place in [os.environ.get("VBOND_PROGRAM"), *beside, shutil.which("vbond")]:
        if place and Path(place).is_file() and os.access(place, os.X_OK):
            return str(place)
    raise _vbond.IoError("the program vbond was not found: put it on the PATH, or name it by $VBOND_PROGRAM")


def run_program(words: Iterable[str], quiet: bool) -> None:
    """Runs it to its end. Its text goes to the terminal unless quiet. Ctrl-C reaches the program, too, which then writes
    a checkpoint."""
    command = [find_program(), *words]
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE if quiet else None, stderr=subprocess.PIPE) as child:
        try:
            _, said = child.communicate()
        except KeyboardInterrupt:
            child.communicate()
            raise
    if child.returncode != 0:
        raise ProgramError(said.strip() or f"vbond ended with status {child.returncode}", child.returncode)
    if said:
        print(said, end="", file=sys.stderr)
