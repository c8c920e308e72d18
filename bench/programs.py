"""Runs of the programs that are measured: vbond, and LAMMPS beside it.

A run is what figures.py reads: version, particles, bonds, steps, seconds of the steps alone, the same with all that is
looked at and written, seconds of the whole process, threads and instruction set that were used, wall time by phase,
doubts.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

NOT_STEPS = ("build", "watch", "history", "frames", "checkpoint", "terminal")  # phases of wall_time in run.json
QUIET_CPU_USE = 98  # % of LAMMPS' own CPU time below which its figure is worthless


def call(command, environment, work):
    """What the command printed, and the seconds it took; ends everything if it fails."""
    start = time.perf_counter()
    done = subprocess.run(command, env=environment, cwd=work, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"bench/run: {' '.join(map(str, command))} failed\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout, time.perf_counter() - start


def run_vbond(case_file, key, work):
    """Runs a case as key says (program, threads, set) in a folder that is removed afterwards."""
    environment = dict(os.environ)
    if key["set"]:
        environment["VBOND_SIMD"] = key["set"]
    with tempfile.TemporaryDirectory(dir=work) as folder:
        command = [key["program"], "run", case_file, "-o", pathlib.Path(folder) / "out"]
        _, seconds = call(command + (["--threads", str(key["threads"])] if key["threads"] else []), environment, work)
        summary = json.loads((pathlib.Path(folder) / "out" / "run.json").read_text())
    used = summary.get("instruction_set", key["set"])
    if key["set"] and used != key["set"]:
        sys.exit(f"bench/run: asked for {key['set']}, and {key['program']} used {used}")
    wall_time = summary["wall_time"]
    return {"version": summary["version"], "particles": summary["particles"], "bonds": summary["bonds"],
            "steps": sum(stage["steps"] for stage in summary["stages"]),
            "seconds_steps": sum(s for phase, s in wall_time.items() if phase not in NOT_STEPS),
            "seconds_with_output": sum(s for phase, s in wall_time.items() if phase != "build"),
            "seconds_whole_process": seconds, "wall_time": wall_time, "doubts": [],
            "threads_used": summary.get("threads_used"), "instruction_set_used": summary.get("instruction_set")}


def read_lammps(text):
    """What LAMMPS printed about one run with bonds from create_bonds; ValueError where a line is missing."""
    def found(pattern, what):
        if match := re.search(pattern, text, re.MULTILINE):
            return match.groups()
        raise ValueError(f"LAMMPS printed no {what}")

    version, = found(r"^LAMMPS \((.*)\)", "version")
    seconds, processes, steps, particles = found(
        r"^Loop time of (\S+) on (\d+) procs for (\d+) steps with (\d+) atoms", "loop time")
    bonds, = found(r"^Added \d+ bonds, new total = (\d+)", "number of bonds")
    cpu_use, = found(r"^([\d.]+)% CPU use", "CPU use")
    start, end = found(r"^ *Step .*\n *\d+ +(\S+).*\n *\d+ +(\S+)", "temperatures")
    doubts = []
    if float(cpu_use) < QUIET_CPU_USE:
        doubts.append(f"LAMMPS had its processors for less than {QUIET_CPU_USE} % of a run: its figure is too high.")
    if not 0.4 < float(end) / float(start) < 0.6:  # half of the motion's energy goes to bonds and rotation
        doubts.append("LAMMPS' temperature did not fall to about a half: is it the same body?")
    return {"version": version, "threads_used": int(processes), "particles": int(particles), "bonds": int(bonds),
            "steps": int(steps), "seconds_steps": float(seconds), "seconds_with_output": float(seconds),
            "wall_time": {}, "instruction_set_used": None, "doubts": doubts}


def run_lammps(script, key, mpirun, work):
    """Runs LAMMPS as key says (program, threads) on one core, or on several by mpirun."""
    command = [key["program"], "-in", script, "-log", "none"]
    if key["threads"] > 1:
        command = [*mpirun.split(), "-np", str(key["threads"]), *command]
    printed, seconds = call(command, {**os.environ, "OMP_NUM_THREADS": "1"}, work)
    try:
        run = read_lammps(printed)
    except ValueError as problem:
        sys.exit(f"bench/run: {' '.join(map(str, command))}: {problem}\n{printed[-2000:]}")
    if run["threads_used"] != key["threads"]:
        sys.exit(f"bench/run: {key['program']} was asked for {key['threads']} processes and used "
                 f"{run['threads_used']}: is it built with MPI? If not, add --mpirun ''")
    return {**run, "seconds_whole_process": seconds}
