"""The material that a periodic cell is a piece of, and bonds for a material, through the program."""
import json
import math
import re
from pathlib import Path

import pytest
from program import EXAMPLES, number, run_example, table, values, vbond

LATTICE = """[cell]
a = [3, 0, 0]
b = [0, 3, 0]
c = [0, 0, 3]
[[specimen]]
kind = "block"
cells = [3, 3, 3]
radius = 0.5
mass = 1.0
[[bonds]]
name = "near"
distance = 1.1
stiffness = { c_A = 1.0, c_D = 0.4, c_B = 0.05, c_T = 0.05 }
[[bonds]]
name = "far"
distance = 1.5
stiffness = { c_A = 0.5, c_D = 0.2, c_B = 0.05, c_T = 0.05 }
[time]
step = 0.5
[[stage]]
duration = 1
"""


@pytest.fixture
def lattice():
    Path("lattice.toml").write_text(LATTICE, encoding="utf-8")
    return "lattice.toml"


def constants(case, *options):
    return json.loads(vbond("homogenise", case, "--json", *options).out)


def test_a_lattice_says_what_it_is(lattice):
    found = constants(lattice)
    text = vbond("homogenise", lattice).out
    assert found["order"] == ["xx", "yy", "zz", "yz", "xz", "xy"] and found["particles"] == 27 and found["floating"] == 0
    assert "27 particles" in text and f"{found['hill']['E']:.7g}" in text and "Anisotropy" in text
    assert found["E"]["x"] == pytest.approx(found["E"]["z"], rel=1e-12)
    assert found["wave_speeds"]["x"][2] == pytest.approx((found["C"][0][0] / found["density"]) ** 0.5, rel=1e-12)


def test_constants_in_si_have_units(lattice):
    text = "[units]\nsystem = \"SI\"\n" + Path(lattice).read_text(encoding="utf-8").replace("radius = 0.5", "spacing = 1.0\nradius = 0.5")
    Path("si.toml").write_text(text, encoding="utf-8")
    said = ["K [Pa]         G [Pa]         E [Pa]         nu", "Young's modulus [Pa]  x ", "Waves [m/s], two of shear"]
    vbond("homogenise si.toml", out=said)
    vbond("homogenise", lattice, out="K              G              E              nu", no_out=["[Pa]", "[m/s]"])


def test_bonds_are_calibrated_and_the_case_has_the_constants(lattice):
    wanted = constants(lattice, "--set", "bonds[0].stiffness_factors.c_D=0.5", "--set", "bonds[1].stiffness_factors.c_D=0.5")["hill"]
    said = vbond("calibrate", lattice, "--E", "10", "--nu", repr(wanted["nu"]), "--bending", "normal").out
    lines = [line for line in said.splitlines() if line.startswith("stiffness_factors = ")]
    assert len(lines) == 2 and "# near" in said and "# far" in said
    text = Path(lattice).read_text(encoding="utf-8")
    Path("found.toml").write_text(text.replace('name = "near"\n', f'name = "near"\n{lines[0]}\n')
                                      .replace('name = "far"\n', f'name = "far"\n{lines[1]}\n'), encoding="utf-8")
    found = constants("found.toml")["hill"]
    assert found["E"] == pytest.approx(10, rel=1e-8) and found["nu"] == pytest.approx(wanted["nu"], abs=1e-8)


def test_stiffnesses_per_area_are_told_as_such(lattice):
    parallel = 'theory = "parallel"\nk_n = 2.0\nk_s = 1.0\nsection = { shape = "circle", factor = 0.5 }'
    text = Path(lattice).read_text(encoding="utf-8")
    first, second = text.split("[[bonds]]")[1:]
    one = text.replace(first, first.split("stiffness")[0] + parallel + "\n").replace("[[bonds]]" + second, "[time]" + second.split("[time]")[1])
    Path("parallel.toml").write_text(one, encoding="utf-8")
    said = vbond("calibrate", "parallel.toml", "--E", "3", "--nu", "0.05").out
    k_n, k_s = (float(line.split("=")[1]) for line in said.splitlines() if line.startswith("k_"))
    found = constants("parallel.toml", "--set", f"bonds[0].k_n={k_n!r}", "--set", f"bonds[0].k_s={k_s!r}")["hill"]
    assert found["E"] == pytest.approx(3, rel=1e-8) and found["nu"] == pytest.approx(0.05, abs=1e-8)


