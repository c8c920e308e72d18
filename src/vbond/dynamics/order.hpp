#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "vbond/dynamics/rows.hpp"
#include "vbond/model/bond.hpp"

namespace vbond {

/// The row of each particle. All those that stand in none of their own may share one, and take no room then.
class RowOf {
 public:
  RowOf() = default;
  explicit RowOf(PerParticle<Row> rows) : row_(std::move(rows)) {}
  /// Of these particles alone; all others are in that one row.
  RowOf(PerParticle<Row> rows, std::shared_ptr<const IdSet<ParticleId>> some, Row others)
      : row_(std::move(rows)), others_(others) {
    row_.hold(std::move(some));
  }

  Row operator[](ParticleId p) const { return row_.holds_all() || row_.holds(p) ? row_[p] : others_; }
  std::size_t size() const { return row_.size(); }  ///< of the whole body
  IdRange<ParticleId> ids() const { return row_.ids(); }
  /// Those that have a row of their own; null: all.
  const std::shared_ptr<const IdSet<ParticleId>>& held() const { return row_.held(); }

 private:
  PerParticle<Row> row_;
  Row others_;
};

/// Which particle stands in which row, and back. All particles have a row. Of a body that is stepped in
/// parts, each by a process of its own, the first rows are those of the part. They are taken 4096 at a time;
/// in each such slab those that move early come last, so that few blocks have any. Then come its own ghosts,
/// particles of other parts and images of any that it may touch or is bonded to. All others may share one row
/// behind these; what stands there is not known.
struct Order {
  PerRow<ParticleId> particle;
  RowOf row;
  std::size_t own = 0;             ///< rows [0, own) are moved here
  std::size_t ghosts = 0;          ///< rows [ghosts, known) are ghosts; those before them, if any, are empty
  std::size_t known = 0;           ///< rows [0, known) have the pose of now
  std::vector<char> early_blocks;  ///< of each block of own rows, whether some move early; empty: none
  /// Bonds with ghosts are worked on with the blocks of the ghosts, after all others: until then poses of
  /// ghosts may be on their way.
  bool ghost_bonds_last = false;

  /// Of a periodic body: which image of its particle each ghost is; empty: ghosts, if any, are particles of
  /// other parts.
  std::vector<Image> images;
  std::vector<Row> by_image;  ///< those rows, in order of particles and images

  /// Of a known row.
  Image image(Row k) const { return k.value < ghosts || images.empty() ? Image{} : images[k.value - ghosts]; }
  ImageOf image_of(Row k) const { return {particle[k], image(k)}; }
  /// The row of this image of a particle, which some row must be.
  Row row_of(ParticleId p, const Image& n) const { return find(p, n).value(); }
  /// The rows of the two ends of a bond.
  Row row_i(const Bond& b) const { return row[b.i]; }
  Row row_j(const Bond& b) const { return row_of(b.j, image_of_j(b)); }
  /// The same, of one that may be none.
  std::optional<Row> find(ParticleId p, const Image& n) const;

  bool is_empty(Row k) const { return k.value >= own && k.value < ghosts; }
  bool is_early(std::size_t block) const { return block < early_blocks.size() && early_blocks[block] != 0; }
  bool has(ParticleId p) const { return row[p].value < own; }
  bool knows(ParticleId p) const { return row[p].value < known; }
  /// A column for the particles that have a row of their own.
  template <class T>
  PerParticle<T> column() const {
    PerParticle<T> values;
    values.assign(row.size(), T{});
    values.hold(row.held());
    return values;
  }
};

/// Whether the pair of these known rows is the concern of this part: that of its first particle. Of a
/// particle and an image of another, and of the same two seen from the other, the first is; of a particle and
/// its own images those that are > 0.
inline bool is_worked_out_here(const Order& order, Row i, Row j) {
  const ParticleId p = order.particle[i], q = order.particle[j];
  if (p == q) {
    const Row lower = std::min(i, j), upper = std::max(i, j);
    return lower.value < order.own && order.image(upper) > Image{};
  }
  return p < q ? i.value < order.own : j.value < order.own;
}

/// Sorts particles by layers one spacing thick: first along the body's longest direction, then the next,
/// then the shortest. Neighbours then lie in a few streams that memory delivers ahead of need; sorting by
/// cells was slower (docs/decisions/data-layout.md). The order depends on the positions alone: from the first
/// positions of a model it is the same for every stage and after a checkpoint.
Order spatial_order(const PerParticle<Vec3d>& r);
/// The same of some particles, for part_of(): all others share one row, in which one of them stands.
Order spatial_order(const PerParticle<Vec3d>& r, const std::vector<ParticleId>& some);

/// The particles that a part of a body has, and its ghosts, each of them once. Of its own, some are to move
/// before all others: ghosts of other parts, those that have images, and those bonded to ghosts if such bonds
/// are worked on last.
struct Holding {
  std::vector<ParticleId> own, early;
  std::vector<ImageOf> ghosts;
  bool ghost_bonds_last = false;   ///< see Order
  bool apart = false;              ///< empty rows fill up the last rows_at_once before the ghosts
  bool others_in_one_row = false;  ///< all others share the last row; else each has one of its own
};

/// The order of a part of a body: otherwise as that of the whole.
Order part_of(const Order& whole, const Holding& holding);

}  // namespace vbond
