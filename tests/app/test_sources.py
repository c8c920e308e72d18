"""Bodies come in from sources and particles go by sinks: counted, told and drawn; the same after a stop and on other
threads; what cannot be is refused with its place in the file."""
import json
from pathlib import Path

import pytest
from program import STATICS, column, expect_same, stop_at, table, vbond, write

TEXT = """[[specimen]]
name = "grain"
kind = "list"
positions = [[0, 0, 0]]
radius = 0.5
mass = 1.0

[[specimen]]
name = "pair"
kind = "list"
positions = [[0, 0, 0], [1, 0, 0]]
radius = 0.5
mass = 1.0

[[bonds]]
name = "glue"
between = ["pair", "pair"]
distance = 1.0
stiffness = { c_A = 100, c_D = 10, c_B = 1, c_T = 1 }

[contact]
law = "linear"
k = 500.0
tangential = "linear"
k_t = 150.0
friction = 0.3
restitution = 0.5

[[wall]]
name = "floor"
shape = "plane"
normal = [0, 0, 1]

[[source]]
name = "grains"
specimen = "grain"
count = 30
rate = 20
every = 0.1
box = { min = [-3, -3, 4], max = [3, 3, 7] }
velocity = [0, 0, -3]

[[source]]
name = "pairs"
specimen = "pair"
count = 8
rate = 6
every = 0.1
box = { min = [-3, -3, 4], max = [3, 3, 7] }
velocity = [0, 0, -3]
seed = 2

[[sink]]
name = "edge"
box = { min = [-4, -4, -1], max = [4, 4, 20] }
takes = "outside"
every = 0.1

[time]
step = 0.002

[[stage]]
name = "pour"
duration = 4
gravity = [0, 0, -5]

[output]
history = { every = 0.1 }
frames = { every = 0.5 }
lammps_dump = true
"""


@pytest.fixture(scope="module", autouse=True)
def whole(work):
    write("pour.toml", TEXT)
    vbond("check pour.toml", out=["no mistakes found", 'source "grains": 30 bodies of 1 particle and 0 bonds',
                                  'source "pairs": 8 bodies of 2 particles and 1 bond'])
    vbond("run pour.toml -o whole", err=['source "grains": 30 of 30 bodies have come in',
                                         'source "pairs": 8 of 8 bodies have come in'])


def test_the_books_close():
    assert max(map(abs, column("whole", "balance_error"))) < 1e-3
    last = table("whole")[-1]
    assert last["particles_in"] == 46 and last["bonds"] == 8
    assert last["particles"] == 46 - last["particles_out"] and last["particles_out"] > 0
    assert last["mass_in"] == 46 and last["mass_out"] == last["particles_out"]
    assert last["momentum_in_z"] == pytest.approx(-3 * 46)
    # each grain came in with 1/2 m v^2, and so did each of a pair, which does not turn
    assert last["inserted"] == pytest.approx(0.5 * 9 * 46)
    passage = json.loads(Path("whole/run.json").read_text())["passage"]
    assert passage["particles"] == last["particles"] and passage["removed"] == pytest.approx(last["removed"])
    assert [s["came_in"] for s in passage["sources"]] == [30, 8]
    assert [s["due"] for s in passage["sources"]] == [0, 0]


def test_frames_show_who_is_there():
    rows = {row["step"]: row["particles"] for row in table("whole")}
    frames = {int(path.stem.split("_")[1]): path for path in Path("whole/frames").glob("particles_*.vtp")}
    for step in (0, 250, 1000):
        head = frames[step].read_bytes()[:2000].decode(errors="replace")
        assert f'NumberOfPoints="{int(rows[step])}"' in head, (step, head)
    dump = Path("whole/dump.lammpstrj").read_text().split("ITEM: TIMESTEP\n")[1:]
    for frame in dump:
        lines = frame.splitlines()
        assert int(lines[2]) == rows[int(lines[0])] == len(lines) - 8
    vbond("report whole")  # reads frames of different numbers of particles back
    Path("whole/report.html").unlink()


def test_the_same_on_other_threads_and_after_a_stop():
    vbond("run pour.toml -o threads --threads 3", err="have come in")
    expect_same("whole", "threads")
    for rows in (5, 17):
        stop_at(rows, f"at_{rows}", "run", "pour.toml", "-o", f"at_{rows}")
        vbond(f"resume at_{rows}")
        expect_same("whole", f"at_{rows}")


def test_a_source_without_a_rate_goes_on_and_runs_again_from_its_folder():
    write("at_once.toml", TEXT, ("^rate = .*\n", ""))
    vbond("run at_once.toml -o at_once", err="have come in")
    stop_at(5, "at_once_5", "run", "at_once.toml", "-o", "at_once_5")
    vbond("resume at_once_5")
    expect_same("at_once", "at_once_5")
    vbond("run at_once/resolved.toml -o again", err="have come in")
    expect_same("at_once", "again")


