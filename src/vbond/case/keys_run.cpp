#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

void default_to_all(Placed<std::string>& group) {
  if (group.value.empty()) group.value = "all";
}

/// A velocity on a degree of freedom that is not held would be lost without a word.
void check_moves_are_held(Table& t, const SupportSpec& s) {
  const auto unheld = [&s](const Vec3d& v, std::size_t first) {
    return (v.x != 0 && !s.held[first]) || (v.y != 0 && !s.held[first + 1]) ||
           (v.z != 0 && !s.held[first + 2]);
  };
  t.check(!unheld(s.velocity, 0), {"velocity", "fix"}, "a component along a direction that fix does not hold",
          "add the direction (\"x\", \"y\", \"z\") to fix, or set the component to 0");
  t.check(!unheld(s.angular_velocity, 3), {"angular_velocity", "fix"},
          "a component about an axis that fix does not hold",
          "add the axis (\"rx\", \"ry\", \"rz\") to fix, or set the component to 0");
}

void describe_stop(Table& t, StageSpec& s) {
  t.table("distance", s.stop_distance, "stop when two particles are near or far enough");
  t.table("peak", s.stop_peak, "stop when a quantity has fallen below its peak: buckling");
  t.table("rest", s.stop_rest, "stop when the body has come to rest");
}

}  // namespace

void describe(Table& t, Case& c) {
  t.key("title", c.title, TextCodec{}, optional, "one line for the reader");
  t.table("units", optional, "in which units the numbers of this file are", [&c](Table& u) {
    u.key("system", c.units,
          ChoiceCodec<UnitSystem>{{"reduced", "SI"}, {UnitSystem::reduced, UnitSystem::si}}, optional,
          "reduced: bare numbers, a = m = c_A = 1; SI: m, kg, s, or text with a unit such as \"2 GPa\"");
    u.set_units(c.units);
  });
  t.tables("specimen", c.specimens, required, "a body of particles; several are numbered one after another");
  t.named_tables("groups", c.groups, "a named set of particles: exactly one of the following");
  t.tables("bonds", c.bonds, optional, "a set of bonds that are made alike");
  t.table("contact", optional, "repulsion of particles that overlap",
          [&c](Table& k) { describe(k, c.contact); });
  t.tables("velocities", c.velocities, optional,
           "initial velocities; without it all particles start at rest");
  t.table("time", optional, "the time step", [&c](Table& k) { describe(k, c.time); });
  t.tables("stage", c.stages, required, "the stages of the run, one after another");
  t.table("output", optional, "what is written", [&c](Table& k) { describe(k, c.output); });
  t.table("watch", optional, "when the run is looked at and stopped",
          [&c](Table& k) { describe(k, c.watch); });
}

void describe(Table& t, VelocitySpec& v) {
  t.locate(v.place);
  default_to_all(v.group);
  t.key("group", v.group, group_name, optional, "which particles");
  t.key("kind", v.kind,
        ChoiceCodec<VelocityKind>{
            {"given", "circle", "ball", "gaussian"},
            {VelocityKind::given, VelocityKind::circle, VelocityKind::ball, VelocityKind::gaussian}},
        optional, "one velocity for all, or random: uniform in a circle or ball, or normally distributed");
  t.when(v.kind == VelocityKind::given, "kind = \"given\"", [&] {
    t.key("velocity", v.velocity, vector_of(velocity), optional, "of the centres");
    t.key("angular_velocity", v.angular_velocity, vector_of(angular_velocity), optional,
          "about the own centres");
  });
  t.when(v.kind != VelocityKind::given, "kind = \"circle\", \"ball\" or \"gaussian\"", [&] {
    t.key("magnitude", v.magnitude, not_negative(velocity), required,
          "radius of the circle or ball; gaussian: standard deviation of each component");
    t.key("zero", v.zero, SubsetCodec<3>{{"x", "y", "z"}}, optional,
          "components that are set to zero afterwards");
    t.key("seed", v.seed, seed_number, optional, "of the random numbers");
  });
  t.when(v.kind == VelocityKind::circle, "kind = \"circle\"",
         [&] { t.key("normal", v.normal, direction_vector, optional, "normal to the plane of the circle"); });
}

void describe(Table& t, TimeSpec& s) {
  t.key("step", s.step, TimeCodec{}, default_is("automatic"), "the time step");
  t.when(!s.step, "no step given", [&] {
    t.key("fraction", s.fraction, NumberCodec{pure, {0, 1, true, false}}, optional,
          "the automatic step, as a part of the critical one");
  });
  t.when(s.step.has_value(), "step",
         [&] { t.key("insist", s.insist, FlagCodec{}, optional, "accept a step above the critical one"); });
}

// ---- stages ------------------------------------------------------------------------------------

void describe(Table& t, StageSpec& s) {
  t.locate(s.place);
  t.key("name", s.name, NameCodec{}, default_is("`\"stage-1\"`, `\"stage-2\"`, ..."), "name of the stage");
  t.key("duration", s.duration, TimeCodec{}, required, "the longest that the stage may take");
  t.key("gravity", s.gravity, vector_of(acceleration), optional, "acceleration of all particles");
  t.table("damping", optional, "viscous damping of all particles", [&s](Table& d) {
    d.key("translation", s.b_translation, not_negative(damping), optional, "b of the force -b v");
    d.key("rotation", s.b_rotation, not_negative(rotary_damping), optional, "b of the moment -b omega");
  });
  t.tables("supports", s.supports, optional, "degrees of freedom that are held or moved");
  t.tables("loads", s.loads, optional, "forces and moments on each particle of a group");
  t.table("strain", s.strain, "affine strain, applied step by step");
  t.table(
      "stop", optional, "ends the stage before its duration", [&s](Table& k) { describe_stop(k, s); },
      s.stop_distance || s.stop_peak || s.stop_rest);
}

