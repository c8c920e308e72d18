"""`vbond fit` as a user meets it: values found, what is refused, files, signals, threads, the example."""
import json
import re
from pathlib import Path
from signal import SIGTERM

import pytest
from program import EXAMPLES, Started, lines, run_example, same_bytes, table, vbond, write

CASE = EXAMPLES / "stem_bending.toml"
DATA = EXAMPLES / "stem_bending.csv"
ALONG = ["--x", "load_factor", "--compare", "displacement.last.z=deflection [mm]"]
VARY = ["--vary", "bonds[fibre].k_n"]


def fit(*more, case=CASE, data=DATA, **options):
    return vbond("fit", case, data, *more, **options)


def found(name):
    return json.loads(Path(f"{name}.json").read_text())


def key(name, path):
    return next(value for value in found(name)["values"] if value["key"] == path)


@pytest.fixture(scope="module")
def fitted(work):
    return fit(*VARY, *ALONG, "-o", "branch.toml")


def test_example(fitted):
    # The points were made with 3.67e10 and a noise of 0.05 mm, twenty of them: their deviation is known to
    # 1/sqrt(2 * 19) = 16 %, three of which are taken.
    run_example("stem_bending")
    k_n = key("branch", "bonds[fibre].k_n")
    assert k_n["interval_95"][0] < 3.67e10 < k_n["interval_95"][1]
    assert abs(found("branch")["residual_deviation"] / 0.05e-3 - 1) < 0.48
    assert k_n["standard_error"] / k_n["value"] < 0.003
    fitted.expect(out=["standard error", "bonds[fibre].k_n = 3.6", "fitted case in branch.toml", "near the start"])
    page = (EXAMPLES / "stem_bending.md").read_text()
    assert f"{k_n['value']:.10g} N/m^3   standard error {k_n['standard_error']:.3g}" in page, "the page has other figures"


def test_fitted_case_is_the_case_with_other_values(fitted):
    changed = [(a, b) for a, b in zip(CASE.read_text().splitlines(), Path("branch.toml").read_text().splitlines(), strict=True) if a != b]
    assert len(changed) == 1 and changed[0][1].startswith('k_n = "3668'), changed
    vbond("run branch.toml -o at_fit")  # gives the fitted curve
    rows = {row["load_factor"]: row["displacement.last.z"] for row in table("at_fit")}
    for point in table("branch.csv"):
        assert rows[point["load_factor"]] == point["fitted"]
        assert abs(point["fitted"] - point["measured"] - point["residual"]) < 1e-17


ROD = """units = {system = "SI"}
specimen = [{kind = "rod", particles = 8, spacing = "2 mm", radius = "0.5 mm", density = 1000}]
[[bonds]]
name = "f"
gap = "2 mm"
theory = "bernoulli-euler"
E = "0.7715 GPa"
nu = 0.3598
section = {shape = "circle", diameter = "1.6237 mm"}
[[stage]]
kind = "equilibrium"
steps = 12
loads = [{group = "last", force = [0.03, 0.02, 0.01], moment = [1e-5, 0, 0]}]
supports = [{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}]
[output]
history = {displacements = ["last"]}
"""


def test_the_edge_of_what_runs_is_no_minimum(work):
    # From here the search runs to nu = -1, beyond which nothing runs. Its steps get so short that it seems to end; with that nu
    # held another diameter gives a third less. The truth is 1.6237 mm and 0.3598.
    vbond("run", write("truth.toml", ROD), *"-o truth".split())
    columns = [f"displacement.last.{c}" for c in "xyz"]
    points = ["load_factor,x,y,z"] + [",".join(str(row[c]) for c in ["load_factor", *columns]) for row in table("truth") if row["load_factor"] > 0]
    write("rod.csv", "\n".join(points) + "\n")
    write("far.toml", ROD, ("1.6237", "1.2642"), ("0.3598", "0.338"))
    compare = [word for c, name in zip(columns, "xyz", strict=True) for word in ("--compare", f"{c}={name}", "--sigma", "1e-9")]
    said = fit("--vary", "bonds[f].section.diameter", "--vary", "bonds[f].nu", "--x", "load_factor", *compare, "-o", "edge.toml",
               case="far.toml", data="rod.csv", status=1)
    said.expect(status=1, out=["the search is held by runs that fail", "without an error"], no_out="This is a minimum")
    assert found("edge")["end"] == "held" and key("edge", "bonds[f].section.diameter")["held_by_failed_runs"]
    assert key("edge", "bonds[f].section.diameter")["standard_error"] is None


