#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "vbond/dynamics/rows.hpp"

namespace vbond {

/// Consecutive blocks of rows that one thread works on.
struct Part {
  std::size_t index = 0;
  std::size_t first_block = 0, last_block = 0;  ///< [first, last)
  RowRange rows{};
  /// Rows of the images of its particles, if this part adds all loads to them; else empty.
  RowRange images{};
  /// Whether this part adds the loads to this row.
  bool has(std::size_t row) const { return rows.contains(row) || images.contains(row); }
};

/// A thread has at least this much to do, in bonds and particles: some 0.1 ms. On cores of its own a team
/// would pay from a tenth of it on, but where there is other work every barrier waits for the thread that was
/// displaced.
inline constexpr std::size_t least_part = 8192;

class Crew;

/// The threads of a run and the blocks that are theirs.
class Team {
 public:
  /// work: of each block, in bonds and particles; it decides where the parts end. At least one thread.
  Team(std::size_t rows, const std::vector<std::size_t>& work, int threads);
  /// The same threads with the same parts, of which the last goes on to all of these rows. Threads of its own
  /// would take the cores from the others, which wait without sleeping.
  Team(const Team& of_fewer_rows, std::size_t rows);
  ~Team();

  /// Tells the parts which rows of images are theirs: images_of(part).
  template <class F>
  void give_images(F images_of) {
    for (Part& p : parts_) p.images = images_of(p);
  }

  std::size_t blocks() const { return blocks_; }
  const std::vector<Part>& parts() const { return parts_; }
  Block block(std::size_t b) const { return {b, {b * block_rows, std::min(rows_, (b + 1) * block_rows)}}; }
  const Part& part_of_row(std::size_t row) const;

  /// Calls f(part) for all parts at once, each in a thread; f must write only what belongs to its part. What
  /// f throws is thrown here, after all parts have ended.
  template <class F>
  void for_parts(F f) const {
    if (!crew_) return f(parts_.front());
    run([](void* work, const Part& part) { (*static_cast<F*>(work))(part); }, &f);
  }

  /// Calls f(block) for all blocks, those of a part one after the other.
  template <class F>
  void for_blocks(F f) const {
    for_parts([&](const Part& part) {
      for (std::size_t b = part.first_block; b < part.last_block; ++b) f(block(b));
    });
  }

 private:
  void run(void (*call)(void* work, const Part&), void* work) const;

  std::size_t rows_ = 0, blocks_ = 0;  // rows: filled up to a multiple of rows_at_once
  std::vector<Part> parts_;
  std::shared_ptr<Crew> crew_;  // the other threads, if there is more than one part
};

}  // namespace vbond
