"""Pressure, as a user writes it: what is told of mistakes, of surfaces, and what comes out."""
import math
import re
from pathlib import Path

import pytest
from program import (STATICS, column, expect_same, lines, number, refused, run_example, stop_at, table, values, vbond,
                     write)

at_rest = pytest.mark.skipif(not STATICS, reason="built without statics")

RING = """units = {system = "reduced"}
specimen = [{kind = "ring", particles = 24, ring_radius = 4, radius = 0.4, mass = 1, inertia = 0.064}]
bonds = [{distance = 1.2, stiffness = {c_A = 1, c_D = 0.03, c_B = 0.003, c_T = 0.003}}]
groups = {side = {indices = [0, 12]}, top = {indices = [6]}}
output = {history = {displacements = [0]}}
[[stage]]
kind = "equilibrium"
pressures = [{surface = "strips", pressure = 1e-5, width = 1}]
supports = [{group = "all", fix = ["z", "rx", "ry"]}, {group = "side", fix = ["y"]}, {group = "top", fix = ["x"]}]
"""
SHEET = """units = {system = "reduced"}
specimen = [{kind = "sheet", particles = [5, 5], radius = 0.4, mass = 1, inertia = 0.064}]
bonds = [{distance = 1.1, stiffness = {c_A = 1, c_D = 0.3, c_B = 0.1, c_T = 0.1}}]
groups = {edge = {plane = {point = [0, 0, 0], normal = [1, 0, 0], within = 0.6}}}
output = {history = {every = "1 T0"}, checkpoint = {every = "10 T0"}}
[[stage]]
duration = "40 T0"
pressures = [{surface = "triangles", pressure = 1e-3, inside = [2, 2, -5], ramp = "10 T0"}]
supports = [{group = "edge", fix = ["x", "y", "z"]}]
"""
BLOCK = """units = {system = "reduced"}
specimen = [{kind = "block", cells = [4, 4, 4], spacing = 1, radius = 0.4, mass = 1, inertia = 0.064}]
bonds = [{distance = 1.5, stiffness = {c_A = 1, c_D = 0.3, c_B = 0.1, c_T = 0.1}}]
groups = {a = {indices = [0]}, b = {indices = [3]}, c = {indices = [12]}}
output = {history = {stress = [{group = "all", volume = 27}], reactions = ["a", "b", "c"]}}
[[stage]]
kind = "equilibrium"
pressures = [{surface = "skin", pressure = 1e-3}]
supports = [{group = "a", fix = ["x", "y", "z"]}, {group = "b", fix = ["y", "z"]}, {group = "c", fix = ["z"]}]
"""


def test_mistakes_are_told_with_a_way_out():
    dynamic = SHEET.replace(', inside = [2, 2, -5]', "")
    refused(write("sheet.toml", dynamic), 'sheet.toml:8:', 'pressure on group "all"', "has free edges", "give inside = [x, y, z]")
    refused(write("flat.toml", SHEET, (r"\[2, 2, -5\]", "[2, 2, 0]")), "flat.toml:8:", "has no side that faces the point inside")
    refused(write("kind.toml", SHEET, ('"triangles"', '"strips", width = 1')), "particle 1 has 4 bonds in the group",
            'or use surface = "triangles"')
    refused(write("width.toml", SHEET, ('"triangles"', '"strips"')), "width", "required")
    refused(write("nothing.toml", SHEET, ("1e-3", "0.0")), "nothing would press")
    refused(write("square.toml", SHEET, ('particles = ', 'lattice = "square", particles = ')), "no three of its bonds form a triangle")
    refused(write("group.toml", SHEET, ('pressure = 1e-3', 'pressure = 1e-3, group = "edgy"')), 'did you mean "edge"?')
    refused(write("region.toml", SHEET, ("ramp = ", "region = {sphere = {centre = [50, 0, 0], radius = 1}}, ramp = ")),
            "no facet of the surface lies in the region")
    refused(write("skin.toml", SHEET, ('"triangles"', '"skin"'), (r", inside = \[2, 2, -5\]", "")),
            'sheets take surface = "triangles"')
    refused(write("both.toml", SHEET, ('"triangles"', '"skin"')), "inside")
    refused(write("drop.toml", SHEET + '[watch]\non_unphysical = "drop"\n'), "none may be dropped")
    refused(write("ramp.toml", SHEET, ("ramp = ", "constant = true, ramp = ")), "constant")


