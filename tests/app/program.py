"""What tests of the program share: it is run in a folder of the test's own, and the files that it writes are read."""
import csv
import filecmp
import json
import os
import re
import resource
import shlex
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path
from signal import SIGTERM

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PROGRAM = os.path.abspath(os.environ.get("VBOND", ROOT / "build/release/vbond"))
STATICS = os.environ.get("VBOND_STATICS", "1") == "1"
EXAMPLES = ROOT / "examples"
TEMPLATE = "<!doctype html>\n<!-- run -->\n</html>\n"  # of a report page, in place of the real one
CLAMP = 'fix = ["x", "y", "z", "rx", "ry", "rz"]'


# ---- the program ----------------------------------------------------------------------------------------------------
def listed(texts):
    return [texts] if isinstance(texts, str) else list(texts)


def words(command, more, sets=()):
    """A command as a shell splits it, arguments that are not split, and a --set for each text of sets."""
    return [*shlex.split(command), *map(str, more), *(word for text in listed(sets) for word in ("--set", text))]


class Ended:
    """A command that has ended: its status, as a shell tells it, and what it said."""

    def __init__(self, command, status, out, err):
        self.command = " ".join(map(str, command))
        self.status = 128 - status if status < 0 else status
        self.out, self.err = out, err

    def __str__(self):
        return f"{self.command}\nstatus {self.status}\n--- out\n{self.out}--- err\n{self.err}"

    def expect(self, status=0, out=(), err=(), no_out=(), no_err=()):
        """The status, texts that stand in what it said, and texts that do not."""
        assert self.status in (status if isinstance(status, tuple) else (status,)), f"expected status {status} of {self}"
        for stream, texts in (("out", out), ("err", err)):
            for text in listed(texts):
                assert text in getattr(self, stream), f"no '{text}' in {stream} of {self}"
        for stream, texts in (("out", no_out), ("err", no_err)):
            for text in listed(texts):
                assert text not in getattr(self, stream), f"'{text}' in {stream} of {self}"
        return self

    def silent(self):
        assert not self.err, f"noise on stderr: {self}"
        return self


def call(command, stdin=subprocess.DEVNULL, env=None, limits=None, **options):
    """Any command, with changes of the environment, where None takes a variable away, and limits as RLIMIT_FSIZE: bytes."""
    if limits:
        options["preexec_fn"] = lambda: [resource.setrlimit(what, (limit, limit)) for what, limit in limits.items()]
    surroundings = {name: value for name, value in {**os.environ, **(env or {})}.items() if value is not None}
    done = subprocess.run(command, stdin=None if isinstance(stdin, str) else stdin, env=surroundings, text=True, encoding="utf-8",
                          errors="replace", stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          **({"input": stdin} if isinstance(stdin, str) else {}), **options)
    return Ended(command, done.returncode, done.stdout, done.stderr)


def vbond(command, *more, sets=(), status=0, out=(), err=(), no_out=(), no_err=(), **options):
    """Runs the program: vbond("check a.toml", "--set", "title=two words", out="no mistakes")."""
    return call([PROGRAM, *words(command, more, sets)], **options).expect(status, out, err, no_out, no_err)


def refused(case, *err, sets=(), status=2, **options):
    """By check and by run, which writes nothing."""
    for command in ("check", "run -o refused"):
        vbond(command, case, sets=sets, status=status, err=err, **options)
    assert not Path("refused").exists(), "a case that is refused leaves a folder"


def until(condition, what="it", seconds=120):
    """Waits, not for ever."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"never: {what}"
        time.sleep(0.01)


class Started:
    """The program in the background; it is killed if the test ends before."""

    def __init__(self, command, *more, sets=(), env=None, program=PROGRAM, **options):
        self.command = [program, *words(command, more, sets)]
        self.out, self.err = (open(f".{id(self)}.{name}", "w+", encoding="utf-8") for name in ("out", "err"))
        self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=self.out, stderr=self.err,
                                        env={**os.environ, **(env or {})}, **options)
        self.pid = self.process.pid

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        for stream in (self.out, self.err):
            stream.close()
            Path(stream.name).unlink(missing_ok=True)

    def runs(self):
        return self.process.poll() is None

    def said(self, stream="out"):
        return Path(getattr(self, stream).name).read_text(encoding="utf-8", errors="replace")

    def until(self, condition):
        """Waits until the condition holds, or the program has ended."""
        while self.runs() and not condition():
            time.sleep(0.01)
        return self

    def signal(self, number):
        assert self.runs(), f"it had ended by itself: {self.ended()}"
        self.process.send_signal(number)
        return self

    def ended(self):
        status = self.process.wait()
        return Ended(self.command, status, self.said("out"), self.said("err"))

    def stop(self, number=SIGTERM):
        return self.signal(number).ended().expect(128 + number)


def stop_at(rows, folder, command, *more, by=SIGTERM, table="history.csv", **options):
    """Sends the signal once a table in the folder has so many lines, the header included."""
    with Started(command, *more, **options) as run:
        return run.until(lambda: lines(f"{folder}/{table}") >= rows).stop(by)


# ---- cases ----------------------------------------------------------------------------------------------------------
def edited(text, *changes):
    """Each change is a pattern, in which ^ and $ are the ends of a line, and what takes its place; it must be found."""
    for pattern, new in changes:
        text, count = re.subn(pattern, lambda match: match.expand(new), text, flags=re.M)
        assert count, f"nothing to change by {pattern!r} in:\n{text}"
    return text


def write(name, text, *changes):
    Path(name).write_text(edited(text, *changes), encoding="utf-8")
    return name


def edit(name, *changes):
    write(name, Path(name).read_text(), *changes)


def line_of(name, start):
    """The number of the first line that starts so."""
    return next(k for k, line in enumerate(Path(name).read_text().splitlines(), 1) if line.startswith(start))


# ---- files of a run -------------------------------------------------------------------------------------------------
def lines(path):
    """The number of lines of a file; 0 while it is not there."""
    try:
        return Path(path).read_bytes().count(b"\n")
    except FileNotFoundError:
        return 0


def read(folder, file="run.json"):
    return json.loads(Path(folder, file).read_text())


def values(folder, key, file="run.json"):
    """All values of that key, wherever it stands in a JSON file of a folder, in order."""
    def walk(found):
        if isinstance(found, list):
            return [value for item in found for value in walk(item)]
        if not isinstance(found, dict):
            return []
        return [value for name, item in found.items() for value in ([item] if name == key else []) + walk(item)]
    return walk(read(folder, file))


def number(folder, key, file="run.json"):
    """The first number of that key."""
    numbers = [value for value in values(folder, key, file) if isinstance(value, (int, float))]
    assert numbers, f"no number {key} in {folder}/{file}: {read(folder, file)}"
    return numbers[0]


def cell(text):
    try:
        return float(text)
    except ValueError:
        return text or None


def table(path):
    """A CSV file as dicts, of history.csv if a folder is given: numbers where it has some, None where a cell is empty."""
    path = Path(path)
    with (path / "history.csv" if path.is_dir() else path).open(newline="", encoding="utf-8") as file:
        return [{name: cell(text) for name, text in row.items()} for row in csv.DictReader(file)]


def column(path, name):
    rows = table(path)
    assert rows and name in rows[0], f"no column {name} in {path}: {list(rows[0]) if rows else 'empty'}"
    return [row[name] for row in rows]


def at_load(path, name, load_factor=1.0):
    """The values of a column in the rows of a load factor."""
    return [row[name] for row in table(path) if row["load_factor"] is not None and abs(row["load_factor"] - load_factor) < 1e-12]


def frames(path):
    """The timesteps and files of a .pvd."""
    return re.findall(r'timestep="([^"]*)".*?file="([^"]*)"', Path(path).read_text())


def contents(folder, *without):
    """The bytes of all files below a folder, but for names that match these patterns."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(Path(folder).rglob("*"))
            if path.is_file() and not any(path.match(pattern) for pattern in without)}


