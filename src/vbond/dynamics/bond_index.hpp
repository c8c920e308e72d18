#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "vbond/dynamics/order.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The unbroken bonds of each particle: for asking who is bonded. In order of creation; of a part of a body
/// those of which it knows an end, own ones first.
class BondIndex {
 public:
  struct Entry {
    BondId bond;  ///< its number in the whole body
    ParticleId other;
    bool is_i;       ///< the particle is the bond's i
    Image of_other;  ///< which image of the other one it is bonded to
  };
  /// Entries, made as they are looked at of what is kept.
  class Range {
   public:
    struct Iterator {
      const BondIndex* index;
      std::size_t at;
      Entry operator*() const { return index->entry(at); }
      Iterator& operator++() { return ++at, *this; }
      friend bool operator==(const Iterator&, const Iterator&) = default;
    };
    Range(const BondIndex* index, std::size_t first, std::size_t last)
        : index_(index), first_(first), last_(last) {}
    Iterator begin() const { return {index_, first_}; }
    Iterator end() const { return {index_, last_}; }

   private:
    const BondIndex* index_;
    std::size_t first_, last_;
  };

  /// What it takes of a bond, where none joins images.
  static constexpr std::size_t bytes_per_bond = 2 * (sizeof(BondId) + sizeof(std::uint32_t));

  BondIndex() = default;
  BondIndex(const Order& order, const PerBond<Bond>& bonds, const PartBonds& of_part = {});

  /// This bond between i and j is broken.
  void remove(BondId bond, ParticleId i, ParticleId j);

  Range of(ParticleId p) const {
    if (ends_ && !ends_->has(p)) return {this, 0, 0};
    const std::size_t k = place(p);
    return {this, start_[k], end_[k]};
  }
  /// Whether a bond that touches as a capsule was ever made there.
  bool of_fibre(ParticleId p) const { return !of_fibre_.empty() && of_fibre_[p.value] != 0; }
  bool any_fibres() const { return !of_fibre_.empty(); }
  /// Whether p is bonded to this image of o.
  bool bonded(ParticleId p, ParticleId o, const Image& of_o = {}) const {
    for (const Entry e : of(p))
      if (e.other == o && e.of_other == of_o) return true;
    return false;
  }

 private:
  /// An entry but for the image, which few bodies have.
  struct Kept {
    BondId bond;
    std::uint32_t is_i : 1;
    std::uint32_t other : 31;  // particles are fewer than 2^28 (core/near_pairs.hpp)
  };
  Entry entry(std::size_t at) const {
    const Kept& e = kept_[at];
    return {e.bond, ParticleId{e.other}, e.is_i != 0, of_other_.empty() ? Image{} : of_other_[at]};
  }
  std::size_t place(ParticleId p) const { return ends_ ? ends_->place(p) : p.value; }

  std::shared_ptr<const IdSet<ParticleId>> ends_;  // who has entries; null: all have a place
  std::vector<std::uint32_t> start_, end_;         // of each place's entries
  std::vector<Kept> kept_;
  std::vector<Image> of_other_;  // of each entry; empty: each is bonded to particles themselves
  std::vector<char> of_fibre_;
};

}  // namespace vbond
