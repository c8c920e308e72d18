"""The report page and the plots in the terminal, of runs that ended, failed, were stopped, or have no frames."""
import base64
import gzip
import os
import re
import shutil
from pathlib import Path

import pytest
from program import EXAMPLES, PROGRAM, STATICS, TEMPLATE, call, edit, edited, frames, page, values, vbond, write

GOOD = edited((EXAMPLES / "two_particles.toml").read_text(), ("^title.*", 'title = "Two <script>alert(1)</script> particles"'))


def has(folder, *texts):
    """Each stands in the JSON of its page."""
    for text in texts:
        assert text in page(folder), f"no '{text}' in the page of {folder}"


def bonds_frames(folder):
    return sorted(Path(folder, "frames").glob("bonds_*"))


def copy(name, of="good"):
    shutil.rmtree(name, ignore_errors=True)
    shutil.copytree(of, name)


@pytest.fixture(scope="module", autouse=True)
def good(work):
    vbond("run", write("good.toml", GOOD), *"-o good --report".split(), out=["results in good", "report in good/report.html"]).silent()


def test_a_run_that_ended(work):
    text = Path("good/report.html").read_text()
    assert text.count("\n") == 4 and text.endswith("\n</html>\n"), "the template was not kept"
    has("good", r'"title":"Two \u003cscript\u003ealert(1)\u003c/script\u003e particles"', '"warnings":[]', '"2 particles, 1 bond"',
        "theory Bernoulli-Euler", '"0.0628319, 0.01 T_0, 4.44 % of the critical step"', '"kind":"run"', '"stage":"swing"',
        '"first_shown":0')
    assert '"stages":' not in page("good") and str(work) not in page("good")
    assert not re.search("[<>&]", page("good")), "a text can end its element"
    count = len(frames("good/particles.pvd"))
    assert len(re.findall('"step":[0-9]*,"time":[0-9.]*,"stage"', page("good"))) == count
    # bonds 8, reference 24, then per frame: displacements 12, speeds 2, six fields and the range of one bond
    size = len(gzip.decompress(base64.b64decode(page("good", "data"))))
    assert 32 + 21 * count <= size < 32 + 21 * count + 40
    vbond("report good")
    assert Path("good/report.html").read_text() == text, "a second report differs from the first"
    assert not list(Path("good").rglob("*.part")), "temporary files are left"


@pytest.mark.skipif(not STATICS, reason="built without statics")
def test_modes_that_were_asked_for_last_are_shown_first(work):
    vbond("run", EXAMPLES / "rod_buckling.toml", *"-o modes --report".split())
    has("modes", '"first_shown":1', r'"name":"Buckling mode 1 of stage \"critical\""', "critical force 0.000307818",
        '"stages":[{"name":"critical","held":', '"stage":"critical"')
    assert "energy balance" not in page("modes") and str(work) not in page("modes")


def test_a_shells_thickness_is_told_with_its_other_constants():
    vbond("run", write("sheet.toml", """units = {system = "SI"}
stage = [{duration = "1e-5 s"}]
bonds = [{distance = "21 mm", theory = "shell", E = "2 GPa", nu = 0.3, thickness = "2 mm"}]
[[specimen]]
kind = "sheet"
lattice = "triangular"
particles = [3, 3]
spacing = "20 mm"
thickness = "2 mm"
density = "1000 kg/m^3"
"""), *"-o sheet --report".split())
    has("sheet", 'theory shell, E = 2e+09 Pa, nu = 0.3, thickness 0.002 m"')


