#!/usr/bin/env python3
"""What vbond-lammps would take on many ranks: a model, of measured bytes, messages and times. docs/scaling.md.

Usage: bench/scaling.py [--bond NS] [--latency US] [--bandwidth GB_PER_S] [--ranks-per-node N] [--memory GB]
"""
import argparse
import math

FACE_BYTES = 7 * 8 + 6 * 8  # a particle at a face: its pose there, its ghost's load back
MESSAGES = 12  # of a rank in a step: poses and loads, to six neighbours
STEPS_BETWEEN_SUMS = 64
COPY = 5e9  # bytes per second that a rank puts into a message and takes out of it
BYTES_PER_PARTICLE, BYTES_PER_BOND = 408, 284  # of the whole body on each rank: `vbond check`


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bond", type=float, default=20.0, help="ns per bond and step on one rank")
    parser.add_argument("--latency", type=float, default=2.0, help="of a message, microseconds")
    parser.add_argument("--bandwidth", type=float, default=12.5, help="of a node's network, GB/s")
    parser.add_argument("--ranks-per-node", type=int, default=64, help="a cube of them")
    parser.add_argument("--memory", type=float, default=256.0, help="of a node, GB")
    return parser.parse_args()


def step(bonds, ranks, a, breakable=False):
    """Seconds of work and of messages in a step of a cube of a simple cubic lattice."""
    edge = (bonds / 3 / ranks) ** (1 / 3)  # particles along the edge of a rank's cube
    work = bonds / ranks * a.bond * 1e-9
    if ranks == 1:
        return work, 0.0
    per_edge = round(a.ranks_per_node ** (1 / 3))
    leaving = 1 / per_edge if ranks > a.ranks_per_node else 0.0  # part of the faces that lead to other nodes
    sums = math.ceil(math.log2(ranks)) * a.latency * 1e-6 * (1 if breakable else 1 / STEPS_BETWEEN_SUMS)
    sent = 6 * edge**2 * FACE_BYTES * a.ranks_per_node * leaving / (a.bandwidth * 1e9)
    copied = 6 * edge**2 * FACE_BYTES / COPY
    return work, MESSAGES * a.latency * 1e-6 + copied + sent + sums


def main():
    a = arguments()
    print("| bonds | ranks | bonds per rank | ms of work | ms of messages | efficiency | the same, breakable |")
    print("|---|---|---|---|---|---|---|")
    rows = [(1e6 * ranks, ranks) for ranks in (64, 1000, 10**4)]
    rows += [(1e9, ranks) for ranks in (64, 1000, 10**4, 10**5)]
    for bonds, ranks in rows:
        work, messages = step(bonds, ranks, a)
        breaking = sum(step(bonds, ranks, a, True))
        print(f"| {bonds:.0e} | {ranks} | {bonds / ranks:.3g} | {1e3 * work:.3g} | {1e3 * messages:.3g} "
              f"| {work / (work + messages):.0%} | {work / breaking:.0%} |")
    per_bond = BYTES_PER_BOND + BYTES_PER_PARTICLE / 3
    most = a.memory * 1e9 / a.ranks_per_node / per_bond
    print(f"\nEach rank holds the whole body: with {a.memory:g} GB for {a.ranks_per_node} ranks at most {most:.2g} bonds.")


if __name__ == "__main__":
    main()
