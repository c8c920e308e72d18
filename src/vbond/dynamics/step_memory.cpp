#include "vbond/dynamics/step_memory.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_index.hpp"
#include "vbond/dynamics/bond_pack.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/present.hpp"
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
    if (!image_of_j(b).is_itself()) bonded.push_back({b.j, image_of_j(b)});
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
  for (const Bond& b : state.bonds) compact += !has_other_frame(b);
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
    if (b.rare) bytes += sizeof(RareOfBond) + of_each / 2;
    const Coefficients c = b.coefficients;
    if (std::any_of(c.begin() + first_others, c.end(), [](double x) { return x != 0.0; }))
      bytes += sizeof(double) * (c.size() - first_others) + of_each / 2;
  }
  return state.bonds.empty() ? 0.0 : bytes / static_cast<double>(state.bonds.size());
}

/// In the rows of the step, and in the order of the part that moves it. Where any bond damps, each particle
/// has a row of what damping does.
double row_bytes(const State& state) {
  const bool damps = std::any_of(state.bonds.begin(), state.bonds.end(),
                                 [](const Bond& b) { return !b.broken && is_damped(b); });
  return sizeof(PoseRow) + sizeof(MotionRow) + (damps ? 2 : 1) * sizeof(LoadRow) + sizeof(InverseInertia) +
         2 * sizeof(double) + sizeof(ParticleId);
}

/// Its row, and first and last entry of the index.
constexpr double places_bytes = sizeof(Row) + 2 * sizeof(std::uint32_t);

/// Of a model, what a rank has of its own particles alone: mass, inertia, first place, specimen.
constexpr double own_model_bytes = 2 * sizeof(double) + sizeof(Vec3d) + sizeof(std::uint32_t);

/// Measured (docs/decisions/ranks.md): a rank of a body of 64 particles, and what LAMMPS has of each of its
/// atoms. It keeps these where particles touch, which may go far.
constexpr double rank_bytes = 53 * 0x1p20, atom_bytes = 110;
/// While a rank looks for overlaps among so many particles: where those of a layer are, and their cells; and
/// which particles are looked at. Measured likewise.
double look_bytes(double particles) {
  return 5 * particles + 84 * PairLayers::particles_of_one(particles);
}

/// Groups whose numbers do not follow each other are lists.
double lists_per_particle(const Model& model) {
  double lists = 0.0;
  for (const Group& g : model.groups) lists += static_cast<double>(g.particles.bytes());
  return model.particles() == 0 ? 0.0 : lists / static_cast<double>(model.particles());
}

/// What each rank has of all particles: radii, lists of groups, whose they are, and which ones it knows.
double of_all_per_particle(const Model& model) {
  return sizeof(double) + 2.0 + lists_per_particle(model);
}

/// Of a rank with so many particles, which lie in a cube: other ends of bonds on three of its faces; or all
/// that contacts reach, some two layers on six.
double ghosts_of(const Model& model, double own) {
  const double layers = particles_touch(model.contact) ? 12.0 : 3.0;
  return std::min(static_cast<double>(model.particles()) - own, layers * std::cbrt(own * own));
}

}  // namespace

MemoryUse memory_use(const Model& model, const State& state) {
  const double row = row_bytes(state);
  return {.per_particle = model_bytes_per_particle + lists_per_particle(model) + state_bytes_per_particle +
                          row + places_bytes + of_tops_per_particle(model) +
                          images_per_particle(model, state) * (row + sizeof(Row) + 2 * sizeof(Image)),
          .per_bond =
              sizeof(Bond) + boxed_per_bond(state) + constants_per_bond(state) + BondIndex::bytes_per_bond};
}

double memory_of_each_rank(const Model& model, const State& state, double bonds, int ranks, RanksKeep keep) {
  const MemoryUse use = memory_use(model, state);
  const auto n = static_cast<double>(model.particles());
  const double own = n / ranks, atoms = own * atom_bytes;
  if (ranks == 1 || keep == RanksKeep::all_bonds) {
    const double elsewhere = 1.0 - 1.0 / ranks;
    const double rows_elsewhere =
        any_capsules(model.contact, state.bonds) ? 0.0 : row_bytes(state) * elsewhere;
    const double bond_elsewhere = (constants_per_bond(state) + BondIndex::bytes_per_bond) * elsewhere;
    return rank_bytes + atoms + n * (use.per_particle - rows_elsewhere) +
           bonds * (use.per_bond - bond_elsewhere);
  }
  const double of_all = of_all_per_particle(model);
  constexpr double counts = 2 * sizeof(std::uint32_t) + 2.0;  // bonds of each particle, and whose it is
  constexpr double pair = 2 * sizeof(ParticleId) + sizeof(Image);
  const double known = own + ghosts_of(model, own);
  constexpr double place_bytes = sizeof(Vec3d), motion_bytes = state_bytes_per_particle - place_bytes;
  const double made = atoms + n * (of_all + own_model_bytes + counts) +  // of first places or present ones
                      (keep == RanksKeep::own_first_places ? known : n) * place_bytes +
                      (keep == RanksKeep::own_bonds ? n : known) * motion_bytes +
                      bonds / ranks * (sizeof(Bond) + boxed_per_bond(state) + sizeof(BondId) + pair);
  const double steps =
      (particles_touch(model.contact) ? atoms : 0.0) + n * of_all +
      known * (use.per_particle - model_bytes_per_particle - lists_per_particle(model) + own_model_bytes) +
      look_bytes(known) + bonds / ranks * (use.per_bond + sizeof(BondId));
  constexpr double for_a_moment = 1.05;  // messages, pieces of a checkpoint
  return for_a_moment * (rank_bytes + std::max(made, steps));
}

}  // namespace vbond