def test_what_cannot_be_is_refused_with_the_nearest(lattice):
    run = vbond("calibrate", lattice, "--E", "1", "--nu", "0.45", status=1, err=["nu = 0.45 cannot be had", "the nearest, nu = "])
    assert "stiffness_factors" in run.out
    vbond("calibrate", lattice, "--E", "1", "--nu", "0.6", status=2, err=["--nu 0.6", "nu < 0.5"])
    vbond("calibrate", lattice, "--length", "1", status=2, err=["--E", "--nu", "--length", "leave it out"])
    vbond("calibrate", lattice, "--E", "69 GPa", "--nu", "0.2", status=2, err=["69 GPa", "reduced units"])
    vbond("calibrate", "--E", "1", "--length", "1", "--side", "0.2", "--bending", "normal", status=2, err="CASE")
    text = Path(lattice).read_text(encoding="utf-8")
    Path("open.toml").write_text(text.replace("c = [0, 0, 3]", 'c = [0, 0, 3]\nopen = ["c"]'), encoding="utf-8")
    vbond("calibrate", "open.toml", "--E", "1", "--nu", "0.2", status=2, err=["no periodic cell", "docs/cell.md"])
    vbond("homogenise", "open.toml", "--volume", "3", status=2, err=["has a periodic cell", "--volume and --surface", "leave them out"])
    Path("rod.toml").write_text(text.replace("c = [0, 0, 3]", 'c = [0, 0, 3]\nopen = ["b", "c"]'), encoding="utf-8")
    vbond("homogenise", "rod.toml", status=2, err=["periodic in one direction", "docs/cell.md"])


def without_cell(lattice):
    text = Path(lattice).read_text(encoding="utf-8")
    Path("body.toml").write_text("[groups]\nskin = { box = { min = [-1, -1, -1], max = [9, 9, 0.1] } }\n" +
                                 text[text.index("[[specimen]]"):], encoding="utf-8")
    return "body.toml"


def test_a_sheet_says_what_it_is(lattice):
    text = Path(lattice).read_text(encoding="utf-8").replace("c = [0, 0, 3]", 'c = [0, 0, 3]\nopen = ["c"]')
    second = text.split("[[bonds]]")[2]
    one = text.replace("[[bonds]]" + second, "[time]" + second.split("[time]")[1]).replace("cells = [3, 3, 3]", "cells = [3, 3, 1]")
    Path("sheet.toml").write_text(one, encoding="utf-8")
    found = constants("sheet.toml")
    # a square lattice: c_A and c_D/2, c_B and c_T/2
    for name, stretch, shear in (("A", 1.0, 0.2), ("D", 0.05, 0.025)):
        for i in range(3):
            for j in range(3):
                exact = (stretch if i < 2 else shear) if i == j else 0.0
                assert found[name][i][j] == pytest.approx(exact, abs=1e-13), (name, i, j)
    assert found["axes"][2] == [0, 0, 1] and found["area"] == 9 and found["bonds"] == 18
    said = vbond("homogenise", "sheet.toml").out
    assert "1, 2 and the normal are x, y and z" in said and "D, moments by curvature" in said


def test_a_body_says_what_it_is_by_both_ways(lattice):
    case = without_cell(lattice)
    found = constants(case)
    upper, lower = found["by_displacement"], found["by_traction"]
    assert found["volume"] == pytest.approx(27) and found["surface"] == 26 and found["particles"] == 27
    # 18 near bonds along x; of the far ones, of length^2 = 2, 48 have x in their planes: half of the strain stretches them,
    # and half of it shears them
    assert upper["C"][0][0] == pytest.approx((18 * 1.0 + 48 * 2 * 0.25 * (0.5 + 0.2)) / 27, rel=1e-12)
    assert lower["voigt"]["K"] <= upper["voigt"]["K"] and lower["voigt"]["G"] < upper["voigt"]["G"]
    smaller = constants(case, "--volume", "13.5")
    assert smaller["by_traction"]["C"][0][0] == pytest.approx(2 * lower["C"][0][0], rel=1e-12)
    said = vbond("homogenise", case, "--volume", "13.5").out
    assert "volume 13.5 (as given)" in said and "26 particles are its surface" in said
    vbond("homogenise", case, "--volume", "0", status=2, err=["--volume 0", "must be > 0"])
    vbond("homogenise", case, "--volume", "1 mm^3", status=2, err=["reduced units"])
    vbond("homogenise", case, "--surface", "skn", status=2, err=["--surface skn", "no group"])
    vbond("homogenise", case, "--surface", "skin", status=2, err=["one plane"])


