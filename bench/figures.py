"""Order of the runs, what several runs of one combination say, and tables of it. Measures nothing itself."""
import statistics

WIDE = 0.1  # (largest - least) / median above which a figure is marked
BUSY = 0.05  # processors' worth of other work above which the machine is called busy
BUSY_AT_START = 0.3  # the same of the load average


# ---- figures

def spread(values):
    return {"median": statistics.median(values), "min": min(values), "max": max(values), "all": values}


def is_wide(s):
    return s["max"] - s["min"] > WIDE * s["median"]


def figures(key, runs):
    """What several runs of one combination say; key: what was asked for, runs: as programs.py makes them."""
    last = runs[-1]
    steps, pieces = last["steps"], last["bonds"] or last["particles"]
    told = ("threads_used", "instruction_set_used", "version", "particles", "bonds", "steps")
    return {**key, **{k: last[k] for k in told},
            "ns_per_bond_step": spread([1e9 * r["seconds_steps"] / steps / pieces for r in runs]),
            "ns_per_step": spread([1e9 * r["seconds_steps"] / steps for r in runs]),
            "ns_per_bond_step_with_output": spread([1e9 * r["seconds_with_output"] / steps / pieces for r in runs]),
            "seconds_whole_process": spread([r["seconds_whole_process"] for r in runs]),
            "wall_time": {phase: statistics.median(r["wall_time"][phase] for r in runs)
                          for phase in last["wall_time"]},
            "doubts": sorted({doubt for r in runs for doubt in r["doubts"]})}


def ratio(over, under, what="ns_per_bond_step"):
    """Of two combinations that took turns, round by round: what slows a round down slows both."""
    return spread([a / b for a, b in zip(over[what]["all"], under[what]["all"])])


def turns(sizes, n):
    """Order of round n over groups of these sizes, as pairs of group and member: each round begins with another group
    and each group with another of its members, so that none is always the first; members of a group run in a row."""
    return [((k + n) % len(sizes), (p + n) % sizes[(k + n) % len(sizes)])
            for k in range(len(sizes)) for p in range(sizes[(k + n) % len(sizes)])]


def doubts(result):
    """What speaks against the figures: other work, wide spreads, instruction sets nobody can tell."""
    load, work = result["machine"]["load_average"][0], result["other_work"]
    found = []
    if load > BUSY_AT_START or work["other_processors"] > BUSY or work["stolen_processors"] > BUSY:
        found.append(f"THE MACHINE WAS BUSY: load average {load:.2f} at the start; while measuring, other work took "
                     f"{work['other_processors']:.2f} processors and the host {work['stolen_processors']:.2f}.")
    wide = sum(is_wide(r["ns_per_step"]) for r in result["runs"])
    if wide:
        found.append(f"{wide} of {len(result['runs'])} combinations spread over more than {100 * WIDE:.0f} % (marked "
                     "!): measure again on a quiet machine.")
    if any(r["set"] and not r["instruction_set_used"] and r.get("peer") != "LAMMPS" for r in result["runs"]):
        found.append("The program does not say which instruction set it used: VBOND_SIMD may have had no effect.")
    return found + sorted({doubt for r in result["runs"] for doubt in r["doubts"]})


# ---- tables

def number(value):
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def cell(s):
    return f"{number(s['median'])} [{number(s['min'])}, {number(s['max'])}]{' !' if is_wide(s) else ''}"


def ratio_cell(s):
    return f"{s['median']:.3f} [{s['min']:.3f}, {s['max']:.3f}]"


def table(header, rows):
    rows = [[str(c) for c in row] for row in (header, *rows)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(header))]
    return "".join("  ".join(c.ljust(w) for c, w in zip(row, widths)).rstrip() + "\n" for row in rows)


def markdown_table(header, rows):
    return "".join(f"| {' | '.join(map(str, row))} |\n" for row in (header, ["---"] * len(header), *rows))


def comparison(runs, names, columns, what, unit):
    """Figures of several programs side by side, the last of them over each other one; the programs of a combination
    are neighbours in runs, in the order of names."""
    others = names[:-1]
    header = (columns + [f"{name}, {unit}" for name in names] +
              [title for name in others for title in (f"{names[-1]} / {name}", "of the least")])
    rows = []
    for at in range(0, len(runs), len(names)):
        *olds, new = group = runs[at:at + len(names)]
        least = [new[what]["min"] / old[what]["min"] for old in olds]
        rows.append([group[0][c] or "as it likes" for c in columns] + [cell(r[what]) for r in group] +
                    [c for old, l in zip(olds, least) for c in (ratio_cell(ratio(new, old, what)), f"{l:.3f}")])
    return table(header, rows)
