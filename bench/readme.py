"""The table of docs/speed.md, made of what 'bench/run readme' has measured on one machine in one go."""
import figures
import machine

BEGIN = "<!-- speed: written by bench/run readme -->"
END = "<!-- speed: end -->"
BODIES = {"block_22": "simple cubic block", "block_100": "the same, larger", "sheet": "triangular sheet",
          "shell": "half-sphere with contacts", "chain_10000": "straight chain", "chain_10": "chain, ns per step"}


def figure_of(run, threads):
    """Of the steps alone; per bond but for the chain of ten, where bonds are too few to divide by."""
    if run["threads_used"] != threads:
        return f"uses {run['threads_used']} only"
    return figures.cell(run["ns_per_step" if run["case"] == "chain_10" else "ns_per_bond_step"])


def rows(runs, threads):
    """One per case, and below block_22 what LAMMPS took in turns with it, with the ratio of the same rounds."""
    here = {(r["peer"], r["case"], r["threads"]): r for r in runs}
    for case, body in BODIES.items():
        mine = [here["vbond", case, t] for t in threads]
        yield [body, f"{mine[0]['particles']:,}", f"{mine[0]['bonds']:,}", *map(figure_of, mine, threads)]
        peers = [here.get(("LAMMPS", case, t)) for t in threads]
        if any(peers):
            yield ["the same in LAMMPS `bpm/rotational`", "", "",
                   *(f"{figures.cell(p['ns_per_bond_step'])}, {figures.ratio(p, m)['median']:.1f} times as long"
                     if p else "not measured" for p, m in zip(peers, mine))]


def text(result, command):
    """The table, and all that must be known with it; one instruction set."""
    at, runs = result["machine"], result["runs"]
    about, threads = at["processor"], sorted({r["threads"] for r in runs})
    header = ["body", "particles", "bonds", *("1 thread" if t == 1 else f"{t} threads" for t in threads)]
    lammps = sorted({f"; LAMMPS {r['version']}" for r in runs if r["peer"] == "LAMMPS"})
    lines = [f"Time of a step in ns per bond: medians, least and largest of {result['rounds']} rounds, all in turns.",
             f"Processor: {machine.processor_name(about)}, {at['processors']} processors,",
             f"caches {machine.cache_sizes(about) or 'unknown'}; instruction set {runs[0]['set']}{''.join(lammps)}.",
             f"Measured on {at['date'][:10]} at commit {result['commit']} by `{command}`."]
    return "\n".join(lines) + "\n\n" + figures.markdown_table(header, rows(runs, threads))


def replaced(page, table):
    """The page with this between its two markers; ValueError if it has not each of them once, in order."""
    if page.count(BEGIN) != 1 or page.count(END) != 1 or page.index(BEGIN) > page.index(END):
        raise ValueError(f"needs the line '{BEGIN}' and below it the line '{END}', each once")
    return page[:page.index(BEGIN)] + f"{BEGIN}\n\n{table}\n{END}" + page[page.index(END) + len(END):]


def with_table(page, result, command):
    """The page with the table of this result; ValueError if anything speaks against the figures, or as `replaced`."""
    doubts = figures.doubts(result)
    if doubts:
        raise ValueError(" ".join(["a published table must stand without doubts.", *doubts]))
    return replaced(page, text(result, command))
