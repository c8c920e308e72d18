#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

constexpr CheckpointQuantity data_sets[] = {
    {"/clock/step", unit::none, "steps since the start of the run"},
    {"/clock/stage_step", unit::none, "steps since the start of this stage"},
    {"/clock/stage", unit::none, "index of the stage, from 0"},
    {"/clock/stage_start", unit::time, "time at which this stage began"},
    {"/clock/dt", unit::time, "time step"},
    {"/particles/r", unit::length, "positions of the centres"},
    {"/particles/v", unit::velocity, "velocities of the centres"},
    {"/particles/q", unit::none,
     "orientations, quaternions w, x, y, z that turn body vectors into the world"},
    {"/particles/omega", unit::angular_velocity, "angular velocities, world frame"},
    {"/bonds/i", unit::none, "number of the first particle"},
    {"/bonds/j", unit::none, "number of the second particle"},
    {"/laws/name", unit::none, "names of the bond laws, 32 bytes each, filled up with zeros"},
    {"/bonds/law", unit::none, "number of the bond's law among these names"},
    {"/rules/numbers", unit::none,
     "stretching, strength and damping that bonds share, in the units of the case; "
     "only where bonds have rules"},
    {"/bonds/rules", unit::none, "number of the bond's rules among these"},
    {"/bonds/a", unit::length, "length at rest"},
    {"/bonds/R_i", unit::length, "distance of the bonded point from the centre of i"},
    {"/bonds/R_j", unit::length, "distance of the bonded point from the centre of j"},
    {"/bonds/coefficients", unit::none, "of the law, in the order and units of its list; the rest zero"},
    {"/bonds/frame_i", unit::none, "the bond's frame in the body frame of i, quaternion w, x, y, z"},
    {"/bonds/frame_j", unit::none, "the bond's frame in the body frame of j, quaternion w, x, y, z"},
    {"/bonds/set", unit::none, "which bond set of the case made it"},
    {"/bonds/broken", unit::none, "1: it does nothing any more"},
    {"/bonds/history", unit::none,
     "what the bond remembers, in the order and units of its law; only where bonds remember something"},
    {"/contacts/i", unit::none,
     "first particles of touching pairs that remember something; only if there are any"},
    {"/contacts/j", unit::none, "second particles of these pairs"},
    {"/contacts/history", unit::none, "what they remember, in the order and units of their law"},
    {"/loads/F", unit::force, "forces on the particles; only where they do not follow from positions"},
    {"/loads/M", unit::moment, "moments on the particles, about their centres; as /loads/F"},
    {"/loads/damping_F", unit::force, "the part of these forces that damps; only where pairs damp"},
    {"/loads/damping_M", unit::moment, "the part of these moments that damps"},
    {"/books/at_start", unit::energy, "kinetic + potential energy when the run began"},
    {"/books/dissipated", unit::energy, "taken out by damping, and given up when a pair is bonded"},
    {"/books/released", unit::energy,
     "of bonds at the time they broke, less that of contacts it switched on"},
    {"/books/work_loads", unit::energy, "work of point forces, moments and gravity"},
    {"/books/work_supports", unit::energy, "work of supports, prescribed velocities and imposed strain"},
    {"/books/largest", unit::energy, "largest at_start + work so far: the scale of the balance error"},
    {"/peak/sum", unit::force, "of the samples in the block under way"},
    {"/peak/samples", unit::none, "in the block under way"},
    {"/peak/last", unit::force, "average of the last full block"},
    {"/peak/peak", unit::force, "largest block average so far"},
    {"/peak/peak_time", unit::time, "end of that block"},
    {"/peak/blocks", unit::none, "full blocks so far in this stage"},
    {"/rest/quiet_steps", unit::none, "steps in a row with a low kinetic energy"},
    {"/watch/worst", unit::none, "worst range of each bond: 0 good, 1 strained, 2 snapped"},
    {"/watch/was_short", unit::none, "1: the bond has been shorter than half its length at rest"},
    {"/watch/strained", unit::none, "bonds that were found strained"},
    {"/watch/snapped", unit::none, "bonds that were found snapped"},
    {"/watch/shortened", unit::none, "bonds that were found short"},
    {"/watch/overlapping_i", unit::none,
     "first particles of pairs that were found to overlap; only if there are any"},
    {"/watch/overlapping_j", unit::none, "second particles of these pairs"},
    {"/watch/stretched", unit::none,
     "bonds that were found longer than twice their length; only if there are any"},
    {"/watch/fastest", unit::none,
     "largest way of a particle in a step over the longest that contacts can follow; only if one was too "
     "fast"},
    {"/watch/deep_i", unit::none,
     "first particles of pairs that are deep in one another; only if there are any"},
    {"/watch/deep_j", unit::none, "second particles of these pairs"},
    {"/watch/deep_entered", unit::length, "r_j - r_i as they came so deep"},
    {"/watch/deep_nearest", unit::length, "least distance of their centres since"},
    {"/watch/deep_last_step", unit::none, "last step at which they still were"},
    {"/model/units", unit::none, "0 reduced, 1 SI"},
    {"/model/mass", unit::mass, "of the particles"},
    {"/model/inertia", unit::inertia, "moments of inertia of the particles"},
    {"/model/radius", unit::length, "of the particles"},
    {"/model/r_0", unit::length, "first positions"},
};

}  // namespace

std::span<const CheckpointQuantity> checkpoint_quantities() {
  return data_sets;
}

}  // namespace vbond
