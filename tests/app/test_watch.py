"""status.json of runs that go on, end, diverge, are stopped and are killed, what `vbond watch` says of them and who may see
its page; it believes no damaged file."""
import fcntl
import json
import os
import re
import shutil
import signal
import socket
from pathlib import Path

import pytest
from program import (CLAMP, EXAMPLES, HERE, PROGRAM, STATICS, Started, edited, lines, number, read, same_bytes, table, until, vbond,
                     values, write)

GOOD = (EXAMPLES / "two_particles.toml").read_text()
LONG = ["stage[0].duration=1e9 T0", "output.history.every=1000 T0", "output.frames.every=1e8 T0", "output.checkpoint.every=1e4 T0"]


def status(folder):
    try:
        return read(folder, "status.json")
    except FileNotFoundError:
        return {"state": None, "seconds_left": None}


@pytest.fixture(scope="module", autouse=True)
def alone(work):
    vbond("run", write("good.toml", GOOD), "-o", "alone").silent()


def test_a_run_that_is_complete():
    vbond("run good.toml -o whole").silent()
    told, last = status("whole"), table("whole")[-1]
    stage = told["stage"]
    assert (told["state"], told["schema"], told["case"], stage["index"], stage["kind"], stage["name"]) == (
        "complete", 1, "Two bonded particles swing along their bond", 0, "dynamics", "swing")
    for key in ("step time kinetic_translation kinetic_rotation U_L U_B U_T contact dissipated work_loads work_supports total").split():
        assert number("whole", key, "status.json") == last[key], f"{key} is another one in the last row of history.csv"
    assert values("whole", "broken", "status.json") == [None] and values("whole", "failure", "status.json") == [None]
    said = vbond("watch whole", out=[f"complete; stage swing (1 of 1, dynamics), step {last['step']:.0f}, t = ", "kinetic ", "stored ",
                                     "the run is complete"]).out
    assert said.count("\n") == 1, f"more than a line: {said}"
    assert not list(Path("whole").rglob("*.part")), "half a file is left"
    Path("whole/mine").touch()
    vbond("run good.toml -o whole --force --set 'stage[0].duration=3 T0'")
    assert Path("whole/mine").exists(), "--force has taken more than its own files"


def test_lines_of_json():  # the last of which is the file
    said = vbond("run good.toml -o lines --json").out.splitlines()
    assert len(said) >= 3 and all(line.startswith('{"schema":1,') and line.endswith("}") for line in said), said
    last = json.loads(said[-1])
    assert last["state"] == "complete" and last["step"] == number("lines", "step", "status.json")
    vbond("run good.toml --json --quiet", status=2)


# ---- running: looked at by many, killed, stopped --------------------------------------------------------------------
def test_a_run_that_is_killed():
    with Started("run good.toml -o killed", sets=LONG) as run:
        until(lambda: status("killed")["seconds_left"] is not None, "a time that is left")
        told = status("killed")
        assert told["state"] == "running" and told["process"] == run.pid
        assert number("killed", "step", "status.json") > 0 and told["wall_seconds"] > 0.9
        assert number("killed", "end_time", "status.json") > 1e9
        vbond("watch killed --once", out=["running; stage swing (1 of 1, dynamics), step ", " of at most ", " left; kinetic "])
        with Started("watch killed") as watcher:
            until(lambda: watcher.said().count("\n") >= 3, "three lines")
            for _ in range(300):  # at every moment it is whole
                vbond("watch killed --once")
            until(lambda: "checkpoint written at step" in watcher.said(), "a checkpoint")
            run.stop(signal.SIGKILL)
            end = watcher.ended().expect(1, err=f"go on with: {PROGRAM} resume killed")
    said = end.out.splitlines()
    assert len(said) == len(set(said)), f"a line without a change: {end}"
    assert said[-1].startswith(f"gone: process {run.pid} has ended without a word"), end
    assert re.search("checkpoint written at step [1-9]", end.out), end
    assert status("killed")["state"] == "running", "who has written that?"
    vbond("watch killed --once", status=1)


