#include "vbond/dynamics/exchange.hpp"

#include <cstring>

namespace vbond {
namespace {

class OneRank : public Exchange {
 public:
  void halo(const HaloColumns&) override {}
  void reverse_sum(std::span<LoadRow>) override {}
  void sum(std::span<double>) const override {}
  void max(std::span<double>) const override {}
  int ranks() const override { return 1; }
  int rank() const override { return 0; }
  void gather_bytes(std::span<const std::byte> mine, const Room& room) const override {
    std::byte* const all = room(mine.size());
    if (!mine.empty()) std::memcpy(all, mine.data(), mine.size());
  }
  void together(const std::function<void()>& work) const override { work(); }
};

}  // namespace

Exchange& one_rank() {
  static OneRank rank;
  return rank;
}

}  // namespace vbond
