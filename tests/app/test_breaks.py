"""A body that breaks into pieces: what its files tell of it, in words too, and that they are the same, byte for byte, for
any number of threads and after SIGKILL and resume."""
import shutil
from pathlib import Path
from signal import SIGKILL

import pytest
from program import HERE, Started, column, edited, expect_same, lines, number, read, table, vbond, write

CASE = HERE / "breaks.toml"


@pytest.fixture(scope="module")
def whole(work):
    vbond("run", CASE, *"-o whole --threads 1".split(), out="broken")
    return "whole"


@pytest.fixture(scope="module")
def broken(whole):
    return lines("whole/breaks.csv") - 1


def test_files_tell_of_breaks(whole, broken):
    run, breaks, last = read(whole), table("whole/breaks.csv"), table(whole)[-1]
    assert run["stages"][0]["stop"] == "breaks", "the first stage went past its breaks"
    assert broken >= 40, "the case does not exercise what it should"
    assert sum(row["stage"] == 0 for row in breaks) >= 5, "the first stage has fewer breaks than it stopped at"
    assert number(whole, "broken") == last["broken"] == len(breaks) == broken
    assert number(whole, "first_break_time") == breaks[0]["time"] and number(whole, "first_break_load") == breaks[0]["load"]
    assert number(whole, "peak_load") >= number(whole, "first_break_load")
    assert min(row["utilisation"] for row in breaks) >= 1, "a bond broke below its strength"
    # The energies of the bonds are what was released, but for contacts that breaks switched on; printed sums of doubles.
    assert last["released"] <= sum(row["energy"] for row in breaks) * (1 + 1e-12), "more was released than bonds held"
    assert number(whole, "energy_balance_error") < 1e-3


def test_fragments_add_up(whole):
    fragments, of_the_end = table("whole/fragments.csv"), column(whole, "fragments")[-1]
    particles, mass = list(fragments[0])[4], list(fragments[0])[6]
    for stage in (0, 1):  # at the end of both stages: all particles and all mass, the heaviest first
        masses = [row[mass] for row in fragments if row["stage"] == stage]
        assert sum(masses) == 256 and masses == sorted(masses, reverse=True)
        assert sum(row[particles] for row in fragments if row["stage"] == stage) == 256
    assert len(masses) == of_the_end >= 20


def test_vbond_breaks(whole, broken):
    vbond("breaks whole", out=["broke at t = ", " of 0.0", f"{broken} bonds broke: ", "V/A + |M_t| r/J_p = "])
    assert vbond("breaks whole --all").out.count("\n") == broken + 1
    shutil.copytree("whole", "few")
    write("few/breaks.csv", "".join(Path("whole/breaks.csv").read_text().splitlines(keepends=True)[:3]))
    assert vbond("breaks few").out.count("\n") == 3, "vbond breaks tells of more than there is"
    Path("few/breaks.csv").unlink()
    vbond("breaks few", status=3, err="no bond of this run has a strength")


def test_the_page_has_the_same_list(whole, broken):  # and what breaks in its frames
    vbond("report whole")
    text = Path("whole/report.html").read_text()
    Path("whole/report.html").unlink()
    for key in (f'"breaks":{{"count":{broken},"words":"{broken} bonds broke: ', '"bond_broken":', '"fragment":',
                '"key":"utilisation"', '"key":"bending_moment"'):
        assert key in text
    assert text.count('"cause":"') == min(broken, 100), "the list of the page is not the first hundred"


def test_threads_share_a_large_body():
    write("large.toml", CASE.read_text(), ("cells = .*", "cells = [30, 16, 16]"), (r"\[15, 0, 0\]", "[29, 0, 0]"),
          ('duration = "[36]0 T0"', 'duration = "2 T0"'), ("count = 5", "count = 50"))
    vbond("run large.toml -o one --threads 1")
    vbond("run large.toml -o two --threads 2")
    assert number("two", "threads_used") == 2
    assert lines("one/breaks.csv") > 100, "the large body hardly breaks"
    expect_same("one", "two")


@pytest.mark.parametrize("part", ["ten", "two thirds"])
def test_killed_and_resumed(whole, broken, part):
    # once some bonds have broken; what was written after the last checkpoint is dropped
    part = {"ten": 10, "two thirds": broken * 2 // 3}[part]
    shutil.rmtree("killed", ignore_errors=True)
    with Started("run", CASE, *"-o killed --threads 2".split()) as run:
        run.until(lambda: lines("killed/breaks.csv") > part and Path("killed/checkpoint.h5").exists()).stop(SIGKILL)
    vbond("resume killed")
    expect_same(whole, "killed")


def test_bonds_without_a_strength_have_none_of_this():
    write("elastic.toml", edited(CASE.read_text(), ("^strength.*", ""), ("^stop.*", "")))
    vbond("run elastic.toml -o elastic")
    assert not Path("elastic/breaks.csv").exists() and not Path("elastic/fragments.csv").exists()
    assert "broken" not in Path("elastic/history.csv").read_text() + Path("elastic/run.json").read_text()
    vbond("report elastic")
    told = [word for word in ('"breaks"', "broken", "fragment", "utilisation") if word in Path("elastic/report.html").read_text()]
    assert not told, "the page of an elastic run tells of breaks"
    vbond("run", CASE, "-o", "again", "--force")
    vbond("run elastic.toml -o again --force")
    left = [name for name in ("breaks.csv", "fragments.columns.json") if Path("again", name).exists()]
    assert not left, "--force leaves files of breaks"
