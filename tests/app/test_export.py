"""The files for LAMMPS, whose text is tested by the plugin's tests where LAMMPS is."""
import json
import re
from pathlib import Path

from program import EXAMPLES, vbond


def test_export():
    fibres = EXAMPLES / "two_fibres.toml"
    vbond("export", EXAMPLES / "two_particles.toml", "-o", "warm", sets="bonds[0].expansion=1e-5", no_out="temperatures")
    vbond("export", fibres, "-o", "files", out=["left out:", "contacts"])
    particles = re.search("^particles +([0-9]+)", vbond("check", fibres).out, re.M).group(1)
    data, bonds = (Path("files", name).read_text() for name in ("body.data", "body.bonds"))
    assert f"{particles} atoms" in data.splitlines()
    count = int(re.search("^([0-9]+) bonds$", data, re.M).group(1))
    assert len(re.findall("^[0-9]", bonds, re.M)) == count, "body.bonds has other bonds than body.data"
    vbond("export", fibres, "-o", "files", status=3, err="body.data is there already")


def test_the_input_makes_as_many_steps_as_a_run():
    # 3.3 over the step that was fitted to it is 47.00000000000001
    Path("rod.toml").write_text("""
specimen = [{kind = "rod", particles = 3, radius = 0.4, mass = 1.0}]
bonds = [{distance = 1.1, stiffness = {c_A = 1, c_D = 0.5, c_B = 0.2, c_T = 0.2}}]
time = {fraction = 0.117}
stage = [{name = "a", duration = 3.3}]
""")
    vbond("export", "rod.toml", "-o", "rod")
    vbond("run", "rod.toml", "-o", "run")
    steps = json.loads(Path("run/run.json").read_text())["stages"][0]["steps"]
    assert f"steps index {steps} " in Path("rod/body.lammps").read_text()


def test_what_is_refused_is_not_written():
    said = vbond("export", EXAMPLES / "elastica.toml", "-o", "none", status=2, err="elastica.toml:").err
    assert re.search("the first stage is static|was built without statics", said), said
    vbond("export", EXAMPLES / "plastic_beam.toml", "-o", "none", status=2, err="remember nothing")
    assert not Path("none").exists()
