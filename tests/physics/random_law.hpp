#pragma once
#include <gtest/gtest.h>

#include "hardening_law.hpp"
#include "random_pose.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond::testing {

/// Laws as types of a typed test.
template <class... Lists>
struct TypesOf;
template <template <class> class... L, template <class> class... Own>
struct TypesOf<LawList<L...>, LawList<Own...>> {
  using Types = ::testing::Types<L<double>..., Own<double>...>;
};
/// Those of the library, and one of a program's own with what the library makes of it.
using Laws = TypesOf<BondLaws, WithAllRules<Hardening>>::Types;

/// A law with any stiffnesses of order one and, where they do not follow from these, coefficients up to one.
template <class Law>
Law random_law(PoseSource& random) {
  const double a = random.uniform(0.2, 1.5), R_i = random.uniform(0.0, 0.6), R_j = random.uniform(0.0, 0.6);
  const BondStiffness<double> c{random.uniform(0.5, 2.0), random.uniform(0.2, 2.0), random.uniform(0.1, 1.0),
                                random.uniform(0.1, 1.0)};
  Law law = Law::from(c, a, R_i, R_j);
  for (const LawField<Law>& field : Law::fields())
    if (field.info.input == LawInput::given) law.*field.at = random.uniform(-1.0, 1.0);
  return law;
}

}  // namespace vbond::testing
