#include <pybind11/stl.h>

#include <numbers>
#include <string>

#include "bindings.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/run/run.hpp"

namespace vbond::python {
namespace {

/// Of critical loads and special points there are these two.
const char* in_words(PointKind kind) {
  return kind == PointKind::limit_point ? "limit point" : "bifurcation";
}

/// A column of the breaks: one value of each.
template <class Value>
py::array column(const std::vector<BrokenBond>& breaks, Value value) {
  std::vector<decltype(value(BrokenBond{}))> values;
  values.reserve(breaks.size());
  for (const BrokenBond& b : breaks) values.push_back(value(b));
  return copy(values);
}

void bind_modes(py::module_& m) {
  constexpr const char* of_a_wave =
      "Of a stage with wave vectors: its number in StaticResult.waves, from 1; else 0";
  constexpr const char* out_of_phase = "A quarter of a turn behind, of a wave, (n, 3); (0, 3): nothing is";
  py::class_<CriticalLoad>(m, "CriticalLoad", "A load at which one more direction becomes unstable.")
      .def_property_readonly(
          "kind", [](const CriticalLoad& c) { return in_words(c.kind); }, "'bifurcation' or 'limit point'")
      .def_readonly("load_factor", &CriticalLoad::load_factor)
      .def_readonly(
          "force", &CriticalLoad::force,
          "Load factor times the largest proportional force on a whole group; 0 if there is none [force]")
      .def_readonly(
          "displacement", &CriticalLoad::displacement,
          "Of the first support that moves; of one that only turns its angle; None: none moves [length]")
      .def_readonly("reaction", &CriticalLoad::reaction,
                    "On that support along its way, positive if it pushes; None: none moves [force]")
      .def_readonly("estimate", &CriticalLoad::estimate,
                    "Load factor by linear buckling analysis about zero load; None where that does not hold")
      .def_readonly("gap", &CriticalLoad::gap, "The load factor is known to about this; 0: exactly")
      .def_property_readonly(
          "translation", [](const CriticalLoad& c) { return copy(c.mode.translation.values()); },
          "Of the mode, the largest is 1, (n, 3) [length]")
      .def_property_readonly(
          "rotation", [](const CriticalLoad& c) { return copy(c.mode.rotation.values()); }, "(n, 3) [rad]")
      .def_readonly("wave", &CriticalLoad::wave, of_a_wave)
      .def_property_readonly(
          "translation_out_of_phase",
          [](const CriticalLoad& c) { return copy(c.out_of_phase.translation.values()); }, out_of_phase)
      .def_property_readonly(
          "rotation_out_of_phase",
          [](const CriticalLoad& c) { return copy(c.out_of_phase.rotation.values()); }, out_of_phase);
  py::class_<NaturalMode>(m, "NaturalMode", "A mode of vibration about an equilibrium.")
      .def_readonly("omega", &NaturalMode::omega, "Angular frequency; 0 of an unstable mode [rad/time]")
      .def_readonly("omega2", &NaturalMode::omega2, "Its square; negative: unstable")
      .def_property_readonly(
          "frequency", [](const NaturalMode& n) { return n.omega / (2 * std::numbers::pi); }, "[1/time]")
      .def_readonly("rigid", &NaturalMode::rigid, "Motion of a part of the body that nothing holds")
      .def_property_readonly(
          "translation", [](const NaturalMode& n) { return copy(n.shape.translation.values()); },
          "The largest is 1, (n, 3) [length]")
      .def_property_readonly(
          "rotation", [](const NaturalMode& n) { return copy(n.shape.rotation.values()); }, "(n, 3) [rad]")
      .def_readonly("wave", &NaturalMode::wave, of_a_wave)
      .def_property_readonly(
          "translation_out_of_phase",
          [](const NaturalMode& n) { return copy(n.out_of_phase.translation.values()); }, out_of_phase)
      .def_property_readonly(
          "rotation_out_of_phase",
          [](const NaturalMode& n) { return copy(n.out_of_phase.rotation.values()); }, out_of_phase);
  py::class_<SpecialPoint>(m, "SpecialPoint", "A limit point or bifurcation of a path.")
      .def_property_readonly(
          "kind", [](const SpecialPoint& p) { return in_words(p.kind); }, "'limit point' or 'bifurcation'")
      .def_readonly("load_factor", &SpecialPoint::load_factor)
      .def_readonly("point", &SpecialPoint::point, "Number of the point on the path, from 1")
      .def_readonly("unstable_before", &SpecialPoint::unstable_before, "Unstable directions; None: not known")
      .def_readonly("unstable_after", &SpecialPoint::unstable_after)
      .def_readonly("gap", &SpecialPoint::gap);
}

py::dict breaks_of(const FractureResult& f) {
  const auto& all = f.breaks;
  py::dict d;
  d["bond"] = column(all, [](const BrokenBond& b) { return std::int64_t{b.use.bond.value}; });
  d["i"] = column(all, [](const BrokenBond& b) { return std::int64_t{b.use.i.value}; });
  d["j"] = column(all, [](const BrokenBond& b) { return std::int64_t{b.use.j.value}; });
  d["avalanche"] = column(all, [](const BrokenBond& b) { return std::int64_t{b.avalanche}; });
  d["load"] = column(all, [](const BrokenBond& b) { return b.load; });
  d["load_factor"] = column(all, [](const BrokenBond& b) { return b.use.load_factor; });
  d["axial_force"] = column(all, [](const BrokenBond& b) { return b.section.N; });
  d["shear_force"] = column(all, [](const BrokenBond& b) { return b.section.V; });
  d["bending_moment"] = column(all, [](const BrokenBond& b) { return b.section.M_b; });
  d["torque"] = column(all, [](const BrokenBond& b) { return b.section.M_t; });
  d["released"] = column(all, [](const BrokenBond& b) { return b.released; });
  d["middle"] = column(all, [](const BrokenBond& b) { return b.middle; });
  return d;
}

}  // namespace

void bind_results(py::module_& m) {
  bind_modes(m);
  py::class_<FractureBooks>(m, "FractureEnergy",
                            "initial + work = stored + dissipated + released, to `error` of the largest.")
      .def_readonly("initial", &FractureBooks::initial, "[energy]")
      .def_readonly("work", &FractureBooks::work, "Of loads and supports [energy]")
      .def_readonly("stored", &FractureBooks::stored, "[energy]")
      .def_readonly("dissipated", &FractureBooks::dissipated, "[energy]")
      .def_readonly("released", &FractureBooks::released, "[energy]")
      .def_property_readonly("error", &FractureBooks::error, "What is missing, as a part of the largest");
  py::class_<FractureResult>(m, "FractureResult", "What a stage of fracture at rest has found.")
      .def_readonly("reason", &FractureResult::reason)
      .def_readonly("avalanches", &FractureResult::avalanches)
      .def_readonly("peak_load", &FractureResult::peak_load)
      .def_readonly("peak_load_factor", &FractureResult::peak_load_factor)
      .def_readonly("energy", &FractureResult::books)
      .def_property_readonly(
          "breaks", &breaks_of,
          "Columns of the bonds that broke, in order, as a dict of arrays: bond, i, j, avalanche, "
          "load, load_factor, axial_force, shear_force, bending_moment, torque, released, middle");
  py::class_<StaticResult>(m, "StaticResult", "What a static stage has found; see docs/output.md, run.json.")
      .def_readonly("ended", &StaticResult::ended, "'converged', 'load factor', 'limit point', ...")
      .def_readonly("load_factor", &StaticResult::load_factor, "Reached")
      .def_readonly("points", &StaticResult::points)
      .def_readonly("iterations", &StaticResult::iterations, "Of Newton's method")
      .def_readonly("residuals", &StaticResult::residuals, "Of the last load step, iteration by iteration")
      .def_readonly("unstable", &StaticResult::unstable, "Unstable directions at the end; None: not counted")
      .def_readonly("neutral", &StaticResult::neutral)
      .def_readonly("free_turns", &StaticResult::free_turns, "Of particles at the end: nothing turns them")
      .def_readonly("jumped", &StaticResult::jumped)
      .def_readonly("left_saddle", &StaticResult::left_saddle)
      .def_readonly("smallest_eigenvalue", &StaticResult::smallest_eigenvalue)
      .def_readonly("special_points", &StaticResult::special_points)
      .def_readonly("critical_loads", &StaticResult::critical_loads)
      .def_readonly("searched_to", &StaticResult::searched_to)
      .def_readonly("modes", &StaticResult::modes)
      .def_property_readonly(
          "waves",
          [](const StaticResult& r) {
            std::vector<Vec3d> q;
            for (const Wave& w : r.waves) q.push_back(w.q);
            return copy(q);
          },
          "The wave vectors of the stage, (waves, 3) [rad/length]")
      .def_readonly("fracture", &StaticResult::fracture);
  py::class_<StageResult>(m, "StageResult", "How a stage went.")
      .def_readonly("name", &StageResult::name)
      .def_property_readonly("kind", [](const StageResult& r) { return to_text(r.kind); })
      .def_property_readonly(
          "stop", [](const StageResult& r) { return r.statics ? r.statics->ended.c_str() : to_text(r.stop); },
          "Why it ended: 'duration', 'peak', ...; of a static stage as StaticResult.ended")
      .def_readonly("steps", &StageResult::steps, "Made in it; of a static one points of equilibrium")
      .def_readonly("time", &StageResult::time, "Of the run at its end [time]")
      .def_property_readonly(
          "critical_force",
          [](const StageResult& r) {
            return r.stop == StopReason::peak ? std::optional(r.peak.peak) : std::nullopt;
          },
          "The peak, if the stage stopped at one; else None [force]")
      .def_readonly("statics", &StageResult::statics, "StaticResult; None of dynamics")
      .def_readonly("failure", &StageResult::failure, "What went wrong; empty: nothing")
      .def("__repr__", [](const StageResult& r) {
        return "<vbond.StageResult: " + r.name + ", " + to_text(r.kind) + ", " +
               (r.statics ? r.statics->ended : std::string(to_text(r.stop))) + ">";
      });
}

}  // namespace vbond::python
