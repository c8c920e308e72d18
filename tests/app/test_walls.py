"""What the program says and writes of walls: check in words, history.csv, run.json and frames; and that a run without
walls has nothing of it."""
from pathlib import Path

import pytest
from program import column, frames, number, values, vbond, write

BODY = """output = {history = {every = "0.1 ms"}, frames = {every = "0.5 ms"}}
units = {system = "SI"}
specimen = [{kind = "block", cells = [2, 2, 2], spacing = "10 mm", radius = "4.5 mm", mass = "1 g"}]
bonds = [{distance = "11 mm", stiffness = {c_A = 1e3, c_D = 30, c_B = 2e-3, c_T = 2e-3}}]
"""
PRESS = BODY + """
material = [{name = "glass", E = "70 MPa", nu = 0.22, friction = 0.2}, {name = "steel", E = "210 MPa", nu = 0.3}]
wall = [
  {name = "floor", shape = "plane", material = "steel", point = [0, 0, "-4.5 mm"], normal = [0, 0, 1]},
  {name = "platen", shape = "disc", centre = ["5 mm", "5 mm", "14.5 mm"], normal = [0, 0, 1], radius = "30 mm"},
]
stage = [
  {name = "press", duration = "1 ms", walls = [{wall = "platen", velocity = [0, 0, "-0.5 m/s"]}]},
  {name = "hold", duration = "1 ms", walls = [
    {wall = "platen", servo = {direction = [0, 0, -1], force = "10 N", mass = "10 g"}}]},
]
[contact]
law = "hertz"
tangential = "mindlin"
friction = 0.3
restitution = 0.8
between = [{material = "glass", with = "steel", friction = 0.15}]
"""
FREE = BODY + """stage = [{duration = "1 ms"}]
[contact]
law = "hertz"
E = "70 MPa"
nu = 0.22
"""


def test_check_tells_of_contacts_and_walls():
    vbond("check", write("press.toml", PRESS), out=[
        "contact law      Hertz", "friction by Mindlin's spring",
        "glass with glass: E* = 3.67802e+07 Pa, e = 0.8 ([contact]), mu = 0.2 ([[material]])",
        "glass with steel: E* = 5.57799e+07 Pa, e = 0.8 ([contact]), mu = 0.15 (contact.between)",
        "a stage at rest takes these contacts without friction: contact.tangential",
        "wall floor       plane through (0, 0, -0.0045), particles on the side of (0, 0, 1), of steel", "stands still",
        "wall platen      disc at (0.005, 0.005, 0.0145) across (0, 0, 1), radius 0.03, of glass",
        "in stage press it moves at (0, 0, -0.5) m/s", "in stage hold it is pressed along (0, 0, -1) by 10 N",
        "from contacts of particle 0, glass with steel"], no_out="steel with steel")
    vbond("check", write("sticky.toml", FREE + 'adhesion = "dmt"\nwork_of_adhesion = "0.1 J/m^2"\n'),
          out="a stage at rest would refuse these contacts, which do more than repel: contact.adhesion")
    vbond("check", write("free.toml", FREE), no_out=["not elastic", "stands still"], out=[
        "contact law      Hertz, 4/3 E* sqrt(R*) d^(3/2); no friction", "e = 1 (default)", "contacts of particle 0"])


def test_a_run_tells_of_its_walls_and_one_without_does_not():
    vbond("run", write("press.toml", PRESS), "-o", "pressed")
    for name in "Fx Fy Fz Mx My Mz x y z work".split():
        assert None not in column("pressed", f"wall.floor.{name}")
    # 1 ms at 0.5 m/s; particles push the floor down and the platen up
    assert any(abs(z + 5e-4) < 1e-8 for z in column("pressed", "wall.platen.z")), "the platen has not moved by 0.5 mm"
    floor, platen = (column("pressed", f"wall.{wall}.Fz") for wall in ("floor", "platen"))
    assert min(floor) < -0.1 and max(floor) <= 0
    assert max(platen) > 0.1 and min(platen) >= 0
    work = column("pressed", "wall.platen.work")[-1]
    assert work > 0 and column("pressed", "work_supports")[-1] == pytest.approx(work, rel=1e-12), "the books hold the work of all walls"
    assert number("pressed", "work") == 0, "the floor works"
    assert number("pressed", "largest_force") > 0.1
    assert len(frames("pressed/walls.pvd")) == len(frames("pressed/particles.pvd"))
    for _, frame in frames("pressed/walls.pvd"):
        assert b'NumberOfPolys="66"' in Path("pressed", frame).read_bytes(), f"{frame}: not 2 triangles of a plane and 64 of a disc"
    vbond("run", write("free.toml", FREE), "-o", "pressed", "--force")
    for name in ("history.csv", "history.columns.json"):
        assert "wall" not in Path("pressed", name).read_text(), "a run without walls tells of some"
    assert not values("pressed", "walls")
    assert not Path("pressed/walls.pvd").exists() and not Path("pressed/frames/walls_000000000000.vtp").exists()
