#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "dynamics/rods.hpp"
#include "vbond/run/run.hpp"

/// What a program may do wrong with a Run.
namespace vbond::misuse_test {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// All that a Run is made of.
struct Parts {
  testing::Specimen body = testing::straight_rod(4);
  Stage first = testing::plain_stage(0.05, 1.0), second = testing::plain_stage(0.05, 1.0);
  int threads = 1;

  Parts() {
    second.name = "second";
    second.supports = {testing::held({ParticleId{0}}, testing::clamped)};
    second.loads = {PointLoad{"end", {ParticleId{3}}, {0, 1e-3, 0}, {}, {}}};
  }
  std::unique_ptr<vbond::Run> run() const {
    return std::make_unique<vbond::Run>(body.model, body.state, std::vector<AnyStage>{first, second},
                                        threads);
  }
};

/// What std::invalid_argument says to what is done with a Run.
inline std::string refusal(const std::function<void()>& misuse) {
  try {
    misuse();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "not refused";
}

inline void expect_refusal(const std::function<void()>& misuse, const std::string& part) {
  const std::string text = refusal(misuse);
  EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "', not '" << part << "'";
}

/// Refused as the run is made or as it begins, before any step.
template <class Change>
void refuses(Change change, const std::string& part) {
  Parts parts;
  change(parts);
  expect_refusal([&parts] { parts.run()->run(); }, part);
}

}  // namespace vbond::misuse_test
