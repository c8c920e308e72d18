#include <algorithm>

#include "vbond/case/keys.hpp"
#include "vbond/case/special_values.hpp"

namespace vbond::keys {
namespace {

constexpr CountCodec at_least_one{1, 1'000'000};

bool any(const Vec3d& v) {
  return !(v == Vec3d{});
}

void describe_load_factor_stop(Table& t, PathSettings& p) {
  t.key("above", p.above, number(pure), optional, "end where the load factor rises to this");
  t.key("below", p.below, number(pure), optional, "end where the load factor falls to this");
  t.check(p.above || p.below, {"above", "below"}, "must have above, below or both", "add above = 1.0");
}

void describe_fracture_stop(Table& t, FractureSettings& f) {
  t.table(
      "load_factor", optional, "stop at a load factor",
      [&f](Table& k) {
        k.key("above", f.end, positive(pure), required, "end where the load factor rises to this");
      },
      f.end != FractureSettings{}.end);
  t.key("load_drop", f.load_drop, NumberCodec{pure, {0, 1, true, false}}, optional,
        "end when this part of the peak load is lost; the load is the reaction of the first support that "
        "moves, along its motion, or the load factor");
}

void describe_stop(Table& t, StageSpec& s) {
  const bool dynamics = s.kind == StageKind::dynamics;
  t.when(s.kind != StageKind::fracture, "kind = \"dynamics\" or \"path\"",
         [&] { t.table("distance", s.stop_distance, "stop when two particles are near or far enough"); });
  t.when(dynamics, in_dynamics, [&] {
    t.table("peak", s.stop_peak,
            "stop when a quantity has fallen below its peak: buckling, load drop; the first peak counts, "
            "also that of a first touch, if it is not below `above`");
    t.table("rest", s.stop_rest, "stop when the body has come to rest");
  });
  t.when(dynamics || s.kind == StageKind::fracture, "kind = \"dynamics\" or \"fracture\"",
         [&] { t.table("breaks", s.stop_breaks, "stop when bonds have broken"); });
  t.when(s.kind == StageKind::fracture, "kind = \"fracture\"",
         [&] { describe_fracture_stop(t, s.fracture); });
  t.when(s.kind == StageKind::path, "kind = \"path\"", [&] {
    t.table(
        "load_factor", optional, "stop at a load factor",
        [&s](Table& k) { describe_load_factor_stop(k, s.path); }, s.path.above || s.path.below);
  });
}

void describe_motion(Table& t, StageSpec& s) {
  t.key("duration", s.duration, TimeCodec{}, required, "the longest that the stage may take");
  t.table("damping", optional, "damping of all particles", [&s](Table& d) {
    d.key("translation", s.b_translation, not_negative(damping), optional, "b of the force -b v");
    d.key("rotation", s.b_rotation, not_negative(rotary_damping), optional, "b of the moment -b omega");
    d.key(
        "local", s.local_damping, NumberCodec{pure, {0, 1, false, true}}, optional,
        "Cundall's local damping, not physical: this part of the load left on a particle opposes its motion");
  });
  const auto is_free = [](const SupportSpec& p) { return p.rigid && p.held != all_held; };
  t.check(!(s.local_damping > 0.0 && std::any_of(s.supports.begin(), s.supports.end(), is_free)), {"damping"},
          "local damping does not know rigid groups that are free in part",
          "use damping.translation and damping.rotation, or hold all of the group");
}

namespace {
#ifdef VBOND_PETSC
constexpr bool has_multigrid = true;
#else
constexpr bool has_multigrid = false;
#endif

/// Names what has taken the place of a word of former versions.
struct SolverCodec : ChoiceCodec<LinearSolver> {
  bool read(const Node& n, ReadContext& in, const std::string& path, LinearSolver& out) const {
    const auto* word = std::get_if<std::string>(&n.value);
    if (!word || *word != "iterative") return ChoiceCodec::read(n, in, path, out);
    return in.refuse(n, path, "conjugate gradients with an incomplete factor are gone",
                     "use \"multigrid\" of the program vbond-petsc, or \"direct\"");
  }
};
}  // namespace

void describe_newton(Table& t, NewtonSettings& n, StageKind kind) {
  t.key("tolerance", n.tolerance, NumberCodec{pure, {0, 1, true, true}}, optional,
        "largest unbalanced force, as a part of the largest force in the body");
  t.key("iterations", n.iterations, at_least_one, optional, "the most for one load factor");
  t.key("solver", n.solver,
        SolverCodec{{{"automatic", "direct", "multigrid"},
                     {LinearSolver::automatic, LinearSolver::direct, LinearSolver::multigrid}}},
        optional,
        "of the linear equations; multigrid: of the program vbond-petsc, not for fracture; direct: fracture "
        "keeps no factors");
  t.check(has_multigrid || n.solver != LinearSolver::multigrid, {"solver"}, "this program has no multigrid",
          "use solver = \"automatic\", or vbond-petsc, which the preset petsc builds with PETSc");
  t.check(kind != StageKind::fracture || n.solver != LinearSolver::multigrid, {"solver"},
          "fracture needs the factors of the tangent", "use solver = \"automatic\" or \"direct\"");
}

void describe_path(Table& t, PathSettings& p) {
  t.key("first_step", p.first_step, number(pure), optional,
        "change of the load factor in the first step; < 0: downwards");
  t.check(p.first_step != 0, {"first_step"}, "must not be 0: the path would not begin",
          "write for example first_step = 0.01");
  t.table("branch", p.branch, "where the path turns off at a bifurcation; without it, it goes straight on");
}

void describe_walk(Table& t, PathSettings& p) {
  t.key("largest_step", p.largest_step, not_negative(length), default_is("automatic"),
        "longest step, as the largest movement of a particle, its rotation times the mean length of bonds; "
        "0: automatic");
  t.key("most_points", p.most_points, at_least_one, optional, "ends the path in any case");
}

/// Waves of a periodic body, in one of two ways.
void describe_waves(Table& t, StageSpec& s) {
  t.key("wave_vectors", s.wave_vectors, list_of(vector_of(wave_number)), default_is("none"),
        "of a periodic body: wave vectors q, for each of which there are modes or critical loads; what "
        "stands a way w off moves "
        "as exp(i q . w)");
  t.key(
      "wave_phases", s.wave_phases, list_of(vector_of(pure)), default_is("none"),
      "the same by the phase from one cell to the next along a, b and c, in parts of a full turn: 0.5 is the "
      "shortest wave");
  t.check(s.wave_vectors.empty() || s.wave_phases.empty(), {"wave_phases", "wave_vectors"},
          "waves are given in two ways", "keep one of wave_vectors and wave_phases");
}

void describe_modes(Table& t, StageSpec& s) {
  describe_waves(t, s);
  const bool waves = t.reading() && (!s.wave_vectors.empty() || !s.wave_phases.empty());
  if (waves && s.kind == StageKind::buckling && !t.is_given("count")) s.count = 1;
  if (waves && !t.is_given("frames_per_mode")) s.frames_per_mode = 0;
  t.key("count", s.count, at_least_one, default_is("6; buckling with wave vectors 1"),
        "how many critical loads or natural modes; of each wave vector where there are some");
  t.key("frames_per_mode", s.frames_per_mode, CountCodec{0, 1'000'000}, default_is("16; with wave vectors 0"),
        "frames of one swing of each; 0: none");
  t.key("amplitude", s.amplitude, not_negative(length), default_is("a tenth of the body"),
        "of these frames, as the largest movement of a particle; 0: a tenth of the body");
}

bool any_term_grows(const StageSpec& s) {
  bool any = false;
  Terms::for_each([&]<class T>(T) { any |= static_cast<const SpecPart<T>&>(s).grows(); });
  return any;
}

/// Without a proportional part the load factor would change nothing.
void check_proportional(Table& t, const StageSpec& s) {
  const auto grows = [](const LoadSpec& l) {
    return !l.constant && (any(l.force) || any(l.moment) || any(l.total_force) || any(l.total_moment));
  };
  const auto moves = [](const SupportSpec& p) { return any(p.displacement) || any(p.rotation); };
  const bool proportional =
      (any(s.gravity) && !s.constant_gravity) || std::any_of(s.loads.begin(), s.loads.end(), grows) ||
      std::any_of(s.supports.begin(), s.supports.end(), moves) || s.cell.has_value() || any_term_grows(s);
  t.check(proportional,
          {"kind", "loads", "supports", "gravity", "constant_gravity", "temperatures", "pressures"},
          "nothing grows with the load factor: no load, pressure or gravity that is not constant, no support "
          "or wall that "
          "moves, no temperature that changes",
          "add a load without constant = true, or a displacement to a support");
}

void describe_statics(Table& t, StageSpec& s) {
  const bool path = s.kind == StageKind::path;
  t.when(is_static(s.kind), in_statics, [&] {
    t.key("constant_gravity", s.constant_gravity, FlagCodec{}, optional,
          "gravity at full size from the start, not in proportion to the load factor; modes: always");
    t.table("newton", optional, "how far Newton's method goes",
            [&s](Table& n) { describe_newton(n, s.newton, s.kind); });
  });
  const bool fracture = s.kind == StageKind::fracture;
  t.when(s.kind == StageKind::equilibrium || fracture, "kind = \"equilibrium\" or \"fracture\"", [&] {
    t.key("steps", s.steps, at_least_one, optional, "load steps at least; more if they are too large");
  });
  t.when(fracture, "kind = \"fracture\"", [&] {
    t.key("control", s.fracture.control,
          ChoiceCodec<FractureControl>{{"load", "crack"}, {FractureControl::load, FractureControl::crack}},
          optional,
          "while bonds break: loads and supports stay where they are, or go back until one bond alone is at "
          "its strength");
  });
  t.when(s.kind == StageKind::equilibrium, "kind = \"equilibrium\"", [&] {
    t.key("at_saddle", s.at_saddle,
          ChoiceCodec<AtSaddle>{{"leave", "keep"}, {AtSaddle::leave, AtSaddle::keep}}, optional,
          "an unstable balance is left for a stable one, or kept");
  });
  t.when(path, "kind = \"path\"", [&] { describe_path(t, s.path); });
  t.when(path || s.kind == StageKind::buckling, "kind = \"path\" or \"buckling\"",
         [&] { describe_walk(t, s.path); });
  t.when(s.kind == StageKind::buckling, "kind = \"buckling\"", [&] {
    t.key("search_to", s.search_to, not_negative(pure), default_is("automatic"),
          "load factor up to which critical loads are looked for; 0: as far as bonds stay within their law");
  });
  t.when(s.kind == StageKind::buckling || s.kind == StageKind::modes, "kind = \"buckling\" or \"modes\"",
         [&] { describe_modes(t, s); });
  if (path || fracture || s.kind == StageKind::buckling) check_proportional(t, s);
}

std::optional<StageKind> describe_kind(Table& t, StageSpec& s) {
  std::optional<StageKind> kind = s.kind;
  if (t.reading() && t.is_given("kind")) kind.reset();
  t.key("kind", kind,
        ChoiceCodec<StageKind>{{"dynamics", "equilibrium", "path", "buckling", "modes", "fracture"},
                               {StageKind::dynamics, StageKind::equilibrium, StageKind::path,
                                StageKind::buckling, StageKind::modes, StageKind::fracture}},
        optional,
        "motion in time, or static: balance under load, its path as the load changes, the loads at which it "
        "becomes unstable, small vibrations about it, bonds that break one by one");
  s.kind = kind.value_or(StageKind::dynamics);
  return kind;
}

}  // namespace

bool describe(Table& t, StageSpec& s) {
  t.locate(s.place);
  t.key("name", s.name, NameCodec{}, default_is("`\"stage-1\"`, `\"stage-2\"`, ..."), "name of the stage");
  const std::optional<StageKind> kind = describe_kind(t, s);
  t.key("gravity", s.gravity, vector_of(acceleration), optional, "acceleration of all particles");
  t.tables("supports", s.supports, optional, "degrees of freedom that are held or moved",
           [kind](Table& k, SupportSpec& support) { describe(k, support, kind); });
  t.tables("loads", s.loads, optional, "forces and moments on the particles of a group",
           [kind](Table& k, LoadSpec& load) { describe(k, load, kind); });
  describe_terms(t, s, kind);
  const bool breaks = kind == StageKind::fracture;
  t.when(!kind || kind != StageKind::modes, "every kind but \"modes\"", [&] {
    t.table(
        "cell", optional, "how the cell moves; components that are not named stay as they are",
        [&s, kind](Table& k) { describe_drive(k, s.cell ? *s.cell : s.cell.emplace(), kind); },
        s.cell.has_value());
  });
  t.when(kind == StageKind::dynamics, in_dynamics, [&] { describe_motion(t, s); });
  describe_statics(t, s);
  t.when(kind == StageKind::dynamics || kind == StageKind::path || breaks,
         "kind = \"dynamics\", \"path\" or \"fracture\"", [&] {
           t.table(
               "stop", optional,
               "ends the stage early; a path without it ends at load factor 1 (-1 if it goes down), fracture "
               "without stop.load_factor at 1",
               [&s](Table& k) { describe_stop(k, s); },
               s.stop_distance || s.stop_peak || s.stop_rest || s.stop_breaks || s.path.above ||
                   s.path.below || breaks);
         });
  if (t.reading() && kind == StageKind::path && !s.stop_distance && !s.path.above && !s.path.below)
    (s.path.first_step > 0 ? s.path.above : s.path.below) = s.path.first_step > 0 ? 1.0 : -1.0;
  return kind.has_value();
}

void describe(Table& t, TimeFunctionSpec& f) {
  std::optional<CaseTime> ramp;
  t.key("ramp", ramp, TimeCodec{}, default_is("none"),
        "factor rising from 0 to 1 over this time of the stage");
  t.key("table", f.points, TimeTableCodec{}, default_is("factor 1"),
        "factor over the time of the stage: straight between the points, constant outside");
  t.check(!(t.is_given("ramp") && t.is_given("table")), {"table", "ramp"},
          "only one of ramp and table may be given", "keep one; ramp = T is table = [[0, 0], [T, 1]]");
  if (ramp && f.points.empty()) f.points = {{CaseTime{0, ramp->in_T_0}, 0.0}, {*ramp, 1.0}};
}

void describe(Table& t, BranchSwitch& b) {
  t.key("bifurcation", b.bifurcation, at_least_one, optional, "which one on the path, from 1");
  t.key("mode", b.mode, at_least_one, optional,
        "which of several modes that become unstable at once, from 1");
  t.key("sense", b.sense, ChoiceCodec<double>{{"+", "-"}, {1.0, -1.0}}, optional, "which way along the mode");
}

}  // namespace vbond::keys