@pytest.mark.parametrize("keys, strength", [
    ('strength = {criterion = "stress", tension = "3 MPa", shear = "5 MPa", compression = "9 MPa", moment_share = 0.5}',
     "by stress: tension 3e+06 Pa, shear 5e+06 Pa, compression 9e+06 Pa, share of moments 0.5"),
    ('strength = {criterion = "mohr-coulomb", cohesion = "5 MPa", friction_angle = "30 deg", tension_limit = "3 MPa", weibull = {modulus = 6}}',
     "by mohr-coulomb: cohesion 5e+06 Pa, friction angle 30 degrees, tension 3e+06 Pa, Weibull's modulus 6"),
    ('strength = {criterion = "linear", axial_force = "3 N", shear_force = "4 N", bending_moment = "5 N*m", torque = "6 N*m"}',
     "by linear: axial force 3 N, shear force 4 N, bending moment 5 N m, torque 6 N m"),
    ('strength = {criterion = "energy", tension_energy = "3 J", other_energy = "4 J"}', "by energy: tension 3 J, others 4 J"),
    ('strength = {criterion = "elongation", elongation = 0.02}', "by elongation: of 0.02"),
    ("", None),
])
def test_sections_and_strengths_are_told(tmp_path, keys, strength):
    folder = tmp_path / "rod"
    vbond("run", write(tmp_path / "rod.toml", f"""units = {{system = "SI"}}
stage = [{{duration = "1e-5 s"}}]
[[bonds]]
name = "rod"
distance = "21 mm"
theory = "bernoulli-euler"
E = "2 GPa"
section = {{shape = "circle", diameter = "4 mm"}}
nu = 0.3
{keys}
[[specimen]]
kind = "rod"
particles = 3
spacing = "20 mm"
mass = "1 g"
radius = "5 mm"
"""), "-o", folder, "--report")
    has(folder, "section of diameter 0.004 m")
    assert f'["Bonds break","\\"rod\\" {strength}"]' in page(folder) if strength else "Bonds break" not in page(folder)


def test_without_frames_and_while_it_runs():
    vbond("run", write("bare.toml", GOOD, ("^frames.*\n", "")), *"-o bare --report".split())
    has("bare", '"sequences":[]', '"axial_force.all"', '"clock":"time"', '"no_frames":"The case asks for no frames',
        "reduced (no units)", "Largest error of the energy balance")
    copy("running")
    Path("running/run.json").unlink()
    with open("running/history.csv", "a") as history:
        history.write("12,")
    vbond("report running")
    has("running", '"level":"note"', "0 of 1 stages have ended", "vbond resume running")
    vbond("plot running --png", env={"PATH": "/nowhere"}, status=3, err="install chromium")


def test_folders_that_were_copied_or_written_in_part(work):
    copy("part")
    frame = bonds_frames("part")[-1]
    frame.unlink()
    write("part/history.csv", "")
    vbond("report part")
    has("part", f"The last of the {len(frames('good/particles.pvd'))} frames of the run is left out", str(frame.relative_to("part")),
        '"rows_in_file":0', '"kind":"run"')
    shutil.rmtree("part/frames")
    vbond("report part")
    has("part", '"no_frames":"None of the frames in the folder can be read', '"sequences":[]')
    assert str(work) not in page("part")


def test_no_page_tells_of_the_machine_it_was_made_on(work):
    for folder, y in (("points", 0), ("more", 3)):
        os.makedirs(f"deep/{folder}")
        write(f"deep/{folder}/body.csv", f"x,y,z\n0,{y},0\n1,{y},0\n")
    specimen = ", ".join(f'{{name = "{folder}", kind = "csv", file = "{work}/deep/{folder}/body.csv", mass = 1.0, inertia = 0.1}}'
                         for folder in ("points", "more"))
    vbond("run", write("files.toml", f"""specimen = [{specimen}]
stage = [{{name = "swing", duration = 1.0}}]
time = {{step = 0.1}}
output = {{frames = {{every = 0.5}}}}
"""), "-o", "files")
    bonds_frames("files")[-1].unlink()
    vbond("report", work / "files")
    has("files", "is left out", "cannot read frames/bonds_", r"file = \"inputs/body.csv\"", r"file = \"inputs/body_2.csv\"",
        "The case reads inputs/body.csv, inputs/body_2.csv")
    assert str(work) not in page("files")


def test_names_that_would_steer_a_terminal():
    write("steers.toml", GOOD, ("^title = .*", r'title = "a\\u001b[2Jb\\u0000c\\u009b2J"'))
    for command in ("run steers.toml -o steers", "check steers.toml"):
        vbond(command, out=r"a\x1b[2Jb\x00c\x9b2J", no_out="\033", no_err="\033")
    write("steers/history.csv", 'step,"a\033[2Jb\n')
    vbond("report steers", status=3, err=r"\x1b[2Jb", no_out="\033", no_err="\033")


