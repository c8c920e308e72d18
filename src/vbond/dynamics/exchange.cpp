#include "vbond/dynamics/exchange.hpp"

namespace vbond {
namespace {

class OneRank final : public Exchange {
 public:
  void begin_halo(const HaloColumns&) override {}
  void end_halo(const HaloColumns&) override {}
  void reverse_sum(std::span<LoadRow>) override {}
};

}  // namespace

Exchange& one_rank() {
  static OneRank rank;
  return rank;
}

}  // namespace vbond
