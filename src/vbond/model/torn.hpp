#pragma once
#include <string>
#include <vector>

#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

// Particles stand where they are, not where their images are. So a group that a face of a periodic cell cuts
// is not one body as it stands: arms between its parts go all through the cell.
namespace vbond {

/// Whether a support turns its particles as one body, or lets them turn so.
inline bool turns_as_one(const Support& s) {
  return s.rigid && (s.angular_velocity != Vec3d{} || !s.held[3] || !s.held[4] || !s.held[5]);
}

/// A bond between two of these particles, or of one with itself, that goes through a face of the cell, or
/// none. certain: one that will be there in later stages, too.
inline const Bond* bond_through_face(const State& s, const std::vector<ParticleId>& group,
                                     bool certain = false) {
  if (s.cell.empty()) return nullptr;
  PerParticle<char> in(s.r.size(), 0);
  for (const ParticleId p : group) in[p] = 1;
  for (const Bond& b : s.bonds)
    if (!image_of_j(b).is_itself() && in[b.i] && in[b.j] && !has_failed(b) && !(certain && can_break(b)))
      return &b;
  return nullptr;
}

inline constexpr const char* torn_rule =
    "particles stand where they are, not where their images are: arms would go all through the cell";
inline constexpr const char* way_out_of_torn =
    "move the body or cell.corner so that no face cuts it; what goes all through the cell cannot turn";

}  // namespace vbond
