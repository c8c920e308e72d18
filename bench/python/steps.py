"""What a step costs when Python asks for it, one by one, by a block of steps, and with a callback at each: a rod of
10 particles. PYTHONPATH=build/release/python python3 bench/python/steps.py"""

import statistics
import time
from pathlib import Path

import vbond

steps, repeats = 100_000, 7
root = Path(__file__).parents[2]


def fresh() -> vbond.Run:
    run = vbond.Run(vbond.Case.from_file(root / "examples/rod_dynamic.toml", {"stage[0].duration": "1e6 T0"}))
    run.step(1000)
    return run


def seconds(work) -> float:
    run = fresh()
    start = time.perf_counter()
    work(run)
    return time.perf_counter() - start


def one_by_one(run: vbond.Run) -> None:
    for _ in range(steps):
        run.step()


def with_callback(run: vbond.Run) -> None:
    run.on_step(1, lambda _: None)
    run.step(steps)


ways = {"a block": lambda run: run.step(steps), "one by one": one_by_one, "a callback each step": with_callback}
times = {name: [] for name in ways}
for _ in range(repeats):
    for name, work in ways.items():
        times[name].append(1e6 * seconds(work) / steps)
for name, all_times in times.items():
    print(f"{name:22} {statistics.median(all_times):.3f} us a step [{min(all_times):.3f}, {max(all_times):.3f}]")