def test_who_finds_no_room_is_told():
    vbond("run pour.toml -o full", sets=["source[grains].count=500", "source[grains].rate=10000", "source[grains].tries=3",
                                         "stage[0].duration=1"],
          err=['source "grains": ', " of 500 bodies have come in; ", " more found no room: at a visit 3 places are tried"])
    sources = json.loads(Path("full/run.json").read_text())["passage"]["sources"]
    assert sources[0]["came_in"] + sources[0]["due"] == 500


def test_a_source_in_a_wall_is_told():
    vbond("check pour.toml", sets="source[grains].box={min=[-3,-3,-3],max=[3,3,-1]}",
          out='source "grains": at 200 places in its region a body would touch a wall')


def test_a_body_that_overlaps_itself_is_refused():
    vbond("check pour.toml", sets=["specimen[pair].positions=[[0,0,0],[0.3,0,0]]", "bonds[glue].distance=0.2"], status=2,
          err=["which are not bonded, overlap by"])


def test_a_report_of_bodies_that_come_and_go_between_frames():
    vbond("run pour.toml -o seldom --report", sets=["output.frames.every=4", "source[pairs].rate=1000"], err="have come in",
          no_err=["damaged", "report"])
    assert Path("seldom/report.html").exists()


@pytest.mark.parametrize("old, new, told", [
    ('specimen = "grain"', 'specimen = "grian"', ['there is no specimen "grian"', 'did you mean "grain"?']),
    ('specimen = "pair"', 'specimen = "grain"', ['specimen "grain" comes in from another source already']),
    ("box = { min = [-3, -3, 4], max = [3, 3, 7] }\nvelocity = [0, 0, -3]\nseed",
     "box = { min = [-1, -1, 4], max = [0.5, 0.5, 5] }\nseed", ["no body fits into its region", 'fit = "centre"']),
    ("box = { min = [-3, -3, 4], max = [3, 3, 7] }\nvelocity = [0, 0, -3]\nseed",
     "plane = { point = [0, 0, 0], normal = [0, 0, 1], within = 1 }\nseed", ["plane", "box, sphere, cylinder, mesh"]),
    ("gravity = [0, 0, -5]", 'supports = [{ group = "pair", fix = ["x"] }]', ["a support of group \"pair\"", 'comes in from source "pairs"']),
    ("gravity = [0, 0, -5]", 'loads = [{ group = "all", total_force = [0, 0, 1] }]', ["a total load of group \"all\""]),
    ("history = { every = 0.1 }", 'history = { every = 0.1, displacements = ["all"] }', ["it has no place at the start"]),
    ("distance = 1.0", "pairs = [[0, 1]]", ["pair 0, 1"]),
    ('rate = 6', 'rate = 6\nstages = ["por"]', ['stages has "por"', 'did you mean "pour"?']),
    ('name = "glue"', 'name = "glue"\ncapsule_radius = 0.2', ["touch as capsules"]),
])
def test_refused(old, new, told):
    expect_refused(old, new, told)


@pytest.mark.skipif(not STATICS, reason="built without statics")
@pytest.mark.parametrize("old, new, told", [
    ('[time]\nstep = 0.002', '[time]\nstep = "exact"', ["bodies still come in or go"]),
    ('[[stage]]', '[[stage]]\nname = "first"\nkind = "equilibrium"\n[[stage]]', ["particles wait to come in"]),
])
def test_refused_of_statics(old, new, told):
    expect_refused(old, new, told)


def expect_refused(old, new, told):
    assert TEXT.count(old) == 1, old
    write("wrong.toml", TEXT.replace(old, new))
    vbond("check wrong.toml", status=2, err=["wrong.toml:", *told])


# Five particles go side by side. A sink takes one of them after a way of 5, where it stops.
GONE = """specimen = [{name = "a", kind = "list", positions = [[0, 0, 0], [0, 5, 0], [0, 0, 5], [2, 5, 0], [0, 5, 2]], radius = 0.5, mass = 1.0}]
velocities = [{velocity = [1, 0, 0]}]
groups = {one = {indices = [0]}}
sink = [{group = "one", half_space = {point = [5, 0, 0], normal = [-1, 0, 0]}, every = 0.1}]
time = {step = 0.01}
stage = [{duration = 20}]
output = {history = {every = 2, displacements = ["a", 0, 1], velocities = ["a", 0, 1], stress = [{group = "a", volume = 10.0}]}}
"""


def test_means_are_of_those_that_are_there(work):
    write("gone.toml", GONE)
    vbond("run gone.toml -o gone")
    rows = table("gone")
    assert [row["particles"] for row in rows] == [5] * 3 + [4] * 8
    for row in rows:
        for name, moves in ("displacement", row["time"]), ("velocity", 1.0):
            of_group, of_one, of_another = (row[f"{name}.{group}.x"] for group in ("a", 0, 1))
            assert of_group == pytest.approx(moves, abs=1e-9) and of_another == pytest.approx(moves, abs=1e-9), (name, row)
            assert of_one == (pytest.approx(moves, abs=1e-9) if row["particles"] == 5 else None), (name, row)
        assert all(abs(row[f"strain.a.{part}"]) < 1e-9 for part in ("xx", "yy", "zz", "yz", "zx", "xy")), row
