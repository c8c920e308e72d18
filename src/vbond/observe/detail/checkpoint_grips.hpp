#pragma once
#include <algorithm>

#include "vbond/model/state.hpp"
#include "vbond/observe/detail/h5_file.hpp"

/// What a checkpoint says of grips; only where the stage under way has some.
namespace vbond {

using GripStates = Column<Id<struct GripOfFile>, GripState>;
using GrippedPoses = Column<Id<struct GrippedOfFile>, GrippedPose>;

template <class Archive, class Grips>
void visit_grips(Archive& archive, Grips& grips) {
  archive.of_each("/grips/pivot", grips, &GripState::pivot);
  archive.of_each("/grips/from", grips, &GripState::from);
  archive.of_each("/grips/work", grips, &GripState::work);
  archive.of_each("/grips/particles", grips, &GripState::particles);
}

/// Of grips that are free in some degrees of freedom; only where one has moved.
template <class Archive, class Grips>
void visit_free_grips(Archive& archive, Grips& grips) {
  archive.of_each("/grips/shift", grips, &GripState::shift);
  archive.of_each("/grips/turn", grips, &GripState::turn);
  archive.of_each("/grips/velocity", grips, &GripState::velocity);
  archive.of_each("/grips/spin", grips, &GripState::spin);
  archive.of_each("/grips/angle", grips, &GripState::angle);
}
inline bool has_moved_freely(const GripState& g) {
  return !(g.shift == Vec3d{} && g.velocity == Vec3d{} && g.spin == Vec3d{} && g.turn == Quatd{1, 0, 0, 0} &&
           g.angle == 0.0);
}

template <class Archive, class Poses>
void visit_gripped(Archive& archive, Poses& poses) {
  archive.of_each("/gripped/arm", poses, &GrippedPose::arm);
  archive.of_each("/gripped/q", poses, &GrippedPose::q);
}

inline void write_grips(H5Writer& writer, const State& state) {
  if (state.grips.empty()) return;
  const GripStates grips(state.grips);
  visit_grips(writer, grips);
  if (std::any_of(state.grips.begin(), state.grips.end(), has_moved_freely)) visit_free_grips(writer, grips);
  const GrippedPoses poses(state.gripped);
  visit_gripped(writer, poses);
}

inline void read_grips(H5Reader& reader, State& state) {
  if (!reader.has("/grips/pivot")) return;
  GripStates grips;
  grips.resize(reader.rows("/grips/pivot"));
  visit_grips(reader, grips);
  if (reader.has("/grips/shift")) visit_free_grips(reader, grips);
  GrippedPoses poses;
  poses.resize(reader.rows("/gripped/arm"));
  visit_gripped(reader, poses);
  state.grips.assign(grips.begin(), grips.end());
  state.gripped.assign(poses.begin(), poses.end());
}

}  // namespace vbond
