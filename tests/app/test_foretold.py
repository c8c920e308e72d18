"""What a case is told before it goes wrong: steps too long for what swings, rows and frames, bonds to come; and servos,
files and fibres that did not do what was expected."""
import re
import resource
from pathlib import Path
from signal import SIGINT

import pytest
from program import CLAMP, Started, column, edit, edited, lines, refused, stop_at, until, vbond, write

SHAKEN = '{wall = "floor", oscillation = {amplitude = [0.3, 0, 0], frequency = 10}}'
FLOOR = f"""specimen = [{{kind = "block", cells = [2, 2, 2], spacing = 1.1, radius = 0.5, mass = 1.0}}]
contact = {{law = "hertz", E = 20.0, nu = 0.25, restitution = 0.5, tangential = "mindlin", friction = 0.5}}
output = {{history = {{every = 1.0, displacements = ["body"]}}}}
[[wall]]
name = "floor"
shape = "plane"
point = [0, 0, -0.6]
normal = [0, 0, 1]
[[stage]]
duration = 10
gravity = [0, 0, -0.05]
walls = [{SHAKEN}]
"""
STIFFNESS = "stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.04, c_T = 0.03}"
ROD = f"""[[specimen]]
name = "rod"
kind = "rod"
particles = 200
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.1
{STIFFNESS}
[[velocities]]
velocity = [0.01, 0, 0]
[[stage]]
duration = "5 T0"
[output]
history = {{every = "0.5 T0"}}
frames = {{every = "1 T0", compression = "none"}}
"""


def test_steps_of_a_shaken_floor():
    vbond("check", write("floor.toml", FLOOR), out=["time step        0.005", "at most 2000 steps",
                                   '20 steps in a period of 0.1 of the oscillation of wall "floor"'])
    vbond("run floor.toml -o floor")
    vbond("run floor.toml -o fine --set time.step=0.0005")
    work, fine = (column(folder, "wall.floor.work")[-1] for folder in ("floor", "fine"))
    assert work > 0.95 * fine
    refused("floor.toml", "time.step = 0.02", '5 steps in a period of 0.1 of the oscillation of wall "floor"; 10 are the fewest',
            "use 0.005 (", "20 steps a period, or leave step out; or insist = true", sets="time.step=0.02")
    vbond("check floor.toml", sets=["time.step=0.02", "time.insist=true"],
          out=["5 steps in a period of 0.1", "TOO FEW, as the case insists"])
    vbond("check floor.toml --set time.step=0.008",
          out=["12.5 steps in a period of 0.1", "with 20 of them work is right to some 2 %"])
    # of a later stage, too
    stage = FLOOR[FLOOR.index("[[stage]]"):]
    write("two.toml", FLOOR + stage.replace("frequency = 10", "frequency = 50"))
    vbond("check two.toml --set time.step=0.005", status=2, err='4 steps in a period of 0.02 of the oscillation of wall "floor"')
    vbond("check two.toml", out="about 10000 steps")


def test_a_servo_that_meets_nothing():
    write("servo.toml", FLOOR + """[[wall]]
name = "lid"
shape = "plane"
point = [0, 0, 40]
normal = [0, 0, -1]
""", ("^walls = .*", 'walls = [{wall = "lid", servo = {direction = [0, 0, 1], force = 2.0, mass = 10.0}}]'), ("^output.*", ""))
    vbond("run servo.toml -o servo",
          err='wall "lid" ends stage "stage-1" without its force: its servo presses with 0, not 2, as it touches nothing')


def test_rows_and_frames_are_as_many_as_foretold():  # and of that size
    said = vbond("check", write("rod.toml", ROD), out=["history.csv: at most 12 rows of", "at most 7 frames of some"]).out
    foretold = float(re.search(r" frames of some [^:]*: ([0-9.]*) KiB", said).group(1))
    vbond("run rod.toml -o rod")
    assert lines("rod/history.csv") == 13
    assert len(list(Path("rod/frames").glob("particles*.vtp"))) == 7
    written = sum(frame.stat().st_size for frame in Path("rod/frames").glob("*.vtp")) / 1024
    assert foretold == pytest.approx(written, rel=0.2)
    vbond("check rod.toml", sets=["output.frames.every=1e-9 T0", "stage[0].duration=1e9 T0"], out="that is MORE than the")