def shown(case, page, *options):
    """What stands in the page of a case, and what was said."""
    said = vbond("homogenise", case, "--report", page, *options)
    text = Path(page).read_text(encoding="utf-8")
    found = json.loads(re.search(r'^<script type="application/json" id="material">(.*)</script>$', text, re.M)[1])
    assert text.count("<script") == 1 and found["format"] == 1 and found["units"] == "reduced" and found["case"] == case
    return found, said


def test_a_page_shows_the_cell(lattice):
    text = Path(lattice).read_text(encoding="utf-8")
    Path("named.toml").write_text('title = "A <b>lattice</b>"\n' + text, encoding="utf-8")
    page, said = shown("named.toml", "cell.html")
    found = constants("named.toml")
    assert page["found"] == found and page["title"] == "A <b>lattice</b>" and page["warnings"] == []
    assert "report in cell.html" in said.out and "Anisotropy" in said.out
    (material,) = page["materials"]
    assert (material["key"], material["name"], [plane["plane"] for plane in material["planes"]]) == ("", "", ["xy", "yz", "zx"])
    for plane in material["planes"]:
        at = {degrees: {name: plane[name][k] for name in plane if name not in ("plane", "degrees")} for k, degrees in enumerate(plane["degrees"])}
        assert sorted(at) == list(range(0, 360, 2))
        for degrees, axis in zip((0, 90, 180, 270), 2 * plane["plane"]):
            assert at[degrees]["E"] == pytest.approx(found["E"][axis], rel=1e-12)
            # along an axis of a cube all directions across are alike
            G = [value for name, value in found["G"].items() if axis in name]
            nu = [value for name, value in found["nu"].items() if name[0] == axis]
            for name, values_of in (("G", G), ("nu", nu)):
                assert at[degrees][f"{name}_least"] == pytest.approx(min(values_of), rel=1e-10)
                assert at[degrees][f"{name}_largest"] == pytest.approx(max(values_of), rel=1e-10)
        S = found["S"]
        assert 1 / at[46]["E"] == pytest.approx(
            S[0][0] - 2 * (S[0][0] - S[0][1] - S[3][3] / 2) * (math.sin(math.radians(92)) / 2) ** 2, rel=1e-9)
        # of cubes, along the diagonal of a face: c_44 and (c_11 - c_12)/2 by those nearest to 45 degrees are not equal
        assert at[44]["G_least"] < at[44]["G_largest"] and at[44]["nu_least"] < at[44]["nu_largest"]
        assert at[44]["G_least"] == pytest.approx(at[46]["G_least"], rel=1e-9)
    # with --json the page is told of beside it
    page, said = shown("named.toml", "beside.html", "--json")
    assert json.loads(said.out) == found == page["found"] and "report in beside.html" in said.err


def test_a_page_shows_sheets_and_bodies(lattice):
    text = Path(lattice).read_text(encoding="utf-8")
    Path("sheet.toml").write_text(text.replace("c = [0, 0, 3]", 'c = [0, 0, 3]\nopen = ["c"]').replace("cells = [3, 3, 3]", "cells = [3, 3, 1]"),
                                  encoding="utf-8")
    page, _ = shown("sheet.toml", "sheet.html")
    assert page["found"] == constants("sheet.toml") and page["materials"] == [] and any("1, 2 and the normal" in fact for fact in page["facts"])
    case = without_cell(lattice)
    page, _ = shown(case, "body.html", "--volume", "20")
    assert page["found"] == constants(case, "--volume", "20") and "20 (as given)" in page["facts"][0]
    assert [material["key"] for material in page["materials"]] == ["by_displacement", "by_traction"]
    upper, lower = ([plane["E"] for plane in material["planes"]] for material in page["materials"])
    # more by displacement in every direction, as C is more in the sense of matrices
    assert all(a > b for A, B in zip(upper, lower) for a, b in zip(A, B))


def test_a_page_of_what_has_no_averages(lattice):
    """Under stress that differs by direction C has no symmetry: the page has C and says why nothing else."""
    places = "".join(f"{i},{j},{1.2 * k}\n" for i in range(3) for j in range(3) for k in range(3))
    Path("stretched.csv").write_text("x,y,z\n" + places, encoding="utf-8")
    pressed = LATTICE.replace("c = [0, 0, 3]", "c = [0, 0, 3.6]").replace('kind = "block"\ncells = [3, 3, 3]\nradius = 0.5', 'kind = "csv"\nfile = "stretched.csv"\nradius = 0.8')
    second = pressed.split("[[bonds]]")[2]
    pressed = pressed.replace("[[bonds]]" + second, '[contact]\nlaw = "linear"\nk = 0.05\n[time]' + second.split("[time]")[1])
    Path("pressed.toml").write_text(pressed.replace("distance = 1.1", "distance = 1.25"), encoding="utf-8")
    page, said = shown("pressed.toml", "pressed.html")
    assert "nothing else follows" in said.err
    assert page["materials"] == [{"key": "", "name": "", "planes": []}] and len(page["found"]["C"]) == 6
    assert [w["level"] for w in page["warnings"] if "nothing else follows" in w["text"]] == ["warning"]


