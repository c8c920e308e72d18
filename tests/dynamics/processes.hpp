#pragma once
#include <algorithm>
#include <barrier>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "vbond/dynamics/exchange.hpp"

/// Threads that stand for the processes which share a body.
namespace vbond::testing {

struct Meeting {
  explicit Meeting(std::size_t processes)
      : all_here(static_cast<std::ptrdiff_t>(processes)),
        numbers(processes),
        bytes(processes),
        sizes(processes) {}
  std::barrier<> all_here;
  std::vector<std::vector<double>> numbers;
  std::vector<std::span<const std::byte>> bytes;
  std::vector<std::vector<std::size_t>> sizes;  // of what is for each process
};

/// A ghost that is an image, and where its particle is.
struct ImageRow {
  std::size_t row;
  Image image;
  Vec3d r;
};

/// Ghosts have what the state has that each begins with, images their places: nothing moves. Base: an
/// Exchange.
template <class Base>
class ProcessOf : public Base {
 public:
  ProcessOf(Meeting& meeting, std::size_t rank) : meeting_(meeting), rank_(rank) {}

  void begin_halo(const HaloColumns& columns) override {
    for (const ImageRow& g : images) {
      columns.pose[g.row].r = g.r;
      columns.carry(g.row, g.image);
    }
  }
  void end_halo(const HaloColumns&) override {}
  void reverse_sum(std::span<LoadRow>) override {}
  void sum(std::span<double> x) const override {
    combine(x, [](double a, double b) { return a + b; });
  }
  void max(std::span<double> x) const override {
    combine(x, [](double a, double b) { return std::max(a, b); });
  }
  int ranks() const override { return static_cast<int>(meeting_.bytes.size()); }
  int rank() const override { return static_cast<int>(rank_); }
  std::int64_t steps_between_meetings() const override { return 64; }
  void gather_bytes(std::span<const std::byte> mine, const Communicator::Room& room) const override {
    meeting_.bytes[rank_] = mine;
    meeting_.all_here.arrive_and_wait();
    largest_gather = std::max(largest_gather, take_all(room));
    meeting_.all_here.arrive_and_wait();
  }
  std::vector<std::size_t> swap_bytes(std::span<const std::byte> mine, const std::vector<std::size_t>& sizes,
                                      const Communicator::Room& room) const override {
    meeting_.bytes[rank_] = mine, meeting_.sizes[rank_] = sizes;
    meeting_.all_here.arrive_and_wait();
    std::vector<std::size_t> come;
    std::vector<std::byte> all;
    for (std::size_t k = 0; k < meeting_.bytes.size(); ++k) {
      const std::vector<std::size_t>& of_k = meeting_.sizes[k];
      const std::size_t first =
          std::accumulate(of_k.begin(), of_k.begin() + static_cast<std::ptrdiff_t>(rank_), std::size_t{0});
      const std::span<const std::byte> for_this = meeting_.bytes[k].subspan(first, of_k[rank_]);
      all.insert(all.end(), for_this.begin(), for_this.end());
      come.push_back(for_this.size());
    }
    std::byte* const to = room(all.size());
    if (!all.empty()) std::memcpy(to, all.data(), all.size());
    meeting_.all_here.arrive_and_wait();
    return come;
  }
  void send_bytes_to_leader(std::span<const std::byte> mine, const Communicator::Room& room) const override {
    meeting_.bytes[rank_] = mine;
    meeting_.all_here.arrive_and_wait();
    if (rank_ == 0) take_all(room);
    meeting_.all_here.arrive_and_wait();
  }

  std::vector<ImageRow> images;
  mutable std::size_t largest_gather = 0;  ///< of all processes together  [bytes]

 private:
  std::size_t take_all(const Communicator::Room& room) const {
    std::size_t size = 0;
    for (const auto& b : meeting_.bytes) size += b.size();
    std::byte* to = room(size);
    for (const auto& b : meeting_.bytes) {
      if (!b.empty()) std::memcpy(to, b.data(), b.size());
      to += b.size();
    }
    return size;
  }
  template <class Op>
  void combine(std::span<double> x, Op op) const {
    meeting_.numbers[rank_].assign(x.begin(), x.end());
    meeting_.all_here.arrive_and_wait();
    for (std::size_t k = 0; k < x.size(); ++k) {
      x[k] = meeting_.numbers[0][k];
      for (std::size_t rank = 1; rank < meeting_.numbers.size(); ++rank)
        x[k] = op(x[k], meeting_.numbers[rank][k]);
    }
    meeting_.all_here.arrive_and_wait();
  }
  Meeting& meeting_;
  std::size_t rank_;
};
using Process = ProcessOf<Exchange>;

}  // namespace vbond::testing