@pytest.fixture(scope="module")
def stopped(alone):
    """Ctrl-C of the watcher ends the watcher; that of the run is told."""
    with Started("run good.toml -o stopped", sets=LONG) as run:
        until(lambda: status("stopped")["state"] == "running", "a run")
        with Started("watch stopped") as watcher:
            until(lambda: "running" in watcher.said(), "a line")
            watcher.stop(signal.SIGINT)
        run.stop()
    assert status("stopped")["state"] == "interrupted"
    vbond("watch stopped", status=1, out=["interrupted; ", "stopped by a signal"], err=f"go on with: {PROGRAM} resume stopped")
    return "stopped"


# ---- in a browser: nobody without the token, nothing but the page and how the run stands ----------------------------
class Page:
    def __init__(self, address):
        found = re.fullmatch("http://127.0.0.1:([0-9]+)/([0-9a-f]{32}/)", address)
        assert found, f"the address: {address}"
        self.port, self.token = int(found.group(1)), found.group(2)

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=20)

    def answer(self, path, method="GET", host="127.0.0.1"):
        """Status, and all that the server says."""
        with self.connect() as server:
            server.sendall(f"{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
            said = b"".join(iter(lambda: server.recv(65536), b"")).decode()
        return int(re.match("HTTP/1.1 ([0-9]+)", said).group(1)), said


@pytest.fixture(scope="module")
def served(stopped):
    write("page.html", "<meta content=\"connect-src 'none'\">\n<!-- run -->\n")
    before = set(Path("stopped").rglob("*.html"))
    with Started("watch stopped --page", env={"VBOND_PAGE": str(Path("page.html").resolve())}) as watcher:
        until(lambda: "the page stays until Ctrl-C" in watcher.said(), "a page")
        yield Page(re.search("^page at (.*)$", watcher.said(), re.M).group(1))
        assert set(Path("stopped").rglob("*.html")) == before, "it has written a page"
        watcher.signal(signal.SIGINT).ended().expect(1)


def test_the_page_lives(served):
    found, said = served.answer(f"/{served.token}")
    assert found == 200 and "connect-src 'self'" in said and '"live":"' in said
    found, said = served.answer(f"/{served.token}state")
    assert found == 200 and '"goes_on":false,"lines":["interrupted"' in said


@pytest.mark.parametrize("status, method, host, paths", [
    (403, "GET", None, ["/", "/state", "/{bare}", "/0{token}", "/{upper}", "/x/{token}", "//{token}"]),
    (404, "GET", None, ["/{token}%00", "/{token}state%00x", "/{token}%73tate", "/{token}resolved.toml", "/{token}../resolved.toml",
                        "/{token}%2e%2e/resolved.toml", "/{token}state/", "/{token}/../"]),
    *((405, method, None, ["/{token}"]) for method in ("POST", "PUT", "DELETE")),
    *((200, "GET", host, ["/{token}"]) for host in ("localhost", "localhost:{port}", "127.0.0.1:8000", "[::1]", "[::1]:{port}")),
    *((403, "GET", host, ["/{token}"]) for host in ("evil.example", "evil.example:{port}", "127.0.0.1.evil.example",
                                                    "localhost:80.evil.example", "localhost:", "a@localhost", ""))])
def test_who_may_see_it(served, status, method, host, paths):
    host = "127.0.0.1" if host is None else host.format(port=served.port)
    for path in paths:
        path = path.format(token=served.token, bare=served.token.rstrip("/"), upper=served.token.upper())
        assert served.answer(path, method, host)[0] == status, f"{method} {path} of host {host}"


def test_requests_that_never_end_keep_nobody_out(served):
    waiting = []

    def trickle(text, connection):
        try:
            connection.sendall(text)
        except OSError:  # it has hung up
            pass

    for _ in range(40):
        try:
            waiting.append(served.connect())
            trickle(b"G", waiting[-1])
        except OSError:
            pass
    for _ in range(3):
        for connection in waiting:
            trickle(b"E", connection)
        assert served.answer(f"/{served.token}")[0] == 200
    for connection in waiting:
        connection.close()


def test_no_page(served, work):
    vbond("watch stopped --page --port", served.port, env={"VBOND_PAGE": f"{work}/page.html"}, status=3,
          err=[f"no server at 127.0.0.1:{served.port}", "give another --port"])
    vbond("watch stopped --page", env={"VBOND_PAGE": f"{work}/none.html"}, status=3)
    vbond("watch stopped --page --once", status=2)
    vbond("watch stopped --port 8000", status=2)


def test_a_run_that_has_failed():
    write("wild.toml", GOOD, ("^step = .*", 'step = "0.228 T0"\ninsist = true'), ("^velocity = .*", "velocity = [1e-9, 0, 0]"))
    vbond("run wild.toml -o wild", status=1)
    assert status("wild")["state"] == "failed"
    vbond("watch wild", status=1, out=["failed; ", "the run went unphysical at step"],
          err=["the run went unphysical at step", "smaller time.step"])


# ---- nobody's business: results are the same, and a file that cannot be written ends nothing ------------------------
def test_watching_changes_nothing():
    with Started("run good.toml -o watched_run") as run:
        run.until(lambda: Path("watched_run/status.json").exists())
        while run.runs():
            Path("watched_run/status.json").read_bytes()
        run.ended().expect()
    assert same_bytes("alone/history.csv", "watched_run/history.csv"), "watching changes results"


def test_a_status_that_cannot_be_written():
    numb = ["stage[0].duration=1e5 T0", "output.history.every=1000 T0", "output.frames.every=1e5 T0"]
    with Started("run good.toml -o numb", sets=numb) as run:
        run.until(lambda: Path("numb/status.json").exists())
        for _ in range(100):  # it may be written anew between the two
            Path("numb/status.json").unlink(missing_ok=True)
            try:
                os.makedirs("numb/status.json/full")
                break
            except OSError:
                pass
        told = run.ended().expect(err="nobody can watch it")
    assert told.err.count("nobody can watch it") == 1, f"told not once: {told}"


# ---- files that nobody should believe -------------------------------------------------------------------------------
@pytest.fixture
def bad():
    """Writes bad/status.json, the good one with changes or all of it, and watches it."""
    shutil.rmtree("bad", ignore_errors=True)
    os.mkdir("bad")
    good = Path("alone/status.json").read_text()

    def watch(*changes, text=None, once="", **expected):
        if text is not None or changes:
            Path("bad/status.json").write_text(edited(good, *changes) if text is None else text)
        return vbond(f"watch bad {once}", no_err="internal error", **expected)

    return watch


NO_STATUS = {"status": 2, "err": "is not a status of a run"}
RUNNING = ('complete"', 'running"')
OF_NOBODY = ('"process": .*', '"process": 2147483647,')


def test_folders_that_are_none():
    vbond("watch nowhere", status=2, err=["nowhere: there is no such folder", "give the output folder of a run"])
    vbond("watch good.toml", status=2, err="good.toml: is not a folder")
    vbond("watch", status=2)


def test_files_that_are_cut_short_or_no_file(bad):
    bad(status=2, err="bad/status.json: there is none")
    good = Path("alone/status.json").read_text()
    for length in (0, *range(1, len(good) - 2, 7)):
        bad(text=good[:length], status=2, err="bad/status.json: is not a status of a run")
    bad(text="[" * 2000000, status=2, err="far too large")
    bad(text="[" * 900000, **NO_STATUS)
    Path("bad/status.json").unlink()
    os.mkfifo("bad/status.json")
    bad(status=2, err="it is no file")


def test_values_of_every_kind(bad):
    good = Path("alone/status.json").read_text()
    keys = [key for key in re.findall('^ *"([a-z_]*)": ', good, re.M) if not re.match("kinetic|U_|contact|diss|work_|total", key)]
    assert len(keys) > 10
    for key in keys:
        for value in ("[]", '{"a": 1}', "true", "-1.5e3", "1e999", "NaN", "Infinity", r'"\ud800"', "1e308x"):
            text = re.sub(rf'^( *"{key}": )[^{{\n]*[^{{,\n](,?)$', lambda found: found[1] + value + found[2], good, flags=re.M)
            # negative times and seconds are numbers, if odd ones; whatever it is, it is told or refused
            if text != good:
                bad(text=text, once="--once", status=(0, 1, 2) if value == "-1.5e3" else 2)


@pytest.mark.parametrize("changes, expected", [
    ([('"step": .*', '"step": 99999999999999999999999,')], {"status": 2, "err": "is not a count"}),
    ([('"time": .*', '"time": null,')], {"out": "t = nan"}),
    *(([('"seconds_left": .*', f'"seconds_left": {value},'), ('"end_time": [^,\n]*', f'"end_time": {value}'),
        ('"wall_seconds": .*', f'"wall_seconds": {value},')], {}) for value in ("1e308", "-1e308")),
    ([('"schema": 1', '"schema": 2')],
     {"status": 2, "err": ["is of schema 2, and this program reads schema 1", "use the vbond that runs there"]}),
    ([('"state": "complete"', '"state": "bored"')], {"status": 2, "err": '"bored" is unknown'}),
    ([('"last_event": .*', r'"last_event": "a\\u001b[2Jb\\nc",')], {"out": r"a\x1b[2Jb c"}),
    *(([('"process": .*', f'"process": {process},'), RUNNING], NO_STATUS) for process in (0, -1, 4294967297)),
    # of another machine nothing is known
    ([('"host": .*', '"host": "elsewhere",'), RUNNING, OF_NOBODY], {"once": "--once"})])
def test_values(bad, changes, expected):
    bad(*changes, **expected)


def test_a_process_id_that_another_process_has_got_since(bad):  # the lock of the folder tells that the run is gone
    mine = [RUNNING, ('"process": .*', f'"process": {os.getpid()},')]
    bad(*mine, once="--once", status=1, out=f"gone: process {os.getpid()} has ended without a word")
    Path("bad/run.lock").touch()
    bad(once="--once", status=1)
    with open("bad/run.lock") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        bad(once="--once", out="running; ")
        bad(RUNNING, OF_NOBODY, once="--once")  # in another space of process ids


# ---- static stages, sweeps ------------------------------------------------------------------------------------------
@pytest.mark.skipif(not STATICS, reason="built without statics")
def test_static_stages():
    vbond("run", HERE / "statics.toml", "-o", "still", sets="stage[let_go].duration=1 T0")
    assert status("still")["state"] == "complete"
    vbond("run", write("twist.toml", f"""specimen = [{{kind = "rod", particles = 2, radius = 0.3, mass = 1.0}}]
bonds = [{{distance = 1.1, coefficients = {{B1 = 1.0, B2 = 0.1, B3 = 0.1, B4 = 0.1}}}}]
[[stage]]
name = "twist"
kind = "equilibrium"
supports = [{{group = "first", {CLAMP}}}]
loads = [{{group = "last", moment = [0.1, 0, 0]}}]
steps = 16
"""), "-o", "twist", status=1)
    assert status("twist")["state"] == "failed"
    points = lines("twist/history.csv") - 1
    vbond("watch twist", status=1, out=[f"failed; stage twist (1 of 1, equilibrium), {points} points", "no balance found beyond load factor 0."])


def test_points_of_sweeps():
    vbond("sweep good.toml -o both", sets="stage[0].duration=1 T0,2 T0")
    for point in ("0001", "0002"):
        vbond(f"watch both/{point}")