def without_times(folder):
    """run.json without what depends on the machine and its load."""
    return {key: value for key, value in read(folder).items()
            if key not in ("bond_steps_per_second", "instruction_set", "blas_kernel", "wall_time") and not key.startswith("threads")}


def expect_same(whole, other, *without):
    """Two output folders hold the same, byte for byte; run.json but for wall times and what it was computed with."""
    one, two = (contents(folder, "run.json", "status.json", *without) for folder in (whole, other))
    assert one.keys() == two.keys(), f"only in {whole}: {one.keys() - two.keys()}; only in {other}: {two.keys() - one.keys()}"
    differ = [name for name in one if one[name] != two[name]]
    assert not differ, f"{other} differs from {whole}: {differ}"
    assert without_times(whole) == without_times(other)


def same_bytes(one, two):
    return filecmp.cmp(one, two, shallow=False)


def page(folder, element="run"):
    """What stands in an element of a report page."""
    found = re.search(rf'id="{element}">(.*)</script>', (Path(folder) / "report.html").read_text(encoding="utf-8"))
    return found.group(1) if found else ""


def processor_has(*flags):
    known = Path("/proc/cpuinfo").read_text().split()
    return all(flag in known for flag in flags)


def instruction_sets():
    """Those that this machine can execute, the best last."""
    needs = {"baseline": (), "avx2": ("avx2",), "avx512": ("avx512f", "avx512dq", "avx512vl")}
    return [name for name, flags in needs.items() if processor_has(*flags)]


# ---- examples -------------------------------------------------------------------------------------------------------
STATIC = re.compile(r'^kind = "(?:equilibrium|path|buckling|modes|fracture)"', re.M)


def run_example(name, *sets):
    """An example has no mistakes as it is shipped, and with these changes it runs to its end, into NAME.out; the energy
    balance error stays below 1e-3 where it moves, and below 1e-9 where it breaks at rest."""
    path = EXAMPLES / f"{name}.toml"
    case = path.read_text()
    vbond("check", path, out="no mistakes found")
    out = f"{name}.out"
    run = vbond("run", path, "-o", out, sets=sets)
    stages = len(re.findall(r"^\[\[stage\]\]", case, re.M))
    error, at_rest = number(out, "energy_balance_error"), values(out, "balance_error")
    assert (error > 0) == (stages > len(STATIC.findall(case))) and error < 1e-3
    assert all(abs(x) < 1e-9 for x in at_rest), f"energy balance error at rest {at_rest}"
    assert len(at_rest) == len(re.findall(r'^kind = "fracture"', case, re.M)), "energy balance of a fracture stage is missing"
    assert len(values(out, "stop") + values(out, "ended")) == stages, "a stage is missing"
    assert '"failed"' not in Path(out, "run.json").read_text(), "a stage has failed"
    print(f"{name}: largest error of the energy balance: {error}, at rest: {at_rest}")
    return run


# ---- machines -------------------------------------------------------------------------------------------------------
@contextmanager
def disk(size):
    """A disk of its own, mounted as the folder `disk`, and what resizes it; where none may be mounted, the test is skipped."""
    def mount(*options):
        return subprocess.run(["mount", "-t", "tmpfs", "-o", *options, "none", "disk"], capture_output=True).returncode == 0

    Path("disk").mkdir(exist_ok=True)
    if not mount(f"size={size}"):
        pytest.skip("no disk may be mounted here")
    try:
        yield lambda size: mount(f"remount,size={size}")
    finally:
        subprocess.run(["umount", "disk"], check=True)
