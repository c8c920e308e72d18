#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "vbond/core/communicator.hpp"
#include "vbond/core/tensor.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// A bond of another process that is not broken: what is known here of one of its ends.
struct BondEnds {
  BondId name;  ///< its number in the whole body
  ParticleId i, j;
  Image image_j{};
  bool cracked = false;
};

/// What the state of a part has of the bonds of the body.
struct PartBonds {
  bool own_alone = false;        ///< own ones, numbered anew; else all
  PerBond<BondId> names;         ///< of these, their numbers in the whole body, increasing
  std::vector<BondEnds> others;  ///< besides these, in order of names

  /// The number in the whole body of a bond of the state, and the other way round; nothing if the state has
  /// it not.
  BondId name(BondId k) const { return own_alone ? names[k] : k; }
  std::optional<BondId> find(BondId name) const {
    if (!own_alone) return name;
    const auto at = std::lower_bound(names.begin(), names.end(), name);
    if (at == names.end() || *at != name) return std::nullopt;
    return BondId{static_cast<std::size_t>(at - names.begin())};
  }
};

/// What one of several processes knows of the bonds of a body from its set-up on, and again between stages,
/// while it has all particles, but perhaps for some of their orientations and velocities, and its own bonds
/// alone. `all` is nullptr: the state has all bonds.
struct BondsFromSetUp {
  PartBonds part;                    ///< names of those that it keeps; its `others` are empty
  PerParticle<char> own;             ///< whether each particle is its own
  PerParticle<std::uint32_t> bonds;  ///< that hold, of each particle, own or not
  std::size_t whole = 0;             ///< how many bonds the body has
  std::vector<Bond> kinds;  ///< as it is set up, the first of the whole body of each law and of all rules
  PerBond<Bond> first;      ///< then, of the first pair of the body
  const Communicator* all = nullptr;
};

inline std::vector<ParticleId> own_particles(const BondsFromSetUp& known) {
  std::vector<ParticleId> own;
  for (const ParticleId p : known.own.ids())
    if (known.own[p] != 0) own.push_back(p);
  return own;
}

/// How many bonds hold each particle in such a state; all processes call this together.
inline void count_bonds_of_each(BondsFromSetUp& known, const State& state) {
  known.bonds.assign(state.r.size(), 0);
  for (const Bond& b : state.bonds)
    if (!b.broken) ++known.bonds[b.i], ++known.bonds[b.j];
  known.all->sum_counts({known.bonds.data(), known.bonds.size()});
}

/// What one process sees of a body that several may share: sums over what is its own, added up, are of the
/// whole body. Each particle is the own one of one process, and a bond that of its first particle; a pair
/// that touches is that of its lower number. One process that has the whole body owns all of it.
class BodyPart {
 public:
  /// The whole body. Keeps a reference.
  BodyPart(const State& whole) : state(whole), all(alone()) {}
  /// The whole body, whose particles each of these processes has, and own bonds alone: as it is set up. Sums
  /// over particles are of each; pairs that touch are of one. Keeps references.
  BodyPart(const State& whole, const BondsFromSetUp& bonds)
      : state(whole),
        all(bonds.all != nullptr ? *bonds.all : alone()),
        bonds_(bonds.all != nullptr ? &bonds.part : nullptr),
        from_set_up_(bonds.all != nullptr ? &bonds : nullptr) {}
  /// A part: own says of each particle whether it is, near are those that the state shows. Keeps references.
  BodyPart(const State& shown, const PerParticle<char>& own, const PartBonds& bonds,
           std::vector<ParticleId> near_ones, const Communicator& processes)
      : state(shown), all(processes), near(std::move(near_ones)), own_(&own), bonds_(&bonds) {}

  /// Of a part up to date for its own particles and bonds, both ends of these while they hold, and particles
  /// that are near; what pairs and walls remember is of its own ones.
  const State& state;
  const Communicator& all;
  /// Of a part its own particles that are present, and all others that may be nearer to them than was asked
  /// for, in increasing order; nobody where no distance was asked for.
  std::vector<ParticleId> near;

