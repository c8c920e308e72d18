"""campaign.py CASES [SEED]: random cases by the Python module, beside the program.

Of every four cases three are motion (tests/random_body.py), given as a dict and made in random ways: at once, by
stages, by blocks of steps, on 1 to 3 threads, with callbacks that look; and one is a rod in equilibrium, buckling or
vibration, by the functions of statics. Counts:
  same     all columns of the history are equal bit for bit, the same bonds are broken, the same loads and frequencies
  alike    both refuse the case, or end it, with the same words
  wrong    anything else; its case is printed
The status is 1 if one was wrong. A crash of the interpreter ends it at once."""

import os
import random
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy as np

import vbond

root = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(root / "tests"))
from random_body import random_case  # noqa: E402


def random_rod(rng: random.Random) -> str:
    n, nu = rng.randint(3, 12), rng.uniform(0, 0.45)
    text = (f'[[specimen]]\nkind = "rod"\nparticles = {n}\nspacing = {rng.uniform(0.8, 1.2):.4f}\nradius = 0.3\n'
            f"mass = {rng.uniform(0.5, 2):.3f}\n[[bonds]]\ndistance = 1.3\ntheory = \"bernoulli-euler\"\n"
            f'E = {rng.uniform(1, 100):.4g}\nnu = {nu:.3f}\nsection = {{shape = "circle", diameter = {rng.uniform(0.1, 0.4):.3f}}}\n')
    kind = rng.choice(["equilibrium", "buckling", "modes"])
    force = [round(rng.uniform(-1e-3, 1e-3), 7) for _ in range(3)] if kind != "buckling" else [-1.0, 0.0, 0.0]
    text += f'[[stage]]\nname = "{kind}"\nkind = "{kind}"\nsupports = [{{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}}]\n'
    text += f'loads = [{{group = "last", force = {force}}}]\n'
    return text + ("count = 2\n" if kind != "equilibrium" else "")


def problems(text: str) -> list[str]:
    """The mistakes that the program tells, without their places."""
    return re.findall(r"^case[.]toml(?::\d+:\d+)?: (.*)$", text, re.M)


def go_through(run: vbond.Run, rng: random.Random) -> None:
    if rng.random() < 0.3:
        run.on_step(rng.randint(1, 50), lambda now: now.state.bonds["broken"].any() and None)
    way = rng.choice(["run", "stages", "blocks"])
    while not run.complete:
        if way == "run":
            run.run()
        elif way == "stages":
            run.run_stage()
        else:
            run.step(rng.choice([1, 7, 100]))


def judged_motion(text: str, folder: Path, rng: random.Random) -> tuple[str, str]:
    done = subprocess.run([vbond.find_program(), "run", "case.toml", "-o", "out", "--threads", "1"], cwd=folder,
                          capture_output=True, text=True, timeout=60)
    try:
        run = vbond.Run(vbond.Case.from_dict(tomllib.loads(text)), threads=rng.randint(1, 3))
        go_through(run, rng)
    except vbond.CaseError as e:
        return ("alike" if [p["what"] for p in e.problems] == problems(done.stderr) else "wrong"), f"{e}\n{done.stderr}"
    except (vbond.Diverged, vbond.NoEquilibrium) as e:
        return ("alike" if done.returncode == 1 and str(e).split("\n")[0] in done.stderr else "wrong"), f"{e}\n{done.stderr}"
    if done.returncode != 0:
        return "wrong", f"the program ended with {done.returncode}: {done.stderr}"
    written = vbond.open(folder / "out")
    history = written.history
    if list(history) != list(run.history):
        return "wrong", "other columns"
    for name, column in run.history.items():
        if not np.array_equal(column, history[name], equal_nan=True):
            return "wrong", f"column {name}"
    if run.state.bonds["broken"].sum() != written.summary.get("broken", 0):
        return "wrong", "other bonds are broken"
    return "same", ""


def judged_rod(text: str, folder: Path) -> tuple[str, str]:
    written = vbond.run(vbond.Case.from_text(text), folder / "out")
    case = vbond.Case.from_dict(tomllib.loads(text))
    stage = dict(case.keys["stage"][0])
    kind = stage.pop("kind")
    del stage["name"]
    solution = getattr(vbond, kind)(case, **stage)
    for name, column in solution.history.items():
        if not np.array_equal(column, written.history[name], equal_nan=True):
            return "wrong", f"column {name}"
    if [load.force for load in solution.critical_loads] != written.summary.get("critical_forces", []):
        return "wrong", "critical forces"
    if not np.allclose(solution.frequencies, written.summary.get("frequencies", []), rtol=1e-14):
        return "wrong", "frequencies"
    return "same", ""


def campaign(cases: int, seed: int) -> dict[str, int]:
    counts = dict.fromkeys(["same", "alike", "wrong"], 0)
    for k in range(cases):
        rng = random.Random(seed * 100003 + k)
        text = random_rod(rng) if k % 4 == 3 else random_case(rng)
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            (folder / "case.toml").write_text(text)
            verdict, why = judged_rod(text, folder) if k % 4 == 3 else judged_motion(text, folder, rng)
        counts[verdict] += 1
        if verdict == "wrong":
            print(f"case {k} of seed {seed}: {why}\n{text}")
    return counts


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    result = campaign(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    print(", ".join(f"{number} {verdict}" for verdict, number in result.items()))
    sys.exit(1 if result["wrong"] else 0)
