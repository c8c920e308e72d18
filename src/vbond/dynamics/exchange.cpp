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
  bool leads() const override { return true; }
  void gather_bytes(std::span<const std::byte> mine, bool, const Room& room) const override {
    std::byte* const all = room(mine.size());
    if (!mine.empty()) std::memcpy(all, mine.data(), mine.size());
  }
};

}  // namespace

Exchange& one_rank() {
  static OneRank rank;
  return rank;
}

}  // namespace vbond
