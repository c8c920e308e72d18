"""The package as a whole: its names, stubs, docstrings and examples."""

import ast
import inspect
import json
import subprocess
import sys
from pathlib import Path

import pytest

import vbond
from vbond import _vbond
from conftest import root


def stub_names() -> dict[str, set[str]]:
    tree = ast.parse((root / "python/vbond/_vbond.pyi").read_text())
    names: dict[str, set[str]] = {"": set()}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            names[""].add(node.name)
        elif isinstance(node, ast.ClassDef):
            members = [n.target.id if isinstance(n, ast.AnnAssign) else n.name for n in node.body
                       if isinstance(n, (ast.AnnAssign, ast.FunctionDef))]
            names[node.name] = set(members)
    return names


def public(thing) -> set[str]:
    return {name for name in vars(thing) if not name.startswith("__")}


def test_stubs_name_what_the_extension_has():
    names = stub_names()
    assert names[""] == {name for name in public(_vbond) if not inspect.isclass(getattr(_vbond, name))}
    for name in public(_vbond):
        thing = getattr(_vbond, name)
        if not inspect.isclass(thing) or issubclass(thing, Exception):
            continue
        own = {n for n in public(thing)}
        assert own == {n for n in names[name] if not n.startswith("__")}, name


def test_everything_public_has_a_docstring():
    for name in vbond.__all__:
        thing = getattr(vbond, name)
        if name == "__version__":
            continue
        assert thing.__doc__, name
        if inspect.isclass(thing):
            for member in public(thing) - {"case"}:
                if not member.startswith("_") and callable(getattr(thing, member)):
                    assert getattr(thing, member).__doc__, f"{name}.{member}"
    for member in public(_vbond.CheckedRun):
        assert member == "_make" or getattr(_vbond.CheckedRun, member).__doc__, member


def test_every_public_name_is_tested():
    tests = "".join(file.read_text() for file in Path(__file__).parent.glob("test_*.py") if file != Path(__file__))
    reached_by_attributes = {"SpecialPoint", "NaturalMode", "StaticSolution", "FractureResult", "FractureEnergy"}
    for name in set(vbond.__all__) - reached_by_attributes:
        assert name in tests, name
    for kind in (vbond.Run, _vbond.CheckedRun, vbond.Case, vbond.Output, vbond.State):
        for member in public(kind):
            if not member.startswith("_"):
                assert f".{member}" in tests or f'"{member}"' in tests, f"{kind.__name__}.{member}"


def test_examples_run():
    for file in sorted((root / "examples/python").glob("*.py")):
        done = subprocess.run([sys.executable, str(file)], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, f"{file.name}: {done.stderr}"
        assert done.stdout


def test_the_document_names_what_there_is_and_its_code_runs(tmp_path):
    text = (root / "docs/python.md").read_text()
    blocks = [part.split("```")[0] for part in text.split("```python\n")[1:]]
    program = "\n".join(blocks).replace('"examples/', f'"{root}/examples/')
    program = "import matplotlib\nmatplotlib.use('Agg')\n" + program
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", sorted(file.stem for file in (root / "docs/notebooks").glob("*.ipynb")))
def test_notebooks_run(name, tmp_path):
    pytest.importorskip("nbconvert")
    pytest.importorskip("ipykernel")
    notebook = root / "docs/notebooks" / f"{name}.ipynb"
    cells = json.loads(notebook.read_text())["cells"]
    assert all(not cell.get("outputs") for cell in cells), "a notebook is kept without its results"
    words = ["--to", "notebook", "--execute", "--output-dir", str(tmp_path), str(notebook)]
    done = subprocess.run([sys.executable, "-m", "nbconvert", *words], capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr


def test_each_tutorial_has_a_notebook():
    names = [{file.stem for file in (root / "docs" / folder).iterdir()} for folder in ("tutorials", "notebooks")]
    assert names[0] == names[1]
