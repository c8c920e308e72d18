#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "campaigns/judge.hpp"
#include "misuse_parts.hpp"

namespace vbond::misuse_test {
namespace {

/// Wrong inputs at random; each is refused or ends in an error of the library, and none is taken silently.
class RandomMisuse {
 public:
  explicit RandomMisuse(unsigned seed) : dice_(seed) {}

  /// How a run with one to three wrong values went: "refused", "Diverged", "accepted", or what else it threw.
  std::string outcome() {
    Parts p;
    p.body = testing::straight_rod(2 + pick(30));
    n_ = p.body.model.particles();
    p.second.loads[0].particles = {any()};
    for (std::size_t k = 1 + pick(3); k > 0; --k) spoil(p);
    try {
      const auto run = p.run();
      run->run();
    } catch (const std::invalid_argument&) {
      return "refused";
    } catch (const Diverged&) {
      return "Diverged";
    } catch (const std::exception& e) {
      return e.what();
    }
    return "accepted: " + last_;
  }

 private:
  std::size_t pick(std::size_t n) { return dice_.below(n); }
  ParticleId any() { return ParticleId{pick(n_)}; }
  template <class T>
  ParticleId any_of(PerParticle<T>& column) {  // another mistake may have changed its size
    if (column.empty()) column.resize(1);
    return ParticleId{pick(column.size())};
  }
  ParticleId none() { return ParticleId{n_ + pick(3) * pick(1000000000)}; }
  double bad() { return dice_.one_of({nan, infinite, -infinite}); }
  double below() { return dice_.one_of({nan, infinite, -infinite, 0.0, -1.0, -1e300}); }
  std::size_t other_size() { return pick(2) == 0 ? pick(n_) : n_ + 1 + pick(50); }
  Vec3d bad_vector() {
    Vec3d x{1, 2, 3};
    component(x, static_cast<int>(pick(3))) = bad();
    return x;
  }

  void spoil(Parts& p) {
    State& s = p.body.state;
    Model& m = p.body.model;
    Stage& stage = pick(2) == 0 ? p.first : p.second;
    const std::size_t kind = pick(33);
    last_ = std::to_string(kind);
    switch (kind) {
      case 0: return s.r.resize(other_size());
      case 1: return s.v.resize(other_size());
      case 2: return s.q.resize(other_size());
      case 3: return s.omega.resize(other_size());
      case 4: return m.mass.resize(other_size(), 1.0);
      case 5: return m.inertia.resize(other_size(), 1.0);
      case 6: return m.radius.resize(other_size());
      case 7: return m.r_0.resize(other_size());
      case 8: return m.specimen.resize(1 + other_size() + n_);
      case 9: s.bonds[BondId{0}].i = none(); return;
      case 10: s.bonds[BondId{0}].j = s.bonds[BondId{0}].i; return;
      case 11: m.groups[0].particles.push_back(none()); return;
      case 12: s.clock.stage = pick(2) == 0 ? -1 : static_cast<std::int32_t>(3 + pick(1000000)); return;
      case 13: s.clock.stage_step = -1; return;
      case 14: s.clock.dt = bad(); return;
      case 15: stage.dt = below(); return;
      case 16: stage.stops.duration = pick(2) == 0 ? nan : 0.0; return;
      case 17: stage.gravity = bad_vector(); return;
      case 18: stage.b_rotation = bad(); return;
      case 19: stage.supports.push_back(testing::held({none()}, testing::clamped)); return;
      case 20: stage.supports.push_back(testing::held({any()}, testing::clamped, bad_vector())); return;
      case 21: stage.loads.push_back({"", {any(), none()}, {}, {}, {}}); return;
      case 22: stage.loads.push_back({"", {any()}, bad_vector(), {}, {}}); return;
      case 23: stage.loads.push_back({"", {any()}, {}, {}, {{{bad(), 1.0}, {0.0, 1.0}}}}); return;
      case 24: stage.strain = StrainProgram{{none()}, {1, 0, 0}, {}, 1e-3, 0.1}; return;
      case 25: stage.strain = StrainProgram{{any()}, {1, 0, 0}, {}, 1e-3, below()}; return;
      case 26: stage.stops.distance = {any(), none(), 1.0, true}; return;
      case 27: stage.stops.peak = PeakStop{PeakQuantity::reaction, {any()}, {0, 0, 0}, 0.1, 1.0}; return;
      case 28: stage.stops.rest = RestStop{below(), 1.0}; return;
      case 29:
        stage.bonding = {{"", std::vector<char>(other_size()), std::vector<char>(n_), 1.0, {}}};
        return;
      case 30: s.r[any_of(s.r)] = bad_vector(); return;
      case 31: s.v[any_of(s.v)] = bad_vector(); return;
      case 32: s.q[any_of(s.q)] = {1, dice_(0.01, 1.0), 0, bad()}; return;
    }
  }

  testing::Dice dice_;
  std::size_t n_ = 0;
  std::string last_;
};

// Sixty wrong inputs for each case.
TEST(Misuse, AtRandomIsNeverTakenSilently) {
  const testing::Tally all = testing::campaign("misuse", 10, [](unsigned seed, testing::Tally& tally) {
    for (unsigned k = 60 * (seed - 1); k < 60 * seed; ++k) {
      const std::string outcome = RandomMisuse(k).outcome();
      EXPECT_TRUE(outcome == "refused" || outcome == "Diverged") << k << ": " << outcome;
      tally.add(outcome);
    }
  });
  EXPECT_GT(all.sum("refused"), all.full ? 55 * all.cases : 0);
}

}  // namespace
}  // namespace vbond::misuse_test
