"""Which values a sweep takes, of one key and of keys that go together; what it refuses; and that no key is set twice, in
sweeps and elsewhere."""
import re
from pathlib import Path

import pytest
from program import EXAMPLES, column, vbond

CASE = EXAMPLES / "two_particles.toml"
BRIEF = "stage[0].duration=0.02 T0"
TWICE = "sets this key, or a part of it, already"


def swept(name, *sets, status=0, **expected):
    """A brief sweep: its table as text."""
    vbond("sweep", CASE, "-o", name, "--jobs", 2, sets=sets, status=status, **expected)
    return Path(name, "sweep.csv").read_text() if status < 2 else None


def value(point, key):
    return re.search(f"^ *{key} = (.*)", Path(point, "resolved.toml").read_text(), re.M).group(1)


def test_titles():
    table = swept("titles", BRIEF, r'''title="a\"b","c,\\","d",'e,"',@f,plain,"""g"h,i"""''')
    expected = [r'"a\"b"', r'"c,\\"', '"d"', r'"e,\""', '"@f"', '"plain"', r'"g\"h,i"']
    assert '\n5,0.02 T0,"""@f""",done' in table, "what a spreadsheet takes for a formula stands in quotes"
    assert table.count("\n") == 8 and [value(f"titles/000{k}", "title") for k in range(1, 8)] == expected, table


def test_reasons_stand_in_quotes():  # they may begin as what a spreadsheet takes for a formula
    table = swept("reasons", BRIEF, "bonds[0].nu=0.1,-3,0.7", status=1)
    assert re.search('^2,0.02 T0,-3,failed,[0-9.]*,"""--set bonds', table, re.M), table


@pytest.mark.parametrize("key, values, expected", [
    ("nu", "range(1e308,-1e308,3)", [1e308, 0, -1e308]), ("nu", "range(0,1.5e308,4)", [0, 5e307, 1e308, 1.5e308]),
    ("E", "logrange(1e-300,1e300,3)", [1e-300, 1, 1e300]), ("E", "logrange(1e300,1e-300,3)", [1e300, 1, 1e-300])])
def test_ranges_whose_difference_product_or_ratio_is_no_number(key, values, expected):
    swept(values, BRIEF, f"bonds[0].{key}={values}", status=1)
    assert column(f"{values}/sweep.csv", f"bonds[0].{key}") == pytest.approx(expected, rel=1e-12, abs=0)


def test_keys_that_go_together():
    table = swept("tied", BRIEF, 'bonds[0].nu,title=0.1:"x:y",0.2:"z"', "units.system=reduced")
    assert table.startswith("point,stage[0].duration,bonds[0].nu,title,units.system,ended,seconds,reason,") and table.count("\n") == 3
    assert [value("tied/0001", "nu")[:3], value("tied/0001", "title"), value("tied/0002", "nu")[:3], value("tied/0002", "title")] == \
        ["0.1", '"x:y"', "0.2", '"z"']
    swept("product", "bonds[0].nu, stage[0].duration = range(0.1, 0.3, 3) : range(1, 3, 3) T0", "velocities[0].velocity=[0, 0, 0],[1e-3, 0, 0]")
    assert list(zip(column("product/sweep.csv", "bonds[0].nu"), column("product/sweep.csv", "stage[0].duration"))) == \
        [(nu, time) for nu, time in ((0.1, "1 T0"), (0.2, "2 T0"), (0.3, "3 T0")) for _ in range(2)]


@pytest.mark.parametrize("sets, told", [
    (["a=range(0,1,1e12)"], "the count must be a whole number from 2 to 1000000"),
    (["a,b=1:2,3"], "2 keys go together, and one of the values has 1 parts"),
    (["a,b=1:2:3"], "2 keys go together, and one of the values has 3 parts"),
    (["a,b=range(1,2,3):range(1,2,4)"], "keys that go together take ranges of one count"),
    (["a,b=range(1,2,3):4"], "keys that go together take ranges of one count"),
    (["a=range(1,2,3),4"], "a range stands in place of all values of a key"),
    (["a,b=1:2,logrange(1,2,3):3"], "a range stands in place of all values of a key"),
    (["a,=1:2"], "a name of a key is missing"), (["a,b=1:,2:3"], "a value is empty"),
    (["title=1 # one"], "the value is no TOML"), (["title==1+1"], "the value is no TOML"),
    (["title=a\nb"], "--set title=a b: there is a line break"),
    (["a=range(0,1,1e4)", "b=range(0,1,1e4)"], "at most 1000000 points"),
    (["bonds[0].nu=0.1,0.2", "bonds[0].nu=0.3"], f"--set bonds[0].nu=0.3: --set number 1 {TWICE}"),
    (["title,title=a:b"], TWICE), (["stage[swing].duration=1 T0,2 T0", "stage[0].duration=3 T0"], TWICE)])
def test_refused(sets, told):
    vbond("sweep", CASE, "-o", "none", "--jobs", 2, sets=sets, status=2,
          err=told if len(sets) > 1 or told == TWICE or "line break" in told else f"--set {sets[0]}: {told}")
    assert not Path("none").exists()


@pytest.mark.parametrize("command", ["run", "check", "export -o none"])
def test_no_key_is_set_twice_elsewhere(command):
    vbond(command, CASE, sets=["time.step=0.01 T0", "stage[swing].duration=2 T0", "stage[0].duration=3 T0"], status=2,
          err=f"--set stage[0].duration=3 T0: --set number 2 {TWICE}")
    assert not Path("none").exists() and not Path("two_particles.out").exists()
