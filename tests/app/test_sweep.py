"""Changes of keys from the command line, cases from the standard input, and sweeps, which go on after they were killed,
run nothing twice, and name what failed."""
import json
import re
from pathlib import Path
from signal import SIGKILL, SIGTERM

import pytest
from program import EXAMPLES, Started, contents, lines, same_bytes, table, until, vbond, write

ROD = EXAMPLES / "rod_dynamic.toml"


def test_one_changed_key():
    vbond("run", write("edited.toml", ROD.read_text(), ('^duration = "600 T0"', 'duration = "7 T0"')), "-o", "edited")
    said = vbond("run - -o changed --quiet", stdin=ROD.read_text(), sets="stage[release].duration=7 T0")
    assert not said.out, "--quiet prints"
    first, *rest = Path("changed/resolved.toml").read_text().splitlines()
    assert first == "# --set stage[release].duration=7 T0", "resolved.toml does not say what was changed"
    assert rest == Path("edited/resolved.toml").read_text().splitlines(), "the change does not mean what the edit means"
    assert same_bytes("edited/history.csv", "changed/history.csv")
    vbond("check", ROD, sets=["time={fraction = 0.1}", "output.frames.every=20 T0", "bonds[0].law=evm"])


@pytest.mark.parametrize("change, texts", [
    ("stage[0].durations=2", ["no such key", "did you mean duration?"]),
    ("stage[7].duration=3", ["stage has no item 7", "it has 2: compress, release"]),
    ("stage[rest].duration=3", ["stage has no item rest"]), ("stage.duration=3", ["say which of its items"]),
    ("title[0]=a", ["title is no list"]), ("title.of=a", ["title is a string", "nothing can stand below it"]),
    ("wall[0].kind=plane", ["the case has no wall"]), ("bonds[0].nu=0.7", ["must satisfy -1 < nu"]),
    ("title", ["no value is given"]), ("title=", ["the value is missing"]), ("=3", ["a name of a key is missing"]),
    ("title=[1, 2", ["the value is no TOML"]), ("stage[0.duration=1", ["a bracket is not closed"]),
    ('"title=1', ["a name of a key is missing"]), ("title=1979-05-27", ["title"])])
def test_changes_that_are_refused(change, texts):
    vbond("check", ROD, sets=change, status=2, err=[f"--set {change}: ", *texts])


def test_a_sweep_that_has_ended():
    sweep = ["sweep", ROD, "--set", "velocities[0].seed=range(1, 6, 6)", "--set", "stage[release].duration=50 T0,-3 T0", "-o", "whole"]
    vbond(*sweep, "--jobs", 2, status=1, out=["12 points, 6 failed", "curves in whole/sweep.html"])
    text = Path("whole/sweep.csv").read_text()
    assert text.count("\n") == 13, "sweep.csv has other rows than one of each point"
    assert len(re.findall("^[0-9]*,[1-6],-3 T0,failed,.*must satisfy 0 < duration", text, re.M)) == 6, text
    found = re.search('^<script type="application/json" id="sweep">(.*)</script>$', Path("whole/sweep.html").read_text(), re.M).group(1)
    overview = json.loads(found)
    assert overview["format"] == 1 and list(overview)[0] == "format"
    assert overview["keys"][0] == {"name": "velocities[0].seed", "values": list("123456")}
    assert found.count('"ended":"failed","reason":"') == 6 and '"history.time"' in found
    before = contents("whole")
    vbond(*sweep, status=1, out="12 of 12 points have ended before")
    assert contents("whole") == before, "a sweep that had ended has changed something"
    vbond("sweep", ROD, "-o", "whole", sets="velocities[0].seed=1,2", status=2, err="has another sweep")


@pytest.mark.parametrize("wrong", ["velocities[0].seeds=1,2", "a", "a=", "a=1,,2", "a=range(1,2)", "a=range(1,x,3)", "a=logrange(0,1,3)",
                                   "a=range(0,1,1.5)", "a=range(1,2,3"])
def test_sweeps_that_are_refused(wrong):
    vbond("sweep", ROD, "-o", "none", sets=wrong, status=2, err="did you mean seed?" if "seeds" in wrong else f"--set {wrong}: ")
    assert not Path("none").exists(), "a refused sweep has written something"


def test_a_sweep_that_is_killed_and_stopped_goes_on():  # with the runs under way, by the same command
    more = ["sweep", ROD, "--jobs", 2, "--set", "velocities[0].seed=range(1, 16, 16)", "--set", "stage[release].duration=300 T0", "-o"]
    for by in (SIGKILL, SIGTERM):
        had = lines("parts/sweep.journal")
        with Started(*more, "parts") as sweep:
            sweep.until(lambda: lines("parts/sweep.journal") >= had + 4).stop(by)
        until(lambda: not runs_in("parts"), "an end of the runs", 30)
    vbond(*more, "parts", out="16 points, 0 failed")
    journal = [line.split(",")[0] for line in Path("parts/sweep.journal").read_text().splitlines()]
    assert len(journal) == len(set(journal)) == 16, f"points ran twice: {journal}"
    vbond(*more, "undisturbed")
    one, other = ([{name: value for name, value in row.items() if name not in ("seconds", "reason")} for row in table(f"{folder}/sweep.csv")]
                  for folder in ("undisturbed", "parts"))
    assert one == other, "other results"


def runs_in(folder):
    """Processes of this test that write below the folder."""
    here = str(Path(folder).resolve().parent)
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if f"{folder}/00" in (process / "cmdline").read_text() and str((process / "cwd").resolve()) == here:
                found.append(process.name)
        except OSError:
            pass  # it has ended
    return found