def test_rows_that_move_leave_no_errors(work):
    # rows of a path are where its steps are, which go with the stiffness: between them the curve is as rough as they are coarse
    path = [("^kind = .equilibrium.\nsteps = 12", 'kind = "path"')]
    vbond("run", write("rows.toml", ROD, *path), *"-o rows".split())
    points = ["load_factor,x"] + [f"{row['load_factor']},{row['displacement.last.x']}" for row in table("rows") if row["load_factor"] > 0]
    write("rows.csv", "\n".join(points) + "\n")
    write("start.toml", ROD, *path, ("0.7715", "0.67"))
    said = fit("--vary", "bonds[f].E=log", "--x", "load_factor", "--compare", "displacement.last.x=x", "--sigma", "1e-10", "-o", "moved.toml",
               case="start.toml", data="rows.csv")
    said.expect(status=(0, 1), out="no standard errors: differences with two steps say different things")
    assert key("moved", "bonds[f].E")["standard_error"] is None and key("moved", "bonds[f].E")["derivative"] == "unknown"


def test_values_that_are_not_told_apart(work):
    # bending knows k_n d^4 alone, but for shear, which is some 1e-4 of the deflection here
    said = fit("--vary", "bonds[0].k_n=log", "--vary", "bonds[0].k_s=log", "--vary", "stage[bend].loads[0].force[2]", *ALONG,
               "-o", "apart.toml")
    said.expect(out="the points do not tell apart")
    named = found("apart")["not_told_apart"]
    assert named and {"bonds[0].k_n", "stage[bend].loads[0].force[2]"} <= set(named[0]), named
    assert key("apart", "bonds[0].k_n")["standard_error"] is None


def test_bounds_are_told(fitted):
    fit("--vary", "bonds[fibre].k_n=range(1e10, 30 GN/m^3)", *ALONG, "-o", "bound.toml").expect(out="at its upper bound")
    assert key("bound", "bonds[fibre].k_n")["value"] == 3e10 and key("bound", "bonds[fibre].k_n")["at_bound"] == "upper"
    assert 'k_n = "30000000000.0 N/m^3"' in Path("bound.toml").read_text()


def test_sigma(work):
    fit(*VARY, *ALONG, "--sigma", "5e-5", "-o", "sigma.toml").expect(out="of the given standard deviations")
    assert found("sigma")["sigma_known"] and 0.5 < found("sigma")["residual_deviation"] < 1.5


