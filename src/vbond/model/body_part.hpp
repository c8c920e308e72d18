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

/// The bonds that one of several processes keeps of a body from its set-up on, while it still has all
/// particles. `all` is nullptr: the state has all bonds.
struct BondsFromSetUp {
  struct Ends {
    ParticleId i, j;
  };
  struct EndAtImage {
    std::uint32_t other;  ///< its place in `others`
    Image image_j;
  };

  PartBonds part;                  ///< names of those that it keeps; its `others` are empty
  std::vector<Ends> others;        ///< of all bonds that it does not keep, in order of names
  std::vector<EndAtImage> images;  ///< of those that join images, in their order
  std::vector<Bond> kinds;  ///< in the whole body the first ones of each law and of all rules, in order
  PerBond<Bond> first;      ///< of the first pair of the body
  const Communicator* all = nullptr;

  std::size_t bonds() const { return part.names.size() + others.size(); }  ///< of the whole body
  void add_other(const Bond& b) {
    if (!b.image_j.is_itself()) images.push_back({static_cast<std::uint32_t>(others.size()), b.image_j});
    others.push_back({b.i, b.j});
  }
  /// Calls visit(BondEnds) for each of those that it does not keep.
  template <class Visit>
  void for_others(Visit&& visit) const {
    BondId name{0};  // who keeps it not has the next one that is no own one
    auto own = part.names.begin();
    auto image = images.begin();
    for (std::uint32_t k = 0; k < others.size(); ++k, ++name.value) {
      for (; own != part.names.end() && *own == name; ++own) ++name.value;
      const bool at_image = image != images.end() && image->other == k;
      visit(BondEnds{name, others[k].i, others[k].j, at_image ? (image++)->image_j : Image{}});
    }
  }
};

/// What one process sees of a body that several may share: sums over what is its own, added up, are of the
/// whole body. Each particle is the own one of one process, and a bond that of its first particle; a pair
/// that touches is that of its lower number. One process that has the whole body owns all of it.
class BodyPart {
 public:
  /// The whole body. Keeps a reference.
  BodyPart(const State& whole) : state(whole), all(alone()) {}
  /// The whole body, whose particles each of these processes has, and own bonds alone: as it is set up. Sums
  /// over particles are of each. Keeps references.
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
  BondId name(BondId k) const { return bonds_ == nullptr ? k : bonds_->name(k); }
  /// Calls visit(i, j, image_j, cracked) for all bonds that are not broken and of which it knows an end, own
  /// and others.
  template <class Visit>
  void for_bonded(Visit&& visit) const {
    for (const Bond& b : state.bonds)
      if (!b.broken) visit(b.i, b.j, b.image_j, is_cracked(b));
    if (bonds_ == nullptr) return;
    const auto show = [&visit](const BondEnds& b) { visit(b.i, b.j, b.image_j, b.cracked); };
    for (const BondEnds& b : bonds_->others) show(b);
    if (from_set_up_ != nullptr) from_set_up_->for_others(show);
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
