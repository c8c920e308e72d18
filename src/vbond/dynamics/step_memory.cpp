#include "vbond/dynamics/step_memory.hpp"

#include <algorithm>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/bond_pack.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/state_table.hpp"

namespace vbond {

namespace {

/// What there is besides if the moments of inertia of some particles differ.
double of_tops_per_particle(const Model& model) {
  if (model.principal.empty()) return 0.0;
  double tops = 0.0;
  for (const ParticleId p : model.mass.ids()) tops += model.is_top(p) ? 1.0 : 0.0;
  return sizeof(PrincipalInertia) + sizeof(Vec3d) + sizeof(std::uint32_t) +
         tops / static_cast<double>(model.particles()) * Tops::bytes_each;
}

/// Of a periodic body: those that bonds join, or particles within a diameter of the faces where they touch.
double images_per_particle(const Model& model, const State& state) {
  if (state.cell.empty() || model.particles() == 0) return 0.0;
  std::vector<ImageOf> bonded;
  for (const Bond& b : state.bonds)
    if (!b.image_j.is_itself()) bonded.push_back({b.j, b.image_j});
  std::sort(bonded.begin(), bonded.end());
  const auto distinct = std::unique(bonded.begin(), bonded.end()) - bonded.begin();
  const double joined = static_cast<double>(distinct) / static_cast<double>(model.particles());
  if (!particles_touch(model.contact)) return joined;
  const double diameter = 2.0 * *std::max_element(model.radius.begin(), model.radius.end());
  const Vec3d h = heights(state.cell);
  double with_images = 1.0;
  for (int k = 0; k < 3; ++k)
    if (model.cell.periodic[static_cast<std::size_t>(k)])
      with_images *= 1.0 + 2.0 * diameter / component(h, k);
  return std::max(joined, with_images - 1.0);
}

/// In a pack, as a mean over all bonds.
double constants_per_bond(const State& state) {
  std::size_t compact = 0;
  for (const Bond& b : state.bonds) compact += !b.other_frame_j;
  const double part =
      state.bonds.empty() ? 1.0 : static_cast<double>(compact) / static_cast<double>(state.bonds.size());
  constexpr double lanes = pack_bonds;
  const double pack =
      (part * sizeof(CompactPack) + (1.0 - part) * sizeof(FullPack) + sizeof(PackLanes)) / lanes;
  return pack + sizeof(BondId);
}

/// What bonds of State take besides, as a mean over all: what is boxed, with what an allocator adds to it.
double boxed_per_bond(const State& state) {
  constexpr double of_each = 16.0;
  const std::size_t first_others = 4;  // of KeptCoefficients
  double bytes = 0.0;
  for (const Bond& b : state.bonds) {
    if (b.other_frame_j) bytes += sizeof(Quatd) + of_each;
    const Coefficients c = b.coefficients;
    if (std::any_of(c.begin() + first_others, c.end(), [](double x) { return x != 0.0; }))
      bytes += sizeof(double) * (c.size() - first_others) + of_each / 2;
  }
  return state.bonds.empty() ? 0.0 : bytes / static_cast<double>(state.bonds.size());
}

/// In the rows of the step, and in the order of the part that moves it.
constexpr double row_bytes = sizeof(PoseRow) + sizeof(MotionRow) + sizeof(LoadRow) + sizeof(InverseInertia) +
                             2 * sizeof(double) + sizeof(ParticleId);

/// Its row, and first and last entry of the index.
constexpr double places_bytes = sizeof(Row) + 2 * sizeof(std::size_t);

}  // namespace

MemoryUse memory_use(const Model& model, const State& state) {
  return {.per_particle = 4 * sizeof(double) + sizeof(Vec3d) +  // model
                          state_bytes_per_particle + row_bytes + places_bytes + of_tops_per_particle(model) +
                          images_per_particle(model, state) * (row_bytes + sizeof(Row) + 2 * sizeof(Image)),
          .per_bond =
              sizeof(Bond) + boxed_per_bond(state) + constants_per_bond(state) + BondIndex::bytes_per_bond};
}

double memory_of_each_rank(const Model& model, const State& state, double bonds, int ranks, RanksKeep keep) {
  const MemoryUse use = memory_use(model, state);
  const auto n = static_cast<double>(model.particles());
  const double elsewhere = 1.0 - 1.0 / ranks;
  const double rows_elsewhere = any_capsules(model.contact, state.bonds) ? 0.0 : row_bytes * elsewhere;
  const double known_elsewhere = rows_elsewhere + elsewhere * (state_bytes_per_particle + places_bytes);
  if (ranks > 1 && keep == RanksKeep::own_bonds)
    return n * (use.per_particle - known_elsewhere) + bonds / ranks * (use.per_bond + sizeof(BondId));
  const double bond_elsewhere = (constants_per_bond(state) + BondIndex::bytes_per_bond) * elsewhere;
  return n * (use.per_particle - rows_elsewhere) + bonds * (use.per_bond - bond_elsewhere);
}

}  // namespace vbond