REFUSED = [
    (["--vary", "bonds[fibre].kn"], {}, ["--vary bonds[fibre].kn: the case does not give kn", "did you mean k_n?"]),
    (["--vary", "bonds[fibre].tension"], {}, ["the case does not give tension", "write it into the case"]),
    (["--vary", "bonds[fibre].name"], {}, ["stem_bending.toml:16:1: bonds[fibre].name", "one number"]),
    (["--vary", "bonds[fibre].k_n=range(3e10, 4e10)"], {}, ["must lie within the bounds", "stem_bending.toml:20"]),
    (["--vary", "bonds[fibre].k_n=range(1 mm, )"], {}, ["of another dimension"]),
    (["--vary", "specimen[0].particles"], {}, ["stem_bending.toml:10:1: --vary specimen[0].particles", "whole number", "sweep"]),
    (["--vary", "stage[bend].steps"], {}, ["whole number"]),
    ([*VARY, "--derivatives", "exact"], {}, ["--derivatives"]),
    ([*VARY, "--compare", "displacement.last.x"], {}, ["several columns are compared", "give --sigma for each"]),
    ([*VARY, "--sigma", "1", "--compare", "displacement.last.z=load_factor", "--sigma", "1"], {}, ["is compared already"]),
    ([*VARY, "--sigma", "1", "--compare", "displacement.last.x=deflection [mm]", "--sigma", "1"], {}, ["is compared already"]),
    ([*VARY, "--sigma", ""], {}, ["--sigma is empty"]),
    ([*VARY, "--stage", "pull"], {}, ["the case has no stage of this name", "bend"]),
    ([*VARY, "-o", "here.csv"], {}, ["name it NAME.toml"]),
    (VARY, {"data": "load_factor,deflection [mm]\n"}, ["data.csv:1:1: no row of data"]),
    (VARY, {"data": "load_factor,deflection [mm]\n0.5,9\n0.6,ten\n"}, ['data.csv:3:5: deflection [mm] = "ten"']),
    (VARY, {"data": "note,load_factor,deflection [mm]\n9x,0.5,9x\n"}, ['data.csv:2:8: deflection [mm] = "9x"']),
    (VARY, {"data": "load_factor,deflection [m]\n0.5,9\n"}, ['data.csv:1:1: there is no column "deflection [mm]"', 'did you mean "deflection [m]"?']),
    (VARY, {"data": "load_factor,deflection [mm]\n1.5,9\n"}, ["0 points of 1 lie within the run"]),
]


def test_values_in_triple_quotes_are_refused_at_once(work):
    case = write("triple.toml", CASE.read_text().replace('k_n = "2e10 N/m^3"', 'k_n = """2e10 N/m^3"""'))
    fit(*VARY, *ALONG, "-o", "triple_fit.toml", case=case, status=2,
        err=["triple.toml:20:1: bonds[fibre].k_n", "another value cannot be put in the place", "plain quotes"])
    assert not list(Path().glob("triple_fit*"))


def test_columns_that_nothing_asks_for_are_told(work):
    data = write("more.csv", re.sub(r"^([^#\n]+)$", r"\1,7", DATA.read_text(), flags=re.M).replace("[mm],7", "[mm],room", 1))
    fit(*VARY, *ALONG, "-o", "more_fit.toml", data=data, out="columns of more.csv that nothing asks for: room")


@pytest.mark.parametrize("more, how, told", REFUSED)
def test_refused_with_nothing_written(work, more, how, told):
    before = sorted(Path().iterdir())
    data = write("data.csv", how["data"]) if how else DATA
    fit(*more, *ALONG, data=data, status=2, err=told)
    Path("data.csv").unlink(missing_ok=True)
    assert sorted(Path().iterdir()) == before


def test_units_of_another_dimension(work):
    data = write("force.csv", DATA.read_text().replace("[mm]", "[N]"))
    fit(*VARY, "--x", "load_factor", "--compare", "displacement.last.z=deflection [N]", data=data, status=2,
        err=['force.csv:2:13: column "deflection [N]"', "of another dimension", "give it in [m]"])


def test_threads_give_the_same_bits(fitted):
    vbond("fit --threads 1", CASE, DATA, *VARY, *ALONG, "-o", "one.toml")
    vbond("fit --threads 2", CASE, DATA, *VARY, *ALONG, "-o", "two.toml")
    for end in ("toml", "json", "csv"):
        assert same_bytes(f"one.{end}", f"two.{end}"), end


def test_goes_on_and_replaces_nothing_of_others(fitted):
    first = Path("branch.json").read_bytes()
    again = fit(*VARY, *ALONG, "-o", "branch.toml").expect(out="1 runs, 0 of them failed; 9 known from before")
    assert Path("branch.json").read_bytes() == first, str(again)
    for other in ("bonds[0].k_s", "bonds[fibre].k_n=log", "bonds[fibre].k_n=range(1e10, )"):
        fit("--vary", other, *ALONG, "-o", "branch.toml", status=2, err="has runs of another fit")
    fit(*VARY, *ALONG, "--sigma", "5e-5", "-o", "branch.toml", status=2, err="has runs of another fit")
    Path("branch.runs.csv").rename("kept.csv")
    fit(*VARY, *ALONG, "-o", "branch.toml", status=2, err="branch.toml is there already")
    Path("kept.csv").rename("branch.runs.csv")
    fit(*VARY, *ALONG, "-o", CASE, status=2, err="would be replaced")


