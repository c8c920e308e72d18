"""A run that is stopped by a signal at any step and resumed leaves the same files, byte for byte, as one that was never
disturbed; run.json but for wall times and what it was computed with."""
import shutil
from pathlib import Path
from signal import SIGHUP, SIGINT, SIGKILL, SIGTERM

import pytest
from program import EXAMPLES, HERE, PROGRAM, expect_same, lines, number, stop_at, table, values, vbond, write

CASE = HERE / "resume.toml"


@pytest.fixture(scope="module")
def whole(work):
    """The case must have what it is there for: bonds made on approach during both stages and as the second begins,
    contacts, damping, work of loads and supports, and a bond that the watch has reported."""
    vbond("run", CASE, "-o", "whole")
    rows, first_stage = table("whole"), number("whole", "steps")
    bonds = [rows[0]["bonds"], max(row["bonds"] for row in rows if row["step"] < first_stage),
             next(row["bonds"] for row in rows if row["step"] > first_stage), rows[-1]["bonds"]]
    assert bonds == sorted(set(bonds)), f"bonds at the start, in stage one, as stage two begins, at the end: {bonds}"
    assert any(row["contact"] > 0 for row in rows) and rows[-1]["dissipated"] > 0
    assert rows[-1]["work_loads"] and rows[-1]["work_supports"]
    assert number("whole", "ever_strained") == 1
    return "whole"


def stopped(rows, by, folder, command, *more):
    run = stop_at(rows, folder, command, *more, by=by)
    if by != SIGKILL:
        last = run.err.splitlines()[-1]
        assert last.endswith(f"go on with: {PROGRAM} resume {folder}"), f"no way to go on: {run}"
        run.expect(128 + by, out=f"results in {folder}")
        assert values(folder, "stop")[-1] == "interrupted"


# Nothing can be written on SIGKILL: the last regular checkpoint serves, and what was written after it is dropped.
@pytest.mark.parametrize("stops, threads", [
    ([(1 / 7, SIGTERM)], None), ([(0.7, SIGTERM)], 2), ([(0.3, SIGTERM), (0.6, SIGINT), (0.8, SIGTERM)], None),
    ([(0.2, SIGHUP)], None), ([(0.5, SIGKILL)], None)], ids=["early", "on other threads", "thrice", "hung up", "killed"])
def test_stopped_and_resumed(whole, stops, threads, request):
    folder = request.node.callspec.id.replace(" ", "_")
    command = ["run", CASE, "-o", folder]
    for part, by in stops:
        stopped(int(lines("whole/history.csv") * part), by, folder, *command)
        command = ["resume", folder]
    vbond(*command, *(["--threads", threads] if threads else []))
    expect_same(whole, folder)


def test_a_run_that_had_come_to_its_end_has_nothing_left_to_do(whole):
    shutil.copytree("whole", "ended")
    vbond("resume ended")
    expect_same(whole, "ended")
    # The comparison itself: one digit of one file is seen.
    history = Path("ended/history.csv")
    history.write_text(history.read_text()[:-2] + "x\n")
    with pytest.raises(AssertionError, match="history.csv"):
        expect_same(whole, "ended")


def test_the_number_of_threads_changes_nothing():  # neither from the start nor midway, of a body that they share
    vbond("run", HERE / "threads.toml", *"-o large --threads 1".split())
    stopped(15, SIGTERM, "shared", "run", HERE / "threads.toml", *"-o shared --threads 3".split())
    vbond("resume shared --threads 2")
    expect_same("large", "shared")


@pytest.mark.parametrize("attempt", range(3))
def test_a_signal_before_the_first_step(attempt):  # as soon as there is a file
    write("long.toml", (EXAMPLES / "two_particles.toml").read_text(), ("^duration = .*", 'duration = "20000 T0"'))
    folder = f"early_{attempt}"
    stop_at(1, folder, "run long.toml -o", folder)
    assert Path(folder, "checkpoint.h5").stat().st_size


STAGES = """
[[specimen]]
kind = "rod"
particles = 5
radius = 0.4
mass = 1.0
inertia = 0.064
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.4, c_B = 0.05, c_T = 0.05}
[[stage]]
name = "first"
duration = 10.0
[[stage]]
name = "second"
duration = 1e6
[[stage]]
name = "third"
duration = 20.0
[output]
history = {every = 10.0}
"""


@pytest.mark.parametrize("by", [SIGTERM, SIGKILL], ids=["stopped", "killed"])
def test_stages_that_have_begun_keep_their_places(work, by):
    # A checkpoint counts stages. Without the first one "third" would go on where "second" was; with one more before it
    # "second" would begin anew.
    folder = f"begun_{by.name}"
    stop_at(20, folder, "run", write("stages.toml", STAGES, ("^history.*", "history = {every = 10.0}\\ncheckpoint = {every = 10.0}")),
            "-o", folder, by=by)
    whole = Path(folder, "resolved.toml").read_text()
    first = whole[whole.index("[[stage]]"):whole.index("[[stage]]", whole.index("[[stage]]") + 1)]
    for edit, rule in [(whole.replace(first, ""), '"first", and is "second" now'),
                       (whole.replace(first, first + first.replace('"first"', '"more"')), '"second", and is "more" now'),
                       (whole.replace('"second"', '"renamed"'), '"second", and is "renamed" now')]:
        Path(folder, "resolved.toml").write_text(edit)
        vbond("resume", folder, status=2, err=[rule, "stages that have begun keep their place and their name"])
    Path(folder, "resolved.toml").write_text(whole.replace("1000000.0", "30.0").replace('"third"', '"last"'))
    # later stages, and how long this one lasts, may be edited; where names are not known, that is told
    Path(folder, "status.json").write_text("{")
    vbond("resume", folder, err=["not checked whether the stages", "status.json: is not a status of a run"])
    assert values(folder, "name")[-3:] == ["first", "second", "last"]


WARM = """
[[specimen]]
kind = "list"
positions = [[0, 0, 0], [1, 0, 0]]
mass = 1.0
radius = 0.3
[[bonds]]
distance = 1.1
expansion = 0.01
stiffness = {c_A = 100.0, c_D = 10.0, c_B = 10.0, c_T = 10.0}
[time]
step = 0.001
[[stage]]
duration = 1000000.0
damping = {translation = 5.0}
temperatures = [{temperature = 2.0}]
[output]
history = {every = 10.0, displacements = [1, 0]}
"""


def test_other_temperatures_act_and_other_expansions_are_refused(work):
    stop_at(3, "warm", "run", write("warm.toml", WARM), "-o", "warm", by=SIGTERM)
    whole = Path("warm/resolved.toml").read_text()
    Path("warm/resolved.toml").write_text(whole.replace("expansion = 0.01", "expansion = 0.05"))
    vbond("resume", "warm", status=2, err="its bonds are not those of the checkpoint")
    now = int(Path("warm/history.csv").read_text().splitlines()[-1].split(",")[0].split(".")[0])
    Path("warm/resolved.toml").write_text(
        whole.replace("temperature = 2.0", "temperature = 5.0").replace("1000000.0", f"{now + 40}.0"))
    vbond("resume", "warm")
    last = dict(zip(*(line.split(",") for line in (Path("warm/history.csv").read_text().splitlines()[k] for k in (0, -1)))))
    grown = float(last["displacement.1.x"]) - float(last["displacement.0.x"])
    assert abs(grown - 0.05) < 1e-6
    assert abs(float(last["balance_error"])) < 1e-4  # the jump is booked; (omega dt)^2 = 2e-4 of it is not
