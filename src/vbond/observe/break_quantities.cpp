#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

using Break = BreakView;

// In the order of the columns.
constexpr RowQuantity<Break> of_breaks[] = {
    {"time", unit::time,
     "of the run, at the end of the step; of breaks at rest that of the start of their stage: a balance "
     "takes no time",
     [](const Break& b) -> Cell { return b.clock.time(); }},
    {"step", unit::none, "of the run", [](const Break& b) -> Cell { return b.event.step; }},
    {"stage", unit::none, "index of the stage, from 0",
     [](const Break& b) -> Cell { return std::int64_t{b.clock.stage}; }},
    {"bond", unit::none, "number of the bond, in order of creation",
     [](const Break& b) -> Cell { return std::int64_t{b.event.bond.value}; }},
    {"i", unit::none, "number of its first particle",
     [](const Break& b) -> Cell { return std::int64_t{b.event.i.value}; }},
    {"j", unit::none, "number of its second particle",
     [](const Break& b) -> Cell { return std::int64_t{b.event.j.value}; }},
    {"set", unit::none, "which bond set of the case made it, from 0",
     [](const Break& b) -> Cell { return std::int64_t{b.event.set}; }},
    {"x", unit::length, "place: half way between the bonded points",
     [](const Break& b) -> Cell { return b.event.middle.x; }},
    {"y", unit::length, "place", [](const Break& b) -> Cell { return b.event.middle.y; }},
    {"z", unit::length, "place", [](const Break& b) -> Cell { return b.event.middle.z; }},
    {"dx", unit::none, "direction from i to j: the normal of the new face",
     [](const Break& b) -> Cell { return b.event.direction.x; }},
    {"dy", unit::none, "direction", [](const Break& b) -> Cell { return b.event.direction.y; }},
    {"dz", unit::none, "direction", [](const Break& b) -> Cell { return b.event.direction.z; }},
    {"N", unit::force, "axial force, tension is positive; this and the next three are elastic",
     [](const Break& b) -> Cell { return b.event.loads.N; }},
    {"V", unit::force, "size of the shear force", [](const Break& b) -> Cell { return b.event.loads.V; }},
    {"M_b", unit::moment, "size of the bending moment at the middle",
     [](const Break& b) -> Cell { return b.event.loads.M_b; }},
    {"M_t", unit::moment, "torque", [](const Break& b) -> Cell { return b.event.loads.M_t; }},
    {"tension", unit::none,
     "part of the bond's strength that tension used up, < 0 where compression relieves",
     [](const Break& b) -> Cell { return b.event.failure.tension; }},
    {"shear", unit::none, "that shear used up", [](const Break& b) -> Cell { return b.event.failure.shear; }},
    {"bending", unit::none, "that bending used up",
     [](const Break& b) -> Cell { return b.event.failure.bending; }},
    {"torsion", unit::none, "that torsion used up",
     [](const Break& b) -> Cell { return b.event.failure.torsion; }},
    {"compression", unit::none, "that compression used up, with its bending",
     [](const Break& b) -> Cell { return b.event.failure.compression; }},
    {"utilisation", unit::none, "all that counts of these; a bond breaks at 1",
     [](const Break& b) -> Cell { return b.event.failure.utilisation; }},
    {"criterion", unit::none, "`strength.criterion` of its set; `none`: its law has its own",
     [](const Break& b) -> Cell { return std::string_view(to_text(b.event.criterion)); }},
    {"mode", unit::none,
     "the largest part of what governed: `tension`, `shear`, `bending`, `torsion` or `compression`; `other`: "
     "its law does not say",
     [](const Break& b) -> Cell { return std::string_view(to_text(b.event.cause.mode)); }},
    {"limit", unit::stress,
     "the bond's own strength that the stress was compared with; empty for criteria without stresses",
     [](const Break& b) -> Cell { return b.event.cause.limit == 0.0 ? Cell() : Cell(b.event.cause.limit); }},
    {"energy", unit::energy, "of the bond as it broke",
     [](const Break& b) -> Cell { return b.event.energy; }},
    {"load", unit::force,
     "size of the force that supports exerted on the first group of `output.history.reactions`, the bond "
     "still whole; empty without such a group",
     [](const Break& b) -> Cell { return b.load ? Cell(*b.load) : Cell(); }},
};

constexpr RowQuantity<FragmentView> of_fragments[] = {
    {"stage", unit::none, "index of the stage, from 0, at whose end the fragments are these",
     [](const FragmentView& f) -> Cell { return f.stage; }},
    {"step", unit::none, "of the run", [](const FragmentView& f) -> Cell { return f.clock.step; }},
    {"time", unit::time, "of the run", [](const FragmentView& f) -> Cell { return f.clock.time(); }},
    {"fragment", unit::none, "its number: 0 is the heaviest, of equal ones that with the lowest particle",
     [](const FragmentView& f) -> Cell { return f.number; }},
    {"particles", unit::none, "how many", [](const FragmentView& f) -> Cell { return f.fragment.particles; }},
    {"lowest", unit::none, "the lowest number of its particles",
     [](const FragmentView& f) -> Cell { return std::int64_t{f.fragment.lowest.value}; }},
    {"mass", unit::mass, "of all its particles",
     [](const FragmentView& f) -> Cell { return f.fragment.mass; }},
    {"x", unit::length,
     "of the centre of mass, of the fragment as a whole; empty if it goes all through a periodic cell",
     [](const FragmentView& f) -> Cell { return f.centre ? Cell(f.centre->x) : Cell(); }},
    {"y", unit::length, "of the centre of mass",
     [](const FragmentView& f) -> Cell { return f.centre ? Cell(f.centre->y) : Cell(); }},
    {"z", unit::length, "of the centre of mass",
     [](const FragmentView& f) -> Cell { return f.centre ? Cell(f.centre->z) : Cell(); }},
    {"vx", unit::velocity, "of the centre of mass",
     [](const FragmentView& f) -> Cell { return f.velocity.x; }},
    {"vy", unit::velocity, "of the centre of mass",
     [](const FragmentView& f) -> Cell { return f.velocity.y; }},
    {"vz", unit::velocity, "of the centre of mass",
     [](const FragmentView& f) -> Cell { return f.velocity.z; }},
};

}  // namespace

std::span<const RowQuantity<BreakView>> break_quantities() {
  return of_breaks;
}

std::span<const RowQuantity<FragmentView>> fragment_quantities() {
  return of_fragments;
}

const char* to_text(BreakMode mode) {
  switch (mode) {
    case BreakMode::none: return "none";
    case BreakMode::tension: return "tension";
    case BreakMode::shear: return "shear";
    case BreakMode::bending: return "bending";
    case BreakMode::torsion: return "torsion";
    case BreakMode::compression: return "compression";
    case BreakMode::other: return "other";
  }
  return "other";
}

const char* to_text(Criterion criterion) {
  switch (criterion) {
    case Criterion::none: return "none";
    case Criterion::stress: return "stress";
    case Criterion::mohr_coulomb: return "mohr-coulomb";
    case Criterion::linear: return "linear";
    case Criterion::fibre: return "fibre";
    case Criterion::quadratic: return "quadratic";
    case Criterion::energy: return "energy";
    case Criterion::elongation: return "elongation";
  }
  return "none";
}

}  // namespace vbond