def test_signal(work):
    # a fit that goes on for long: dynamics, whose runs take a second each
    slow = write("slow.toml", CASE.read_text(), ("particles = 21", "particles = 200"), ("steps = 20", "steps = 400"))
    with Started("fit", slow, DATA, *VARY, *ALONG, "-o", "stopped.toml") as run:
        run.until(lambda: lines("stopped.runs.csv") >= 4)
        run.stop(SIGTERM).expect(128 + SIGTERM, err="the same command goes on", out="interrupted")
    assert found("stopped")["end"] == "interrupted"
    assert re.search(r'^k_n = "\d', Path("stopped.toml").read_text(), re.M)


def test_failed_runs_are_told(work):
    # spheres that are further apart than at the start do not touch, and have no bonds: one side of the difference fails
    # and far below the spheres overlap too much; where the points would lie, no run is possible
    for scale in ("", "=log"):
        fit("--vary", f"specimen[0].spacing{scale}", *ALONG, "-o", f"failed{scale}.toml", status=1,
            out=["  failed: ", "the search is held by runs that fail", "held by runs that fail, without an error"])
        held = key(f"failed{scale}", "specimen[0].spacing")
        assert found(f"failed{scale}")["failures"] and found(f"failed{scale}")["end"] == "held"
        assert held["value"] < 2 and held["standard_error"] is None and held["held_by_failed_runs"]


def test_ends_after_the_iterations_given(work):
    fit(*VARY, *ALONG, "--iterations", "1", "-o", "few.toml", status=1, out="ended after 1 iterations")
    assert found("few")["end"] == "iterations"


def test_blas_of_statics_is_no_other_than_before(work):
    # Debian's Ceres links ATLAS, whose BLAS would give other bits, and be slower
    said = vbond("--version", env={"LD_BIND_NOW": "1", "LD_DEBUG": "bindings"})
    bound = [line for line in said.err.splitlines() if "symbol `dgemm_'" in line]
    assert bound and all("libopenblas" in line.split(" to ")[1] for line in bound), bound


def test_derivatives_by_tangents_save_runs_and_change_nothing(work):
    both = ["--vary", "bonds[fibre].k_n=log", "--vary", "bonds[0].prestrain=range(-1e-4, 1e-4)"]
    case = write("both.toml", CASE.read_text().replace('k_s = "2e10', 'prestrain = 0.0\nk_s = "3.42e10'))
    runs = {}
    for how in ("automatic", "differences"):
        said = fit(*both, *ALONG, "--derivatives", how, "-o", f"{how}.toml", case=case)
        runs[how] = int(re.search(r"(\d+) runs", said.out)[1])
        assert {value["derivative"] for value in found(how)["values"]} == {"tangent" if how == "automatic" else "differences"}
    assert runs["automatic"] < 0.7 * runs["differences"], runs
    print(runs)
    one, other = (key(how, "bonds[fibre].k_n") for how in runs)
    assert abs(one["value"] / other["value"] - 1) < 1e-6
    assert abs(one["standard_error"] / other["standard_error"] - 1) < 1e-4


def test_says_which_derivatives_are_differences(work):
    fit(*VARY, "--vary", "stage[bend].loads[0].force[2]=log", "--iterations", "2", *ALONG, "-o", "which.toml", status=(0, 1),
        out=["derivatives with stage[bend].loads[0].force[2] by differences: it is no key of bonds",
             "derivatives with bonds[fibre].k_n by the tangents of balances"])
    assert [value["derivative"] for value in found("which")["values"]] == ["tangent", "differences"]
    assert found("which")["values"][0]["off_from_differences"] < 1e-4
    assert found("which")["values"][1]["why_differences"] == "it is no key of bonds"