void describe(Table& t, SupportSpec& s) {
  t.locate(s.place);
  t.key("group", s.group, group_name, required, "which particles");
  t.key("fix", s.held, SubsetCodec<6>{{"x", "y", "z", "rx", "ry", "rz"}}, required,
        "which degrees of freedom are held: translation along, rotation about the world's axes");
  t.check(s.held != HeldDofs{}, {"fix"}, "must hold something", "name a direction, as in fix = [\"x\"]");
  t.key("velocity", s.velocity, vector_of(velocity), optional, "of the held translations");
  t.key("angular_velocity", s.angular_velocity, vector_of(angular_velocity), optional,
        "of the held rotations");
  describe(t, s.factor);
  check_moves_are_held(t, s);
}

void describe(Table& t, LoadSpec& s) {
  t.locate(s.place);
  t.key("group", s.group, group_name, required, "which particles");
  t.key("force", s.force, vector_of(force), optional, "on each particle, fixed in direction");
  t.key("moment", s.moment, vector_of(moment), optional, "on each particle, fixed in direction");
  describe(t, s.factor);
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

void describe(Table& t, StrainSpec& s) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("group", s.group, group_name, optional, "which particles");
  t.key("increment", s.increment, NumberCodec{pure, {-1, largest_number, true, false}}, required,
        "strain of each application, < 0 for compression");
  t.check(s.increment != 0, {"increment"}, "must not be 0: nothing would be strained", "leave strain out");
  t.key("direction", s.direction, direction_vector, optional, "along which; its length does not matter");
  t.key("every", s.every, TimeCodec{}, required, "time between applications");
}

void describe(Table& t, DistanceStopSpec& s) {
  t.locate(s.place);
  t.key("between", s.between, tuple_of<2>(particle_number), required, "numbers of the two particles");
  t.check(s.between[0] != s.between[1], {"between"}, "must be two different particles", "change one number");
  const std::size_t side = t.exactly_one({"below", "above"}, s.below ? 0 : 1);
  t.when(side == 0, "below",
         [&] { t.key("below", s.value, positive(length), required, "stop at this or less"); });
  t.when(side == 1, "above",
         [&] { t.key("above", s.value, positive(length), required, "stop at this or more"); });
  s.below = side == 0;
}

void describe(Table& t, RestStopSpec& s) {
  t.locate(s.place);
  t.key("kinetic_energy_below", s.kinetic_energy_below, positive(energy), required,
        "the kinetic energy must stay below this");
  t.key(
      "during", s.during, TimeCodec{}, required,
      "for this time: longer than half the slowest period, since a swing has no kinetic energy at its turns");
}

void describe(Table& t, PeakStopSpec& s) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("quantity", s.quantity,
        ChoiceCodec<PeakQuantity>{{"compressive-force", "reaction"},
                                  {PeakQuantity::compressive_force, PeakQuantity::reaction}},
        optional, "mean compression of the bonds in the group, or its total support force");
  t.key("group", s.group, group_name, optional, "of which particles");
  t.when(s.quantity == PeakQuantity::reaction, "quantity = \"reaction\"", [&] {
    t.key("direction", s.direction, direction_vector, optional, "component of the support force");
  });
  t.key("drop", s.drop, NumberCodec{pure, {0, 1, true, true}}, optional,
        "part of the peak that must be lost");
  t.key("average_over", s.average_over, TimeCodec{}, required,
        "the quantity is averaged over blocks of this time");
}

// ---- output ------------------------------------------------------------------------------------

void describe(Table& t, OutputSpec& o) {
  t.table("history", optional, "history.csv", [&o](Table& h) {
    h.key("every", o.history_every, TimeCodec{}, optional, "time between rows");
    h.key("reactions", o.reactions, list_of(group_name), optional, "groups: total support force and moment");
    h.key("axial_force", o.axial_force, list_of(group_name), optional,
          "groups: mean tension of the bonds inside");
    h.key("displacements", o.displacements, list_of(ParticlesCodec{}), optional,
          "groups (their mean) or particle numbers: displacement since the start");
  });
  t.table(
      "frames", optional, "frames for ParaView; none without this table",
      [&o](Table& f) { f.key("every", o.frames_every, TimeCodec{}, required, "time between frames"); },
      o.frames_every.has_value());
  t.key("lammps_dump", o.lammps_dump, FlagCodec{}, optional, "with each frame also a LAMMPS dump, for OVITO");
  t.check(!o.lammps_dump || o.frames_every, {"lammps_dump", "frames"},
          "needs frames: it is written with them", "add frames = { every = \"10 T0\" }");
  t.table(
      "checkpoint", optional,
      "checkpoint.h5 at intervals; without this table at the end and on a signal only",
      [&o](Table& k) {
        k.key("every", o.checkpoint_every, TimeCodec{}, required, "time between checkpoints");
      },
      o.checkpoint_every.has_value());
}

void describe(Table& t, WatchSpec& w) {
  t.key("every", w.every, CountCodec{1, INT64_C(1'000'000'000)}, optional,
        "steps between looks at bonds and energy");
  t.key("energy_error", w.energy_error, positive(pure), optional,
        "relative error of the energy balance at which the run stops");
}

}  // namespace vbond::keys