def test_files_of_triangles_are_read_and_their_mistakes_told():
    Path("triangles.csv").write_text("i,j,k\n0,1,5\n1,6,5\n")
    case = write("file.toml", SHEET, ('"triangles"', '"triangles", file = "triangles.csv"'))
    vbond("run", case, "-o", "file", err='2 triangles of group "all", with free edges: area 0.866025')
    Path("triangles.csv").write_text("i,j,k\n0,1,5\n1,6,77\n")
    refused(case, "triangles.csv:3:1:", '77 is no particle of group "all"', "correct the row")
    Path("triangles.csv").write_text("i,j,k\n0,1,5\n1,0,6\n0,1,7\n")
    refused(case, "3 triangles meet at the edge of particles 0 and 1")
    Path("triangles.csv").write_text("i,j,k\n0,1,1\n")
    refused(case, "triangles.csv:2:1:", "a triangle has a particle twice")


def test_a_run_with_pressure_resumes_to_the_bit_and_closes_its_books():
    case = write("sheet.toml", SHEET)
    vbond("run", case, "-o", "whole")
    assert abs(column("whole", "work_loads")[-1]) > 1e-6
    assert number("whole", "energy_balance_error") < 1e-3
    stop_at(lines("whole/history.csv") // 2, "part", "run", case, "-o", "part", "--threads", 2)
    vbond("resume part")
    expect_same("whole", "part")


@at_rest
def test_a_ring_shrinks_by_its_closed_form():
    vbond("run", write("ring.toml", RING), "-o", "ring", err='stage "stage-1": pressure on 24 strips of group "all", closed: area 25.061, volume 49.6933')
    # particle 0 moves along x alone: R_c = R EA/(EA + p R cos(pi/N)), EA = c_A a
    a, R, p = 2 * 4 * math.sin(math.pi / 24), 4.0, 1e-5
    shrunk = R * a / (a + p * R * math.cos(math.pi / 24)) - R
    assert column("ring", "displacement.0.x")[-1] == pytest.approx(shrunk, rel=1e-9)


@at_rest
def test_a_free_block_is_pressed_alike_from_all_sides():
    vbond("run", write("block.toml", BLOCK), "-o", "block", err='triangles of group "all", closed: area 54, volume 27')
    last = table("block")[-1]
    for k in ("xx", "yy", "zz"):  # to the strain, some 1e-3 of the stress, by which the volume is smaller
        assert last[f"stress.all.{k}"] == pytest.approx(-1e-3, rel=1e-2)
        assert last[f"stress.all.{k}"] == pytest.approx(last["stress.all.xx"], rel=1e-9)
    for group in "abc":
        for k in "xyz":
            assert abs(last[f"reaction.{group}.f{k}"]) < 1e-10


@at_rest
def test_a_free_cylinder_of_a_packing_stays_isotropic():
    Path("cylinder.toml").write_text("""units = {system = "reduced"}
specimen = [{kind = "packing", density = 1, vessel = [{cylinder = {from = [0, 0, 0], to = [0, 0, 9], radius = 3}}],
  grains = [{radii = [0.35, 0.5]}], porosity = 0.45}]
bonds = [{gap = 0.12, stiffness = {c_A = 1, c_D = 0.3, c_B = 0.05, c_T = 0.05}}]
groups = {one = {indices = [0]}}
output = {history = {stress = [{group = "all", volume = 100}], reactions = ["one"]}}
[[stage]]
kind = "equilibrium"
pressures = [{surface = "skin", pressure = 1e-4}]
supports = [{group = "one", fix = ["x", "y", "z", "rx", "ry", "rz"]}]
""".replace('],\n  grains', '], grains'))
    told = vbond("run cylinder.toml -o cylinder").err
    volume = float(re.search(r"closed: area [0-9.]+, volume ([0-9.]+)", told)[1])
    assert 100 < volume < math.pi * 3**2 * 9
    last = table("cylinder")[-1]
    mean = sum(last[f"stress.all.{k}"] for k in ("xx", "yy", "zz")) / 3
    assert mean * 100 / volume == pytest.approx(-1e-4, rel=1e-2)  # to the strain
    for k in ("xx", "yy", "zz"):
        assert last[f"stress.all.{k}"] == pytest.approx(mean, rel=1e-9)
    for k in ("yz", "zx", "xy"):
        assert abs(last[f"stress.all.{k}"]) < 1e-9 * abs(mean)
    for k in ("fx", "fy", "fz", "mx", "my", "mz"):  # one particle, clamped, carries nothing
        assert abs(last[f"reaction.one.{k}"]) < 1e-9


@at_rest
def test_the_example_collapses_as_the_ring_of_bonds_does():
    run_example("pressed_ring")
    # EA R^2/EI = 3e4: 3.0240133 EI/R^3 at 4e4, and by 1/(EA R^2/EI) more: compare with the closed form of mode 2 of
    # an inextensible ring, 3 EI/R^3 = 420 kPa, which 48 bonds raise by 0.8 %
    factors = [c for c in values("pressed_ring.out", "critical_load_factors")[0]]
    assert factors[0] == pytest.approx(1.008 * 420, rel=1e-3)


@at_rest
def test_a_region_chooses_a_part_of_the_skin():
    """The lower face of the block, and all but that: together the block, whose lower corners nothing moves apart."""
    face = "region = {plane = {point = [0, 0, 0], normal = [0, 0, 1], within = 0.1}}"
    rest = "region = {half_space = {point = [0, 0, 0.1], normal = [0, 0, -1]}}"
    skin = '{surface = "skin", pressure = 1e-3}'
    part = '{{surface = "skin", pressure = 1e-3, {}}}'.format
    case = write("parts.toml", BLOCK.replace(skin, part(face) + ", " + part(rest)))
    told = vbond("run", case, "-o", "parts").err
    assert '18 triangles of group "all", with free edges: area 9\n' in told
    assert '90 triangles of group "all", with free edges: area 45\n' in told
    assert "has no energy" not in told  # two parts under one pressure are closed
    vbond("run", write("block.toml", BLOCK), "-o", "both")
    for k in ("xx", "yy", "zz"):
        assert table("parts")[-1][f"stress.all.{k}"] == pytest.approx(table("both")[-1][f"stress.all.{k}"], rel=1e-9)
    one = write("one.toml", BLOCK.replace(skin, part(face)))
    vbond("run", one, "-o", "one", err="the pressure has no energy: the surface that it follows has a free edge at particle")
    for kind in ("buckling", "modes"):
        case = write("other.toml", BLOCK.replace(skin, part(face)).replace('kind = "equilibrium"', f'kind = "{kind}"'))
        vbond("run", case, "-o", kind, status=1, err=["free edge at particle", "close the surface"])


@at_rest
def test_a_ring_rings_lower_under_pressure():
    """Of mode 2 the square of the frequency falls to 0 in proportion to the pressure, but for the shrinking of the
    ring, p R/EA, some 1e-3."""
    held = RING.replace("indices = [6]", "indices = [6, 18]")
    write("critical.toml", held, ("equilibrium", "buckling"), ("1e-5", "1.0"))
    vbond("run critical.toml --set stage[0].count=1 -o critical")
    critical = values("critical", "critical_load_factors")[0][0]
    lowest = []
    for part in (1e-9, 0.5):
        write("modes.toml", held, ("equilibrium", "modes"), ("1e-5", repr(part * critical)))
        vbond("run modes.toml --set stage[0].count=1 -o modes" + str(len(lowest)))
        lowest.append(values(f"modes{len(lowest)}", "omega")[0][0] ** 2)
    assert lowest[1] / lowest[0] == pytest.approx(0.5, abs=5e-3)


@at_rest
def test_a_ring_bursts_at_its_closed_form():
    """A bond that is 2 % longer breaks: then R is too, and its force is c_A a 0.02 = |p| R cos(pi/N)."""
    case = write("burst.toml", RING, ("equilibrium", "fracture"), ("pressure = 1e-5", "pressure = -1.0"),
                 ("c_T = 0.003}", 'c_T = 0.003}, strength = {criterion = "elongation", elongation = 0.02}'))
    vbond("run", case, "-o", "burst")
    a, R = 2 * 4 * math.sin(math.pi / 24), 4.0
    bursts = a * 0.02 / (1.02 * R * math.cos(math.pi / 24))
    assert values("burst", "peak_load_factor")[0] == pytest.approx(bursts, rel=1e-8)
    assert abs(values("burst", "balance_error")[0]) < 1e-9
