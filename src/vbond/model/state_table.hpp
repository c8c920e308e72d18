#pragma once
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "vbond/core/members.hpp"
#include "vbond/model/field_table.hpp"
#include "vbond/model/state.hpp"

/// State, declared once. A new field is a member of State and an entry here, or both in the folder of a term
/// (terms/NAME/term_NAME.hpp); without the entry nothing compiles. What follows from it: data sets of
/// checkpoints with their attributes and the table of docs/output.md (observe/), sizes and numbers that are
/// checked (mistakes_in), memory estimates, what parts of a body tell each other (dynamics/gather.hpp), what
/// is cleared when, the arrays of Python.
namespace vbond {

template <class Value>
constexpr MemberOfFew<Bond, RareOfBond, Value> rare(Value RareOfBond::*member) {
  return {&Bond::rare, member};
}

/// Those of the terms have a place of their own among the others, so that files stay as they are.
inline constexpr auto tables_before_terms = std::tuple{
    fields_of("/clock/", &State::clock,
              field("step", &Clock::step, unit::none, "steps since the start of the run"),
              field("stage_step", &Clock::stage_step, unit::none, "steps since the start of this stage"),
              field("stage", &Clock::stage, unit::none, "index of the stage, from 0"),
              field("stage_start", &Clock::stage_start, unit::time, "time at which this stage began"),
              field("dt", &Clock::dt, unit::time, "time step")),
    fields_of<State>(
        "/particles/",
        field("r", &State::r, unit::length, "positions of the centres",
              {.known = Known::by_owner, .word = "positions"}),
        field("v", &State::v, unit::velocity, "velocities of the centres",
              {.known = Known::by_owner, .anew = Anew::at_rest, .word = "velocities"}),
        field("q", &State::q, unit::none,
              "orientations, quaternions w, x, y, z that turn body vectors into the world",
              {.known = Known::by_owner, .word = "orientations"}),
        field("omega", &State::omega, unit::angular_velocity, "angular velocities, world frame",
              {.known = Known::by_owner, .anew = Anew::at_rest, .word = "angular_velocities"}),
        field("spin", &State::spin, unit::angular_momentum,
              "angular momenta of the rotation of particles whose moments of inertia differ; only if there "
              "are such",
              {.known = Known::by_owner, .anew = Anew::at_rest, .filed = Filed::where_any}),
        field("temperature", &State::temperature, unit::none,
              "of particles, in the unit of 1/expansion; only where some are heated",
              {.filed = Filed::where_any, .word = "temperatures"}),
        field("came_at", &State::came_at, unit::length,
              "where particles stood as they came in from a source, or at the start; only where some came in",
              {.filed = Filed::where_any})),
    rows_of(
        "/bonds/", &State::bonds, {}, field("i", &Bond::i, unit::none, "number of the first particle"),
        field("j", &Bond::j, unit::none, "number of the second particle"),
        field("law", &Bond::law, unit::none, "number of the bond's law among these names"),
        field("a", &Bond::a, unit::length, "length at rest"),
        field("R_i", &Bond::R_i, unit::length, "distance of the bonded point from the centre of i"),
        field("R_j", &Bond::R_j, unit::length, "distance of the bonded point from the centre of j"),
        field("coefficients", &Bond::coefficients, unit::none,
              "of the law, in the order and units of its list; the rest zero"),
        field("rules", &Bond::rules, unit::none, "number of the bond's rules among these",
              {.filed = Filed::where_any}),
        field("frame_i", &Bond::frame_i, unit::none,
              "the bond's frame in the body frame of i, quaternion w, x, y, z"),
        field("frame_j", rare(&RareOfBond::frame_j), unit::none,
              "the bond's frame in the body frame of j, quaternion w, x, y, z"),
        field("set", &Bond::set, unit::none, "which bond set of the case made it"),
        field("broken", &Bond::broken, unit::none, "1: it does nothing any more"),
        field("mode", &Bond::mode, unit::none,
              "by what it broke: 0 not, 1 tension, 2 shear, 3 bending, 4 torsion, 5 compression, 6 not "
              "known"),
        field("capsule", rare(&RareOfBond::capsule), unit::length,
              "radius by which the bond touches, 0: not; only where bonds do", {.filed = Filed::where_any}),
        field("image_j", rare(&RareOfBond::image_j), unit::none,
              "which image of j it joins with i, in edges of the cell; only where bonds join images",
              {.filed = Filed::where_any})),
    fields_of<State>("/bonds/", field("history", &State::bond_history, unit::none,
                                      "what the bond remembers, in the order and units of its law; only "
                                      "where bonds remember something",
                                      {.known = Known::by_owner, .filed = Filed::where_any})),
    rows_of(
        "/cell/", &State::cell, {.filed = Filed::where_any},
        field("edges", &CellEdge::along, unit::length, "of the periodic cell; only where there is one"),
        field("rates", &CellEdge::rate, unit::velocity, "how the edges changed in the last step"),
        field("virial", &CellEdge::virial, unit::energy,
              "rows of the volume times the stress after the last step; only where the cell moves",
              {.filed = Filed::where_any}),
        field("damping", &CellEdge::damping, unit::force,
              "sum over images of the edges that they are away times the damping force on them; only where "
              "the cell moves and bonds damp",
              {.filed = Filed::where_any})),
    rows_of("/dropped/", &State::dropped, {.filed = Filed::where_any},
            field("particle", &ParticleId::value, unit::none,
                  "particles that are no longer computed; only if there are any")),
    rows_of("/taken/", &State::taken, {.filed = Filed::where_any},
            field("particle", &ParticleId::value, unit::none,
                  "those of them that sinks took out; only if there are any")),
    rows_of("/waiting/", &State::waiting, {.filed = Filed::where_any},
            field("particle", &ParticleId::value, unit::none,
                  "particles of bodies that have not come in yet; only if there are any")),
    rows_of("/sources/", &State::sources, {.filed = Filed::where_any},
            field("due", &SourceRecord::due, unit::none,
                  "how many bodies of each source are due by now; only where there are sources")),
    fields_of("/mass/", &State::mass,
              field("particles_in", &MassBooks::particles_in, unit::none,
                    "particles that have come in; these and the next five only where some have come or gone",
                    {.filed = Filed::where_any}),
              field("particles_out", &MassBooks::particles_out, unit::none, "particles that sinks took out",
                    {.filed = Filed::where_any}),
              field("mass_in", &MassBooks::mass_in, unit::mass, "their mass", {.filed = Filed::where_any}),
              field("mass_out", &MassBooks::mass_out, unit::mass, "of those that were taken out",
                    {.filed = Filed::where_any}),
              field("momentum_in", &MassBooks::momentum_in, unit::momentum, "that came in with them",
                    {.filed = Filed::where_any}),
              field("momentum_out", &MassBooks::momentum_out, unit::momentum, "that went with them",
                    {.filed = Filed::where_any})),
    rows_of(
        "/warm_bonds/", &State::warm_bonds, {.filed = Filed::where_any},
        field("bond", &WarmBond::bond, unit::none, "numbers of bonds that expand; only if there are such"),
        field("expansion", &WarmBond::expansion, unit::none, "growth of their lengths per temperature"),
        field("a", &WarmBond::a, unit::length, "their lengths at rest at temperature 0"),
        field("R_i", &WarmBond::R_i, unit::length,
              "distances of their bonded points from the centres of i there"),
        field("R_j", &WarmBond::R_j, unit::length,
              "distances of their bonded points from the centres of j there")),
    fields_of(
        "/loads/", &State::loads,
        field("F", &Loads::F, unit::force,
              "forces on the particles; only where they do not follow from positions",
              {.known = Known::by_owner, .filed = Filed::where_any}),
        field("M", &Loads::M, unit::moment, "moments on the particles, about their centres; as /loads/F",
              {.known = Known::by_owner, .filed = Filed::where_any})),
    fields_of("/loads/damping_", &State::damping,
              field("F", &Loads::F, unit::force, "the part of these forces that damps; only where pairs damp",
                    {.known = Known::by_owner, .filed = Filed::where_any}),
              field("M", &Loads::M, unit::moment, "the part of these moments that damps",
                    {.known = Known::by_owner, .filed = Filed::where_any})),
    fields_of("/loads/local_damping_", &State::local_damping,
              field("F", &Loads::F, unit::force,
                    "the part of these forces that is local damping; only where bonds damp as well",
                    {.known = Known::by_owner, .filed = Filed::where_any}),
              field("M", &Loads::M, unit::moment, "the part of these moments that is local damping",
                    {.known = Known::by_owner, .filed = Filed::where_any})),
    rows_of(
        "/contacts/", &State::contact_history, {.known = Known::listed, .filed = Filed::where_any},
        field("i", &PairMemory::i, unit::none,
              "first particles of touching pairs that remember something; only if there are any"),
        field("j", &PairMemory::j, unit::none, "second particles of these pairs"),
        field("history", &PairMemory::history, unit::none,
              "what they remember: force across the contact (3), its radius, the force that damps (3), "
              "stiffness of rolling, moment against rolling (3) and about the normal; on the first "
              "particle"),
        field("kept", &PairMemory::kept, unit::length, "the part of their overlap that they do not feel"),
        field("image_j", &PairMemory::image_j, unit::none,
              "which image of the second particle it is, in edges of the cell; only where some are images",
              {.filed = Filed::where_any})),
    rows_of(
        "/fibres/", &State::fibre_history, {.known = Known::collected, .filed = Filed::where_any},
        field("a_i", &FibreMemory::a_i, unit::none,
              "first place of contacts of capsules, on the axis between this particle and a_j, or at it "
              "if they are the same; only if there are any"),
        field("a_j", &FibreMemory::a_j, unit::none, "the other particle"),
        field("b_i", &FibreMemory::b_i, unit::none, "second place of these contacts, likewise"),
        field("b_j", &FibreMemory::b_j, unit::none, "the other particle"),
        field("s", &FibreMemory::s, unit::none, "where on the axis of the first place, 0 at a_i, 1 at a_j"),
        field("t", &FibreMemory::t, unit::none, "where on the axis of the second place"),
        field("R_a", &FibreMemory::R_a, unit::length, "radius at the first place"),
        field("R_b", &FibreMemory::R_b, unit::length, "radius at the second place"),
        field("normal", &FibreMemory::normal, unit::none, "unit vectors from the first to the second place"),
        field("history", &FibreMemory::history, unit::none,
              "what is remembered of the contact, as /contacts/history"),
        field("image_a_j", &FibreMemory::image_a_j, unit::none,
              "which image of a_j it is, in edges of the cell; this and the next two only where some are "
              "images",
              {.filed = Filed::where_any}),
        field("image_b_i", &FibreMemory::image_b_i, unit::none, "which image of b_i",
              {.filed = Filed::where_any}),
        field("image_b_j", &FibreMemory::image_b_j, unit::none, "which image of b_j",
              {.filed = Filed::where_any})),
};

inline constexpr auto tables_after_terms = std::tuple{
    rows_of(
        "/grips/", &State::grips, {.anew = Anew::at_rest, .filed = Filed::where_any},
        field("pivot", &GripState::pivot, unit::length,
              "of rigid supports as they took hold; only in a stage that has some"),
        field("from", &GripState::from, unit::time, "integral of their factor at that time"),
        field("work", &GripState::work, unit::energy, "that they have done in the stage",
              {.known = Known::summed}),
        field("particles", &GripState::particles, unit::none, "how many each has"),
        field("shift", &GripState::shift, unit::length,
              "of the pivot along what is free, since they took hold; this and the next four only where a "
              "grip that is free in part has moved so",
              {.filed = Filed::where_any}),
        field("turn", &GripState::turn, unit::none, "about what is free, quaternions w, x, y, z",
              {.filed = Filed::where_any}),
        field("velocity", &GripState::velocity, unit::velocity, "of the pivot along what is free",
              {.filed = Filed::where_any}),
        field("spin", &GripState::spin, unit::angular_momentum,
              "angular momentum of free turns about the pivot", {.filed = Filed::where_any}),
        field("angle", &GripState::angle, unit::angle, "turned about the one free axis",
              {.filed = Filed::where_any})),
    rows_of("/gripped/", &State::gripped, {.anew = Anew::at_rest, .filed = Filed::where_any},
            field("arm", &GrippedPose::arm, unit::length,
                  "from the pivot to each of their particles as they took hold"),
            field("q", &GrippedPose::q, unit::none,
                  "orientations of these particles then, quaternions w, x, y, z")),
    rows_of("/carried/", &State::carried, {.filed = Filed::where_any},
            field("particle", &Carried::particle, unit::none,
                  "particles of rigid supports; only in a stage that has some"),
            field("body", &Carried::body, unit::none,
                  "the rigid body that each is of, from 1: those of one do not touch each other")),
    fields_of(
        "/books/", &State::books,
        field("at_start", &EnergyBooks::at_start, unit::energy,
              "kinetic + potential energy when the run began", {.known = Known::summed}),
        field("dissipated", &EnergyBooks::dissipated, unit::energy,
              "taken out by damping, and given up when a pair is bonded", {.known = Known::summed}),
        field(
            "released", &EnergyBooks::released, unit::energy,
            "of bonds at the time they broke, less that of contacts it switched on; and of dropped particles",
            {.known = Known::summed}),
        field("work_loads", &EnergyBooks::work_loads, unit::energy,
              "work of point forces, moments and gravity", {.known = Known::summed}),
        field("work_supports", &EnergyBooks::work_supports, unit::energy,
              "work of supports, prescribed velocities, imposed strain and changes of temperature",
              {.known = Known::summed}),
        field("inserted", &EnergyBooks::inserted, unit::energy,
              "energy of bodies as they came in; only if there is any",
              {.known = Known::summed, .filed = Filed::where_any}),
        field("removed", &EnergyBooks::removed, unit::energy,
              "energy that went with particles that were taken out; only if there is any",
              {.known = Known::summed, .filed = Filed::where_any}),
        field("lost", &EnergyBooks::lost, unit::energy,
              "dissipated by cause: damping of bonds whose law does not tell its channels, yield "
              "(axial, shear, bending, torsion), creep, softening, other laws, drag, local damping, "
              "damping of contacts, friction, rolling, adhesion, bonding, damping of bonds (axial, "
              "shear, bending, torsion); of yield, creep and softening what bonds had lost when the "
              "books began, as a negative number; only if there is any",
              {.known = Known::summed, .filed = Filed::where_any}),
        field("largest", &EnergyBooks::largest, unit::energy,
              "largest size of at_start + work + inserted so far: the scale of the balance error", {})),
    fields_of(
        "/peak/", &State::peak,
        field("sum", &PeakRecord::sum, unit::force, "of the samples in the block under way",
              {.anew = Anew::stage}),
        field("samples", &PeakRecord::samples, unit::none, "in the block under way", {.anew = Anew::stage}),
        field("last", &PeakRecord::last, unit::force, "average of the last full block",
              {.anew = Anew::stage}),
        field("peak", &PeakRecord::peak, unit::force, "largest block average so far", {.anew = Anew::stage}),
        field("peak_time", &PeakRecord::peak_time, unit::time, "end of that block", {.anew = Anew::stage}),
        field("blocks", &PeakRecord::blocks, unit::none, "full blocks so far in this stage",
              {.anew = Anew::stage})),
    fields_of("/rest/", &State::rest,
              field("quiet_steps", &RestRecord::quiet_steps, unit::none,
                    "steps in a row with a low kinetic energy", {.anew = Anew::stage})),
    fields_of<State>("/breaks/", field("in_stage", &State::breaks, unit::none,
                                       "bonds that have broken in this stage", {.anew = Anew::stage})),
};

template <class... T>
constexpr auto tables_of(TermList<T...>) {
  return std::tuple_cat(T::state_tables...);
}

/// Whether these tables name all members of Whole, and of each of their structs.
template <class Whole, class... Tables>
constexpr bool are_whole(const std::tuple<Tables...>& tables, std::size_t bases = 0) {
  std::size_t of_whole = bases;
  bool whole = true;
  for_each_table(tables, [&]<class Table>(const Table& table) {
    std::size_t fields = 0, of_few = 0, all_of_few = 0;
    for_each_field(table, [&]<class Of, class Value, class Member>(const Field<Of, Value, Member>&) {
      if constexpr (is_of_few<Member>)
        ++of_few, all_of_few = Member::members;
      else
        ++fields;
    });
    using Of = typename Table::Of;
    whole &= of_few == all_of_few;
    if (of_few > 0) ++fields;  // their box
    if constexpr (std::is_same_v<Of, Whole>)
      of_whole += fields;
    else
      ++of_whole, whole &= !std::is_aggregate_v<Of> || fields == member_count<Of>();
  });
  return whole && of_whole == member_count<Whole>();
}
template <class... T>
constexpr bool are_whole(TermList<T...>) {
  return (are_whole<StatePart<T>>(T::state_tables) && ...);
}

inline constexpr auto state_table =
    std::tuple_cat(tables_before_terms, tables_of(Terms{}), tables_after_terms);

static_assert(are_whole<State>(std::tuple_cat(tables_before_terms, tables_after_terms),
                               1) &&  // what it has of the terms
                  are_whole(Terms{}),
              "a member of State or of its structs is missing in state_table");

/// What State holds of each particle of any body.  [bytes]
inline constexpr std::size_t state_bytes_per_particle = [] {
  std::size_t bytes = 0;
  for_each_table(state_table, [&](const auto& table) {
    for_each_field(table, [&]<class Of, class Value, class Member>(const Field<Of, Value, Member>& f) {
      if constexpr (is_particle_column<Value>)
        if (f.traits.filed == Filed::always) bytes += sizeof(*std::declval<Value&>().data());
    });
  });
  return bytes;
}();

/// Fields that begin anew then are as in a new body of as many particles.
void begin_anew(State& state, Anew when);

}  // namespace vbond
