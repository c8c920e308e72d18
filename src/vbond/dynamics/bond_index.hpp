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
  struct Range {
    const Entry* first;
    const Entry* last;
    const Entry* begin() const { return first; }
    const Entry* end() const { return last; }
  };

  BondIndex() = default;
  BondIndex(const Order& order, const PerBond<Bond>& bonds, const PartBonds& of_part = {});

  /// This bond between i and j is broken.
  void remove(BondId bond, ParticleId i, ParticleId j);

  Range of(ParticleId p) const {
    if (ends_ && !ends_->has(p)) return {nullptr, nullptr};
    const std::size_t k = place(p);
    return {entries_.data() + start_[k], entries_.data() + end_[k]};
  }
  /// Whether a bond that touches as a capsule was ever made there.
  bool of_fibre(ParticleId p) const { return !of_fibre_.empty() && of_fibre_[p.value] != 0; }
  bool any_fibres() const { return !of_fibre_.empty(); }
  /// Whether p is bonded to this image of o.
  bool bonded(ParticleId p, ParticleId o, const Image& of_o = {}) const {
    for (const Entry& e : of(p))
      if (e.other == o && e.of_other == of_o) return true;
    return false;
  }

 private:
  std::size_t place(ParticleId p) const { return ends_ ? ends_->place(p) : p.value; }

  std::shared_ptr<const IdSet<ParticleId>> ends_;  // who has entries; null: all have a place
  std::vector<std::size_t> start_, end_;           // of each place's entries
  std::vector<Entry> entries_;
  std::vector<char> of_fibre_;
};

}  // namespace vbond
