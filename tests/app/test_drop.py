"""A ball that is shot through a rod and one that is shot through the floor are dropped, told and counted, and the run
ends with status 0; without the key it ends with status 1. What cannot be is refused with its place in the file."""
from pathlib import Path

import pytest
from program import HERE, column, edit, expect_same, line_of, number, stop_at, table, vbond, write

CASE = HERE / "drop.toml"
TEXT = CASE.read_text()
STOP = 'watch.on_unphysical="stop"'


@pytest.fixture(scope="module", autouse=True)
def whole(work):
    vbond("check", CASE, out="no mistakes found")
    vbond("run", CASE, "-o", "whole", err=[
        "particle 6 is dropped at (", "it has passed through particle 2; 0 bonds broke, and energy ",
        "particle 7 is dropped at (", 'its centre has passed through wall "floor"; 0 bonds broke'])


def test_two_losses_are_counted():
    assert number("whole", "dropped") == 2
    # Each brought 1/2 m v^2 in: 20 and 5. What went with them is what is not there any more, but for what the rod has
    # been given.
    assert 24.5 < column("whole", "released")[-1] < 25.5
    # The error of the balance is that of the passing, and does not grow after it.
    errors = [row["balance_error"] for row in table("whole") if row["time"] > 0.4]
    assert max(errors) - min(errors) < 1e-6, "the balance goes on to be off"


def test_without_the_key_it_stops_and_goes_on_once_its_case_says_so():
    vbond("run", CASE, "-o", "stopped", sets=STOP, status=1, err="they have passed through one another")
    assert '"dropped"' not in Path("stopped/run.json").read_text(), "nobody was to be dropped"
    # from its last checkpoint
    vbond("run", CASE, "-o", "mended", sets=[STOP, "output.checkpoint.every=0.05"], status=1)
    edit("mended/resolved.toml", ('^on_unphysical = "stop"', 'on_unphysical = "drop"'))
    vbond("resume mended")
    assert number("mended", "dropped") == 2
    assert column("whole", "total") == column("mended", "total"), "it has gone on in another way"


def test_the_same_on_other_threads_and_after_a_stop():  # by a signal: the balls are gone by then
    vbond("run", CASE, *"-o threads --threads 2".split())
    expect_same("whole", "threads")
    long = ["stage[0].duration=1500", "output.frames.every=500"]
    vbond("run", CASE, "-o", "long", sets=long)
    for rows in (200, 2000):
        stop_at(rows, f"at_{rows}", "run", CASE, "-o", f"at_{rows}", sets=long)
        vbond("resume", f"at_{rows}")
        expect_same("long", f"at_{rows}")


def test_bonds_that_go_with_a_particle_stand_in_breaks():  # with a reason in words
    write("bonded.toml", TEXT, ("^mass = 0.1", "mass = 50.0"), (r"^velocity = \[0, -20, 0\]", "velocity = [0, 0, 0]"),
          (r"^(\[groups\.down\](?:\n.*)*?\nindices.*)7", r"\g<1>1"))
    vbond("run bonded.toml -o bonded", sets=["velocities[1].velocity=[0, 0, -60]", "time.step=0.01"],
          err=["particle 1 is dropped at (", "2 bonds broke"])
    assert set(column("bonded/breaks.csv", "mode")) == {"other"} and number("bonded", "broken") == 2
    vbond("breaks bonded", out="2 bonds broke: 2 with a particle that was dropped")


def test_the_next_stage_goes_on_without_them():
    # ball 6 was lost 0.24 from particle 2 of the rod, and is not bonded to it
    write("two.toml", TEXT.replace("\nduration = 3", '\nname = "one"\nduration = 3') + """[[bonds]]
distance = 0.5
when = "stage"
stages = ["two"]
theory = "bernoulli-euler"
E = 31.83
nu = 0.2
section = { shape = "circle", diameter = 0.2 }
[[stage]]
name = "two"
duration = 3
""")
    vbond("run two.toml -o two")
    assert number("two", "dropped") == 2 and number("two", "bonds") == 5


@pytest.mark.parametrize("text, changes, more_lines, told", [
    (TEXT + '[[stage]]\nname = "rest"\nkind = "equilibrium"\n', [], 0, ["", "a static stage that follows a stage of dynamics"]),
    (TEXT, [("^section = .*", r"\g<0>\ncapsule_radius = 0.2")], 1, ["", "bonds touch as capsules"]),
    (TEXT, [('"drop"', '"ignore"')], 0, [' = "ignore"', "stop", "drop"])], ids=["static", "capsules", "no word"])
def test_refused(text, changes, more_lines, told):
    write("wrong.toml", text, *changes)
    line = line_of(CASE, "on_unphysical") + more_lines
    vbond("check wrong.toml", status=2, err=[f"wrong.toml:{line}:1: watch.on_unphysical{told[0]}", *told[1:]])
