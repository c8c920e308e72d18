"""A stage of fracture at rest that is killed or stopped goes on from its last checkpoint: all files are those of a run that was
not, byte for byte, with a stage before it and one after it."""
import re
import shutil
from pathlib import Path
from signal import SIGKILL, SIGTERM

import pytest
from program import CLAMP, PROGRAM, STATICS, edit, expect_same, lines, stop_at, table, values, vbond, write

pytestmark = pytest.mark.skipif(not STATICS, reason="fracture at rest needs statics")

# A block with bonds of scattered strengths, pressed a little, then drawn apart until it has lost half of its load, and let go.
CASE = f"""
[[specimen]]
kind = "block"
cells = [7, 7, 9]
radius = 0.5
mass = 1.0
[groups.low]
plane = {{point = [0, 0, 0], normal = [0, 0, 1], within = 0.1}}
[groups.high]
plane = {{point = [0, 0, 8], normal = [0, 0, 1], within = 0.1}}
[[bonds]]
distance = 1.1
stiffness = {{c_A = 1.0, c_D = 0.35, c_B = 0.05, c_T = 0.05}}
strength = {{criterion = "linear", axial_force = 0.01, shear_force = 0.02, bending_moment = 0.01, torque = 0.01, weibull = {{modulus = 5, seed = 3}}}}
[[stage]]
name = "press"
kind = "equilibrium"
supports = [{{group = "low", {CLAMP}}}]
loads = [{{group = "high", force = [0, 0, -1e-5]}}]
[[stage]]
name = "break"
kind = "fracture"
steps = 5
stop = {{load_drop = 0.5}}
supports = [{{group = "low", {CLAMP}}}, {{group = "high", rigid = true, displacement = [0, 0, 0.5]}}]
[[stage]]
name = "let_go"
duration = "2 T0"
supports = [{{group = "low", {CLAMP}}}]
[output]
history = {{every = "1 T0", reactions = ["high"]}}
checkpoint = {{every = "1 T0"}}
"""


@pytest.fixture(scope="module")
def whole(work):
    write("case.toml", CASE)
    vbond("run case.toml -o whole")
    assert len(table("whole/breaks.csv")) > 30 and values("whole", "ended")[1] == "load drop"
    return "whole"


def breaking(part):
    """Rows of the history until this part of the stage of fracture, which has most of them."""
    return int(lines("whole/history.csv") * part)


@pytest.mark.parametrize("stops", [[(0.5, SIGKILL)], [(0.3, SIGTERM)], [(0.2, SIGTERM), (0.4, SIGKILL), (0.7, SIGTERM)]],
                         ids=["killed", "stopped", "thrice"])
def test_goes_on_from_the_last_break(whole, stops, request):
    folder, command = request.node.callspec.id, "run case.toml -o"
    for part, by in stops:
        said = stop_at(breaking(part), folder, command, folder, by=by)
        if by != SIGKILL:
            assert said.err.splitlines()[-1] == f"stopped by a signal; go on with: {PROGRAM} resume {folder}"
        command = "resume"
    rows = lines(f"{folder}/history.csv")
    step = int(re.search(r"resumed at step (\d+) of stage break", vbond("resume", folder).out)[1])
    assert step >= rows - 4, "it had gone back by more than a balance"  # header; the stage before has two points
    expect_same(whole, folder)


def test_each_balance_of_a_run_at_rest(whole):  # where a balance counts 1, and no T_0
    write("rest.toml", CASE, (r'\[\[stage\]\]\nname = "let_go"(.*\n)*?(?=\[output\])', ""), ("^checkpoint = .*", "checkpoint = {every = 1}"))
    stop_at(breaking(0.5), "rest", "run rest.toml -o rest", by=SIGKILL)
    rows = lines("rest/history.csv")
    step = int(re.search(r"resumed at step (\d+) of stage break", vbond("resume rest").out)[1])
    assert step >= rows - 4
    one, two = ([row["bond"] for row in table(f"{folder}/breaks.csv") if row["stage"] == 1] for folder in ("rest", "whole"))
    assert one == two


def test_checkpoints_change_nothing(whole):
    write("plain.toml", CASE, ("^checkpoint = .*", ""))
    vbond("run plain.toml -o plain")
    expect_same(whole, "plain", "resolved.toml")


def test_breaks_that_a_checkpoint_does_not_hold_yet(whole):
    # Killed, or the disk full, after a row of breaks.csv and before the checkpoint that has it.
    stop_at(breaking(0.5), "late", "run case.toml -o late")
    held = len(table("late/breaks.csv"))
    shutil.copytree("late", "later")
    row = Path("whole/breaks.csv").read_text().splitlines(keepends=True)[1 + held]
    with open("later/breaks.csv", "a", encoding="utf-8") as file:
        file.write(row)
    vbond("resume later")
    expect_same(whole, "later")


def test_what_may_be_edited(whole):
    stop_at(breaking(0.5), "edited", "run case.toml -o edited")
    for name in ("shorter", "lighter"):
        shutil.copytree("edited", name)
    edit("shorter/resolved.toml", ("load_drop = [0-9.]+", f"breaks = {{count = {len(table('edited/breaks.csv')) + 2}}}"))
    vbond("resume shorter")
    assert values("shorter", "ended")[1] == "breaks"
    at_rest = [row for row in table("shorter/breaks.csv") if row["stage"] == 1]
    assert at_rest == table("whole/breaks.csv")[:len(at_rest)] and len(at_rest) == len(table("edited/breaks.csv")) + 2
    edit("lighter/resolved.toml", (r'(name = "break"(.*\n)*?gravity = )\[.*', r"\1[0, 0, 1e-4]"))
    edit("edited/resolved.toml", (r"displacement = \[0.0, 0.0, 0.5\]", "displacement = [0, 0, 0.4]"))
    for name in ("lighter", "edited"):
        vbond("resume", name, status=1, err=["is not in balance in this stage", "stay as they are; undo the edit"])


def test_a_way_of_a_support_stays(whole):  # its residual is that of before: the load factor alone would take it further
    write("loose.toml", CASE, ("rigid = true, displacement", f"{CLAMP}, displacement"))
    stop_at(breaking(0.5), "loose", "run loose.toml -o loose")
    shutil.copytree("loose", "shorter_way")
    edit("shorter_way/resolved.toml", (r"displacement = \[0.0, 0.0, 0.5\]", "displacement = [0, 0, 0.4]"))
    vbond("resume shorter_way", status=1, err=["is not in balance in this stage", "stay as they are; undo the edit"])
    vbond("resume loose")


def test_an_older_program_refuses_it(whole):
    stop_at(breaking(0.5), "newer", "run case.toml -o newer")
    seal = Path("newer/checkpoint.h5").read_bytes()[:512]
    assert seal.startswith(b"vbond checkpoint\nformat 5\n")
    assert Path("whole/checkpoint.h5").read_bytes().startswith(b"vbond checkpoint\nformat 4\n")