  bool is_whole() const { return own_ == nullptr; }  ///< all particles are its own
  bool has_all_bonds() const { return own_ == nullptr && bonds_ == nullptr; }
  bool has(ParticleId p) const { return own_ == nullptr || (*own_)[p] != 0; }
  /// Whether a bond of the state is its own; and the number of that bond in the whole body, by which files
  /// and messages know it.
  bool has(const Bond& b) const { return has(b.i); }
  /// Whether pairs that touch are shared out, and one of this lower number is its own.
  bool shares_pairs() const { return own_ != nullptr || from_set_up_ != nullptr; }
  bool has_pair_of(ParticleId lower) const {
    return from_set_up_ != nullptr ? from_set_up_->own[lower] != 0 : has(lower);
  }
  BondId name(BondId k) const { return bonds_ == nullptr ? k : bonds_->name(k); }
  /// How many bonds that are not broken each particle has, of those of which it knows an end; as a body is
  /// set up, of all.
  PerParticle<std::uint32_t> bonds_of_each() const {
    if (from_set_up_ != nullptr) return from_set_up_->bonds;
    PerParticle<std::uint32_t> n(state.r.size(), 0);
    for_bonded([&n](ParticleId i, ParticleId j, const Image&, bool) { ++n[i], ++n[j]; });
    return n;
  }
  /// Calls visit(i, j, image_j, cracked) for all bonds that are not broken and of which it knows an end, own
  /// and others; as a body is set up, for own ones.
  template <class Visit>
  void for_bonded(Visit&& visit) const {
    for (const Bond& b : state.bonds)
      if (!b.broken) visit(b.i, b.j, image_of_j(b), is_cracked(b));
    if (bonds_ == nullptr) return;
    for (const BondEnds& b : bonds_->others) visit(b.i, b.j, b.image_j, b.cracked);
  }

  /// The sum of what all processes have.
  Vec3d summed(const Vec3d& here) const {
    std::array<double, 3> x{here.x, here.y, here.z};
    all.sum(x);
    return {x[0], x[1], x[2]};
  }
  Tensor summed(const Tensor& here) const {
    std::array<double, 9> x{};
    for (std::size_t a = 0; a < 3; ++a)
      x[3 * a] = here.row[a].x, x[3 * a + 1] = here.row[a].y, x[3 * a + 2] = here.row[a].z;
    all.sum(x);
    Tensor sum;
    for (std::size_t a = 0; a < 3; ++a) sum.row[a] = {x[3 * a], x[3 * a + 1], x[3 * a + 2]};
    return sum;
  }

 private:
  const PerParticle<char>* own_ = nullptr;
  const PartBonds* bonds_ = nullptr;
  const BondsFromSetUp* from_set_up_ = nullptr;
};

/// The whole body, with all bonds where `own` is null.
inline BodyPart body_of(const State& whole, const std::shared_ptr<const BondsFromSetUp>& own) {
  return own != nullptr ? BodyPart(whole, *own) : BodyPart(whole);
}

/// How many bonds there are of which this holds, in all parts.
template <class Holds>
std::int64_t count_bonds(const BodyPart& body, Holds holds) {
  std::int64_t here = 0;
  for (const Bond& b : body.state.bonds) here += holds(b) && body.has(b) ? 1 : 0;
  auto all = static_cast<double>(here);  // exact below 2^53
  body.all.sum({&all, 1});
  return static_cast<std::int64_t>(all);
}
/// Broken ones, too.
inline std::int64_t count_bonds(const BodyPart& body) {
  if (body.has_all_bonds()) return static_cast<std::int64_t>(body.state.bonds.size());
  return count_bonds(body, [](const Bond&) { return true; });
}

}  // namespace vbond
