"""Each module has a folder of its own for its runs; what several of its tests look at is a fixture of the module."""
import os
import tempfile
from pathlib import Path

import pytest

pytest.register_assert_rewrite("program")
import program  # noqa: E402


@pytest.fixture(scope="module", autouse=True)
def work():
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("template.html").write_text(program.TEMPLATE)
        os.environ["VBOND_PAGE"] = f"{folder}/template.html"
        yield Path(folder)
        os.chdir(before)