def test_page(work):
    fit(*VARY, *ALONG, "--report", "-o", "shown.toml", out="report in shown.html")
    text = Path("shown.html").read_text()
    data = json.loads(re.search(r'^<script type="application/json" id="fit">(.*)</script>$', text, re.M)[1])
    written = found("shown")
    assert data["values"] == written["values"] and data["iterations"] == written["iterations"]
    assert data["x"] == "load_factor" and data["units"] == ["m"] and data["stages"] == ["bend"]
    rows = table("shown.csv")
    assert len(data["points"]) == len(rows) == written["points"]
    for point, row in zip(data["points"], rows, strict=True):
        assert [point[name] for name in ("line", "measured", "start", "fitted")] == [row[name] for name in ("line", "measured", "start", "fitted")]
    # nothing of others is replaced
    Path("alone.html").write_text("mine")
    fit(*VARY, *ALONG, "--report", "-o", "alone.toml", status=2, err="alone.html is there already")
    assert Path("alone.html").read_text() == "mine"


def test_runs_with_other_derivatives_are_of_another_fit(work):
    fit(*VARY, *ALONG, "--derivatives", "differences", "--iterations", "1", "-o", "other.toml", status=(0, 1))
    fit(*VARY, *ALONG, "-o", "other.toml", status=2, err=["has runs of another fit", "derivatives"])


def test_page_of_others_beside_runs_stays(work):
    fit(*VARY, *ALONG, "--iterations", "1", "-o", "own.toml", status=(0, 1))
    Path("own.html").write_text("mine")
    fit(*VARY, *ALONG, "--iterations", "1", "--report", "-o", "own.toml", status=2, err="own.html is there already")
    assert Path("own.html").read_text() == "mine"
    Path("own.html").unlink()
    for _ in range(2):  # its own page is replaced
        fit(*VARY, *ALONG, "--iterations", "1", "--report", "-o", "own.toml", status=(0, 1), out="report in own.html")


def test_columns_of_walls_go_by_differences(work):
    # their slopes came out as 0
    wall = ('[contact]\nlaw = "linear"\nk = 0.05\n[[wall]]\nname = "w"\nshape = "plane"\npoint = [0, 2.2, 0]\nnormal = [0, -1, 0]\n')
    case = write("wall.toml", '[units]\nsystem = "reduced"\n[[specimen]]\nname = "rod"\nkind = "rod"\nparticles = 7\nspacing = 1.0\n'
                 'radius = 0.45\nmass = 1.0\n[[bonds]]\nname = "b"\ndistance = 1.1\ntheory = "timoshenko"\nE = 8.0\nnu = 0.2\n'
                 'section = {shape = "circle", diameter = 0.4}\n' + wall + '[[stage]]\nname = "s"\nkind = "equilibrium"\nsteps = 10\n'
                 'supports = [{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}]\n'
                 'loads = [{group = "last", force = [1e-3, 2e-3, 1e-3]}]\n[output]\nhistory = {displacements = ["last"]}\n')
    vbond("run", case, "-o", "walled", "--set", "bonds[b].E=9.0")
    rows = [row for row in table("walled") if row["load_factor"] > 0.05]
    data = write("wall.csv", "load_factor,displacement.last.y,wall.w.Fy\n" + "".join(
        f"{row['load_factor']},{row['displacement.last.y']},{row['wall.w.Fy']}\n" for row in rows))
    fit("--vary", "bonds[b].E", "--x", "load_factor", "--compare", "displacement.last.y", "--sigma", "0.02", "--compare", "wall.w.Fy", "--sigma", "2e-6",
        "-o", "wall_fit.toml", case=case, data=data, out="by differences: wall.w.Fy is a number of a wall")
    assert abs(key("wall_fit", "bonds[b].E")["value"] / 9.0 - 1) < 1e-5


def test_page_that_was_not_built(work):
    fit(*VARY, *ALONG, "--report", "-o", "none.toml", status=3, err="the report page was not built", env={"VBOND_PAGE": "nowhere.html"})
    assert not list(Path().glob("none*"))