def test_files_that_were_forged():
    copy("forged")
    write("precious", "precious\n")
    os.symlink("../precious", "forged/report.html.part")
    vbond("report forged")
    assert Path("precious").read_text() == "precious\n", "a link was written through"
    assert Path("forged/report.html").is_file() and not Path("forged/report.html").is_symlink()
    assert not os.path.lexists("forged/report.html.part")


def test_a_run_that_diverged():  # with bonds that snapped
    write("wild.toml", GOOD + "[watch]\nevery = 1\n", ("^step = .*", "step = 1.0\ninsist = true"),
          ("^velocity = .*", "velocity = [0.3, 0.9, 0.0]"), ("^angular_velocity = .*", "angular_velocity = [0.0, 0.0, 3.0]"))
    vbond("run wild.toml -o wild --report", status=1, out="report in wild/report.html")
    assert values("wild", "failure")[0].startswith("step "), "run.json does not say why"
    assert "Largest error of the energy balance" not in page("wild")
    has("wild", r'"warnings":[{"level":"error","text":"The run became unphysical in stage \"swing\"')


def test_the_page_was_not_built(work):
    none = {"VBOND_PAGE": f"{work}/none.html"}
    vbond("report good", env=none, status=3, err=["was not built", f"looked for {work}/none.html", "install nodejs and npm"])
    run = vbond("run good.toml -o unseen --report", env=none, out="results in unseen", err=[
        "warning: there will be no report: ", "install nodejs and npm", "no report: the report page was not built", "vbond report unseen"])
    assert run.err.count("install nodejs") == 1, f"the same advice twice: {run}"
    assert not Path("unseen/report.html").exists(), "a page without a template"
    for folder in ("place/bin", "place/share/vbond"):
        os.makedirs(folder)
    shutil.copy(PROGRAM, "place/bin/vbond")
    write("place/share/vbond/report.html", TEMPLATE)
    call(["place/bin/vbond", "report", "good"], env={"VBOND_PAGE": ""}).expect()
    vbond("report good", env={"VBOND_PAGE": f"{work}/good.toml"}, status=3, err='0 lines "<!-- run -->"')


def test_folders_that_are_wrong():
    vbond("report nowhere", status=3, err="nowhere: is not an output folder of vbond run")
    copy("cut")
    vbond("run good.toml -o cut --force")
    assert not Path("cut/report.html").exists(), "--force leaves the report of the earlier run"
    frame = bonds_frames("cut")[1]
    os.truncate(frame, frame.stat().st_size - 1)
    vbond("report cut", status=3, err=f"{frame}: is cut short")


def test_plots_in_the_terminal():
    vbond("run", write("bare.toml", GOOD, ("^frames.*\n", "")), *"-o plotted".split())
    said = vbond("plot plotted U_L displacement.0.x", out=["U_L", "displacement.0.x", "time", "⠀"]).out
    assert said.count("\n") == 24, f"two panels of twelve lines: {said}"
    vbond("plot plotted axial_force.all --x displacement.0.x", out=["axial_force.all", "displacement.0.x"])
    run = vbond("plot plotted U_X", status=2, err=["column U_X", "it has step, time", "axial_force.all"])
    assert not run.out, f"a plot before the error: {run}"
    vbond("plot plotted U_L --x U_X", status=2)
    vbond("plot plotted", status=2, err="no column is given")
    vbond("plot nowhere U_L", status=3)
    wide = "axial_force.of_a_group_with_a_name_that_is_wider_than_any_panel_of_eighty_characters"
    edit("plotted/history.csv", ("axial_force.all", wide))
    assert len(vbond("plot plotted U_L --x", wide).out.splitlines()[-1].encode()) <= 80
    vbond("plot plotted --png", status=3, err=["plotted/report.html is written, but there is no picture to take of it",
                                               "The case asks for no frames"])
    assert not Path("plotted/report.png").exists(), "a picture of nothing"
    write("plotted/history.csv", "")
    vbond("plot plotted U_L", status=2, err="it has none yet")