def test_bonds_on_approach_are_told():  # and refused where they would not fit
    late = edited(ROD, ("^distance = 1.1", 'distance = 2.5\nwhen = "approach"'))
    vbond("check", write("late.toml", late), out=['bonds to come    "bonds-1": 397 pairs are within 2.5 now', "all 19900 would be"])
    refused(write("far.toml", late, ("^particles = 200", "particles = 200000"), ("^distance = .*", "distance = 1e6")),
            "more pairs are within 1000000 as the run begins than there is memory for", "is the distance in the right unit?")


def test_a_strength_that_is_added_before_going_on():  # there was no list of breaks so far, so none is missed
    write("two_stages.toml", ROD + f"""[[bonds]]
name = "late"
distance = 2.1
{STIFFNESS}
when = "stage"
stages = ["second"]
[[stage]]
name = "second"
duration = "2 T0"
""", ("^duration.*", 'duration = "2 T0"'), ("^frames.*", ""))
    stop_at(3, "grown", "run two_stages.toml -o grown", by=SIGINT, sets="stage[0].duration=200000 T0")
    edit("grown/resolved.toml", ("^duration = .*", 'duration = "2 T0"'),
         ('^name = "late"', 'name = "late"\nstrength = {criterion = "elongation", elongation = 0.5}'))
    vbond("resume grown", err="breaks.csv is not there, no bond could break so far: a new one begins here")


def test_a_yield_that_is_taken_away_before_going_on():
    # bonds that have it keep it, and frames go on telling what has flowed
    write("yielding.toml", ROD, ("^distance = 1.1", 'distance = 1.1\nwhen = "stage"\nstages = ["stage-1"]\nyield = {axial_force = 0.05}'),
          ("^duration.*", 'duration = "200000 T0"'), ("^frames.*", 'frames = {every = "20 T0"}'))

    def frames():
        return sorted(Path("flown/frames").glob("bonds*.vtp"))

    for more, command in ((2, "run yielding.toml -o flown"), (None, "resume flown")):
        more = len(frames()) if more is None else more
        with Started(command) as run:
            until(lambda: len(frames()) > more, "another frame")
            run.stop(SIGINT)
        if command.startswith("run"):
            edit("flown/resolved.toml", (".*yield.*\n", ""))
    for frame in (frames()[1], frames()[-1]):
        assert b"plastic_elongation" in frame.read_bytes(), f"{frame} tells nothing of what has flowed"


@pytest.mark.parametrize("speed", [4, 5, 6, 8, 20, 100])
def test_fibres_that_go_through_one_another_within_a_step_end_the_run(speed):
    write("fibres.toml", f"""specimen = [
  {{name = "r", kind = "rod", particles = 10, radius = 0.4, mass = 1.0}},
  {{name = "q", kind = "rod", particles = 10, origin = [4.5, -4.4, 1.5], direction = [0, 1, 0], radius = 0.4, mass = 1.0}},
]
contact = {{law = "hertz", E = 20.0, nu = 0.25}}
velocities = [{{group = "q", velocity = [0, 0, -{speed}]}}]
stage = [{{duration = 8, supports = [{{group = "r", {CLAMP}}}]}}]
[[bonds]]
distance = 1.1
{STIFFNESS}
capsule_radius = 0.1
""")
    vbond("run fibres.toml -o", f"fibres-{speed}", status=1, err="the axes of their capsules have passed through one another")


def test_a_first_checkpoint_that_does_not_fit():
    write("large.toml", ROD, ("^particles = 200", "particles = 3000"), ("^frames.*", ""))
    vbond("run large.toml -o large", sets="stage[0].duration=0.2 T0", status=3, limits={resource.RLIMIT_FSIZE: 64 * 1024},
          err="there is no checkpoint, this would have been the first")
