"""Flat joints: what their keys refuse, the figures of the example, and the same files for any instruction set and number
of threads, and stopped and resumed while cells crack and rub."""
import math
import signal
from shutil import rmtree

import pytest
from program import (EXAMPLES, HERE, STATICS, column, expect_same, instruction_sets, lines, number, refused, stop_at,
                     table, vbond, write)

CASE = HERE / "flat_joints.toml"
SHEAR = EXAMPLES / "joint_shear.toml"

needs_statics = pytest.mark.skipif(not STATICS, reason="a build without statics: the example has stages at rest")


@pytest.fixture(scope="module")
def whole(work):
    vbond("run", CASE, *"-o whole --threads 1".split(), env={"VBOND_SIMD": "baseline"})
    assert column("whole", "broken")[-1] >= 500
    assert column("whole", "dissipated.friction")[-1] > 0
    assert abs(column("whole", "balance_error")[-1]) < 1e-2
    return "whole"


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("simd", instruction_sets())
def test_same_with(whole, simd, threads):
    vbond("run", CASE, "-o", "other", "--threads", threads, env={"VBOND_SIMD": simd})
    assert number("other", "threads_used") == threads
    expect_same(whole, "other")
    rmtree("other")


def test_stopped_while_cells_crack(whole):
    breaks = lines("whole/breaks.csv")
    stop_at(breaks // 2, "stopped", "run", CASE, *"-o stopped --threads 3".split(), by=signal.SIGKILL, table="breaks.csv",
            env={"VBOND_SIMD": instruction_sets()[-1]})
    assert lines("stopped/breaks.csv") < breaks, "nothing was left to crack"
    vbond("resume stopped --threads 2", env={"VBOND_SIMD": "baseline"})
    expect_same(whole, "stopped")


def test_joints_that_are_made_in_a_later_stage(work):
    """A pair that touches gives its repulsion up once, not with each cell; frames are the same after a stop."""
    case = write("later.toml", CASE.read_text(), ("cells = .*", "cells = [2, 2, 2]"),
                 ("^distance = 1.1", 'distance = 1.1\nwhen = "stage"\nstages = ["joined"]'),
                 (r"^\[\[stage\]\]", '[[stage]]\nduration = "0.06 T0"\n[[stage]]\nname = "joined"'),
                 (r"^\[output\]", "[time]\nstep = 1e-3\n[output]"))
    vbond("run", case, *"-o later".split())
    rows = table("later")
    before = max(k for k, row in enumerate(rows) if row["bonds"] == 0)
    given_up = column("later", "dissipated.bonding")[-1]
    assert given_up == pytest.approx(rows[before]["contact"], rel=1e-6) and given_up > 1e-6
    assert max(abs(row["balance_error"]) for row in rows) < 1e-4
    stop_at(25, "later_stopped", "run", case, *"-o later_stopped".split())
    vbond("resume later_stopped")
    expect_same("later", "later_stopped")


@needs_statics
def test_the_example_has_the_figures_of_coulomb(work):
    """Peak (c + sigma tan phi) A, then mu P; laws differ by the strain, 1e-3."""
    vbond("run", SHEAR, *"-o shear".split())
    area, pressure = math.pi * 0.8e-3 ** 2, 100.0
    peak = 60e6 * area + pressure * math.tan(math.radians(30))
    force = [abs(x) for x in column("shear", "reaction.last.fy")]
    assert max(force) == pytest.approx(peak, rel=5e-3)
    assert force[-1] == pytest.approx(0.4 * pressure, rel=1e-7)
    assert lines("shear/breaks.csv") == 1 + 12
    assert number("shear", "broken") == 12


@needs_statics
@pytest.mark.parametrize("change, err", [
    ("bonds[0].flat_joint.around=2", "use 1, or 3 and more"),
    ("bonds[0].flat_joint.friction=-1", "must satisfy 0 <= friction"),
    ("bonds[0].strength.moment_share=0.5", "without moment_share"),
    ("bonds[0].damping={time='1 us'}", "bonds whose cells rub when they are broken do not damp"),
    ("bonds[0].flat_joint.friction=0", "grains slide freely along cracked faces without friction"),
    ("bonds[0].prestrain=0.001", "do not expand, are made at rest"),
    ("bonds[0].section={shape='square',side='1 mm'}", "a flat joint is a circle of springs per area"),
    ("bonds[0].stiffness_factors={c_A=2}", "c_B follows from c_A"),
    ("bonds[0].yield={axial_force='1 N'}", "are elastic until they break"),
])
def test_refused(work, change, err):
    refused(SHEAR, err, sets=change)


@needs_statics
@pytest.mark.parametrize("damping", ["{ratio=0.05}", "{coefficients={g_A='1 N*s/m',g_D='1 N*s/m',g_B='1 N*m*s',g_T='1 N*m*s'}}"])
def test_damping_by_ratio_is_refused(work, damping):
    write("damped.toml", SHEAR.read_text(), (", friction = 0.4", ""))
    refused("damped.toml", "would damp the joint by their number", sets="bonds[0].damping=" + damping)
    vbond("check damped.toml", sets="bonds[0].damping={time='1 us'}")


PAIR = """
[[specimen]]
kind = "list"
positions = [[0, 0, 0], [2, 0, 0]]
radius = 1.0
mass = 1.0
inertia = 0.4
[groups.A]
indices = [0]
[groups.B]
indices = [1]
[[bonds]]
distance = 2.2
theory = "parallel"
k_n = 1.0
k_s = 0.4
section = {shape = "circle", diameter = 1.6}
JOINT
strength = {criterion = "mohr-coulomb", tension_limit = 0.005, cohesion = 0.01, friction_angle = 0.4}
[[stage]]
name = "crack"
duration = 20.0
supports = [{group = "A", fix = ["x", "y", "z", "rx", "ry", "rz"]},
  {group = "B", fix = ["x", "y", "z", "rx", "ry", "rz"], velocity = [-0.001, 0.005, 0]}]
[[stage]]
name = "go"
duration = 10.0
[[sink]]
group = "B"
stages = ["go"]
every = 2.0
box = {min = [-5, -5, -5], max = [5, 5, 5]}
[output]
history = {every = 1}
"""


def test_t0_and_neighbours_are_those_of_the_whole_bond(work):
    for joint in ("", "flat_joint = {radial = 2, around = 6}", "flat_joint = {radial = 3, around = 1, friction = 0.4}"):
        write("pair.toml", PAIR, ("JOINT", joint))
        # 2 pi sqrt(m / (k_n pi 0.8^2)) = 4.43113
        vbond("check pair.toml", out=["on average 1 neighbour per particle", "T0               4.43113"])


def test_cracked_cells_that_a_sink_takes_out_do_not_break_again(work):
    write("sunk.toml", PAIR, ("JOINT", "flat_joint = {radial = 1, around = 4, friction = 0.4}"))
    vbond("run sunk.toml -o sunk")
    assert lines("sunk/breaks.csv") == 1 + 4
    assert column("sunk", "broken")[-1] == 4 == number("sunk", "broken")


@needs_statics
def test_place_of_a_mistake(work):
    write("two.toml", SHEAR.read_text(), ("around = 6, friction = 0.4", "around = 2, friction = -1"))
    refused("two.toml", "two.toml:21:27: bonds[0].flat_joint.around = 2", "two.toml:21:39: bonds[0].flat_joint.friction = -1")
