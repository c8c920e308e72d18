#include "vbond/case/keys.hpp"
#include "vbond/case/special_values.hpp"

namespace vbond::keys {
namespace {

/// What cannot go on without single particles.
void check_what_drops(Table& t, const Case& c) {
  const bool drops = c.watch.on_unphysical == OnUnphysical::drop;
  const auto moves = [](const StageSpec& s) { return !is_static(s.kind); };
  const auto motion = std::find_if(c.stages.begin(), c.stages.end(), moves);
  t.check(!drops || std::all_of(motion, c.stages.end(), moves), {"on_unphysical"},
          "a static stage that follows a stage of dynamics looks for a balance with all particles",
          "use on_unphysical = \"stop\", or leave the static stage to another case");
  t.check(!drops || std::none_of(c.bonds.begin(), c.bonds.end(),
                                 [](const BondSpec& b) { return b.recipe.capsule; }),
          {"on_unphysical"}, "bonds touch as capsules, which are not followed through the loss of a particle",
          "use on_unphysical = \"stop\", or leave capsule_radius out");
}

}  // namespace

void default_to_all(Placed<std::string>& group) {
  if (group.value.empty()) group.value = "all";
}

void describe(Table& t, Case& c) {
  t.key("title", c.title, TextCodec{}, optional, "one line for the reader");
  t.table("units", optional, "in which units the numbers of this file are", [&c](Table& u) {
    u.key("system", c.units,
          ChoiceCodec<UnitSystem>{{"reduced", "SI"}, {UnitSystem::reduced, UnitSystem::si}}, optional,
          "reduced: bare numbers, a = m = c_A = 1; SI: m, kg, s, or text with a unit such as \"2 GPa\"");
    u.set_units(c.units);
  });
  t.table("cell", c.cell, "the cell of a body that repeats in space; without it space is open");
  t.tables("specimen", c.specimens, required, "a body of particles; several are numbered one after another");
  t.named_tables("groups", c.groups, "a named set of particles: exactly one of the following");
  t.tables("bonds", c.bonds, optional, "a set of bonds that are made alike");
  t.tables("material", c.materials, optional, "what particles and walls are made of");
  t.tables("wall", c.walls, optional, "a rigid surface that particles touch");
  t.table("contact", optional, "what particles and walls do that touch",
          [&c](Table& k) { describe(k, c.contact, c.contact_between, !c.materials.empty()); });
  t.tables("velocities", c.velocities, optional,
           "initial velocities; without it all particles start at rest");
  t.tables("source", c.sources, optional, "bodies that come in during the run");
  t.tables("sink", c.sinks, optional, "where particles are taken out during the run");
  t.table("time", optional, "the time step", [&c](Table& k) { describe(k, c.time); });
  bool any_unknown = false;
  t.tables("stage", c.stages, required, "the stages of the run, one after another",
           [&](Table& k, StageSpec& s) { any_unknown = !describe(k, s) || any_unknown; });
  t.table("output", optional, "what is written",
          [&](Table& k) { describe(k, c.output, c.any_dynamics() && !any_unknown, c.cell.has_value()); });
  t.table("watch", optional, "when the run is looked at and stopped", [&c](Table& k) {
    describe(k, c.watch);
    check_what_drops(k, c);
  });
}

void describe(Table& t, VelocitySpec& v) {
  t.locate(v.place);
  default_to_all(v.group);
  t.key("group", v.group, group_name, optional, "which particles");
  t.key("kind", v.kind,
        ChoiceCodec<VelocityKind>{{"given", "circle", "ball", "gaussian", "rigid"},
                                  {VelocityKind::given, VelocityKind::circle, VelocityKind::ball,
                                   VelocityKind::gaussian, VelocityKind::rigid}},
        optional,
        "one velocity for all; random: uniform in a circle or ball, or normally distributed; or that of a "
        "rigid body");
  const bool is_random = v.kind != VelocityKind::given && v.kind != VelocityKind::rigid;
  t.when(!is_random, "kind = \"given\" or \"rigid\"", [&] {
    t.key("velocity", v.velocity, vector_of(velocity), optional,
          "of each centre; rigid: of the centre of mass of the group");
    t.key("angular_velocity", v.angular_velocity, vector_of(angular_velocity), optional,
          "of each particle; rigid: and of the group about its centre of mass");
  });
  t.when(is_random, "kind = \"circle\", \"ball\" or \"gaussian\"", [&] {
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
  t.key("step", s.step, StepCodec{}, default_is("automatic"),
        "the time step of dynamics, or less where the times of a stage need it; \"exact\": from the highest "
        "frequency of the body as each stage begins, where automatic takes a bound from single bonds");
  t.when(!s.given(), "no step given, or step = \"exact\"", [&] {
    t.key("fraction", s.fraction, NumberCodec{pure, {0, 1, true, false}}, optional,
          "the step, as a part of the critical one");
  });
  t.when(s.given() != nullptr, "step given as a time", [&] {
    t.key("insist", s.insist, FlagCodec{}, optional,
          "accept a step above the critical one, or one with less than 10 steps in a period of what a "
          "stage moves to and fro");
  });
}

// ---- output ------------------------------------------------------------------------------------

void describe_stress(Table& t, StressSpec& s) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("group", s.group, group_name, optional, "which particles");
  t.key(
      "volume", s.volume, StressVolumeCodec{}, required,
      "that the group takes up, gaps included; \"box\": of the box along x, y, z around its particles at the "
      "start, with their radii, so that the stress in a round group or in a part of a random packing comes "
      "out "
      "too small, as does that in a whole body that is pulled, whose outermost particles carry half: take a "
      "group without them; \"spheres\": of its particles alone, so that the stress in a body with gaps comes "
      "out too "
      "large");
}

void describe(Table& t, OutputSpec& o, bool any_dynamics, bool periodic) {
  t.table("history", optional, "history.csv", [&o](Table& h) {
    h.key("every", o.history_every, TimeCodec{}, optional, "time between rows");
    h.key("reactions", o.reactions, list_of(group_name), optional, "groups: total support force and moment");
    h.key("axial_force", o.axial_force, list_of(group_name), optional,
          "groups: mean tension of the bonds inside");
    h.key("displacements", o.displacements, list_of(ParticlesCodec{}), optional,
          "groups (their mean) or particle numbers: displacement since the start");
    h.key("velocities", o.velocities, list_of(ParticlesCodec{}), optional,
          "groups (their mean) or particle numbers: velocity");
    h.tables("stress", o.stresses, optional, "mean stress and strain of groups",
             [](Table& k, StressSpec& s) { describe_stress(k, s); });
  });
  t.table(
      "frames", optional, "frames for ParaView; none without this table",
      [&](Table& f) {
        if (!o.frames) o.frames.emplace();
        f.key("every", o.frames->every, TimeCodec{},
              any_dynamics ? required : default_is("required if a stage has kind = \"dynamics\""),
              "time between frames; static stages write one at each point, modes and critical loads theirs");
        f.key("precision", o.frames->single_precision,
              ChoiceCodec<bool>{{"float64", "float32"}, {false, true}}, optional,
              "of real numbers; float32: half the size, 7 digits");
        f.key("compression", o.frames->compressed, ChoiceCodec<bool>{{"zlib", "none"}, {true, false}},
              optional, "of the arrays; none: as they lie in memory");
        f.key("stress", o.frames->stress, FlagCodec{}, optional,
              "the stress of each particle, in its volume as a sphere");
        f.key("contacts", o.frames->contacts, FlagCodec{}, optional,
              "a file for all contacts, too: who touches whom or which wall, overlap, forces, slip");
        f.key(
            "wrap", o.frames->wrap, FlagCodec{}, optional,
            "particles of a periodic body are shown in its cell; without it they stand where they have gone");
        f.check(periodic || !o.frames->wrap, {"wrap"},
                "the case has no cell that particles could be brought into",
                "leave it out, or add a table [cell]");
      },
      o.frames.has_value());
  t.key("lammps_dump", o.lammps_dump, FlagCodec{}, optional, "with each frame also a LAMMPS dump, for OVITO");
  t.check(!o.lammps_dump || o.frames, {"lammps_dump", "frames"}, "needs frames: it is written with them",
          "add frames = { every = \"10 T0\" }");
  t.table(
      "checkpoint", optional,
      "checkpoint.h5 at intervals; without this table at the end, on a signal, and each minute of a stage of "
      "fracture",
      [&o](Table& k) {
        k.key("every", o.checkpoint_every, TimeCodec{}, required,
              "time between checkpoints; a balance of a stage of fracture counts T_0, or 1 without dynamics");
      },
      o.checkpoint_every.has_value());
}

void describe(Table& t, WatchSpec& w) {
  t.key("every", w.every, CountCodec{1, INT64_C(1'000'000'000)}, optional,
        "steps between looks at bonds and energy");
  t.key("energy_error", w.energy_error, positive(pure), optional,
        "relative error of the energy balance at which the run stops");
  t.key("overlap", w.overlap, not_negative(pure), optional,
        "part of the smaller radius; particles without a bond that overlap by more than at the start and "
        "this are reported, and a run ends where contacts let two pass; 0: never");
  t.key("on_unphysical", w.on_unphysical,
        ChoiceCodec<OnUnphysical>{{"stop", "drop"}, {OnUnphysical::stop, OnUnphysical::drop}}, optional,
        "if particles have passed through one another or a wall, or turn by more than half a turn in a step: "
        "the run stops, or goes on without them");
}

}  // namespace vbond::keys