def test_a_page_is_refused_before_anything_is_computed(lattice):
    def refused(page, *err, status=2, **more):
        before = sorted(Path().iterdir())
        vbond("homogenise", lattice, "--report", page, status=status, err=list(err), no_out="particles", **more)
        assert sorted(Path().iterdir()) == before, "something was written"

    Path("mine.html").write_text("mine", encoding="utf-8")
    refused("mine.html", "--report mine.html: it is there already", "give another name, or remove it")
    assert Path("mine.html").read_text(encoding="utf-8") == "mine"
    Path("nowhere.html").symlink_to("gone.html")
    refused("nowhere.html", "it is there already")
    refused("no/such.html", "--report no/such.html: there is no such folder", "make it first")
    refused("page.txt", "--report page.txt: the report is a page for browsers", "NAME.html")
    refused("", "NAME.html")
    refused("new.html", "the report page was not built", status=3, env={"VBOND_PAGE": "none.html"})
    vbond("homogenise", lattice, "--along", "--report", "new.html", status=2, err=["--along", "excludes"])
    vbond("homogenise", "missing.toml", "--report", "new.html", status=3, err="missing.toml")
    assert not Path("new.html").exists()


def test_silica():
    # Andre et al., CMAME 213-216 (2012) 113: beams of 265 GPa and 0.71 of the radius make silica, 72.5 GPa and 0.17. The
    # pull of the stage is that of Young's modulus along z, whose strain of 1e-4 moves it by that much.
    found = constants(EXAMPLES / "silica.toml")
    assert 72e9 < found["hill"]["E"] < 76e9 and 0.165 < found["hill"]["nu"] < 0.175
    assert 6.0 < 2 * found["bonds"] / found["particles"] < 6.1
    run_example("silica")
    row = table("silica.out")[-1]
    assert row["cell_stress_zz"] / row["cell_strain_zz"] == pytest.approx(found["E"]["z"], rel=1e-3)


PULLED = """[[stage]]
name = "pull"
kind = "equilibrium"
steps = %d
[stage.cell]
xx = { strain = 0.04 }
zz = { strain = -0.02 }
"""


def test_constants_along_a_path_are_how_stress_changes(lattice):
    """Between balances stress changes by C times logarithmic strains: by central differences, to the second order."""
    def along(steps):
        motion = LATTICE[LATTICE.index("[time]"):]
        Path("pulled.toml").write_text(LATTICE.replace(motion, PULLED % steps), encoding="utf-8")
        Path("along.csv").write_text(vbond("homogenise", "pulled.toml", "--along").out, encoding="utf-8")
        rows = table("along.csv")
        assert [row["load_factor"] for row in rows] == pytest.approx([k / steps for k in range(steps + 1)])
        return rows

    def error(steps):
        before, here, after = along(steps)[steps // 2 - 1:steps // 2 + 2]
        change = {c: math.log((1 + after["cell_strain_" + c]) / (1 + before["cell_strain_" + c])) for c in ("xx", "zz")}
        by_C = sum(here["C_xx_" + c] * change[c] for c in change)
        return (after["cell_stress_xx"] - before["cell_stress_xx"]) / by_C - 1

    first, found = along(4)[0], constants(lattice)
    assert first["C_xx_yy"] == pytest.approx(found["C"][0][1], rel=1e-9)
    assert first["E_hill"] == pytest.approx(found["hill"]["E"], rel=1e-9)
    assert abs(error(8)) < 1e-4 and error(4) / error(8) == pytest.approx(4, rel=0.05)


def test_along_needs_a_cell_and_balances(lattice):
    vbond("homogenise", lattice, "--along", status=2, err=["lattice.toml", "no static stage", "leave --along out"])
    Path("open.toml").write_text(LATTICE[LATTICE.index("[[specimen]]"):], encoding="utf-8")
    vbond("homogenise", "open.toml", "--along", status=2, err=["open.toml", "repeats in all directions"])
    vbond("homogenise", lattice, "--along", "--json", status=2, err=["--along", "excludes"])
