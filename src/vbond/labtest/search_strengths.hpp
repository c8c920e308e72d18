#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Limits of bonds for a body with these strengths: docs/material.md.
namespace vbond::labtest {

/// What the limits of all bonds are multiplied by, > 0: those in tension, and those in shear.
struct StrengthFactors {
  double tension = 1, shear = 1;
};

/// Strengths of a body in tension and compression, > 0  [force/length^2], and its fracture toughness, > 0
/// [force/length^1.5].
struct Strengths {
  std::optional<double> tensile, compressive;
  std::optional<double> toughness = {};
};

/// What the tests of a body say. A strength that was asked for is absent if there is none, and `why` says so.
struct StrengthsFound {
  Strengths strengths;
  std::string why;
};

/// Tests a body with these factors: for each strength that has a number in `asked`, a test.
using StrengthTests = std::function<StrengthsFound(const StrengthFactors&, const Strengths& asked)>;

struct StrengthGoal {
  Strengths asked;       ///< one or more
  double within = 0.01;  ///< of each, relative, > 0
};

/// Factors that were tested, and what came out.
struct StrengthEvaluation {
  StrengthFactors factors;
  StrengthsFound found;
  /// Compressive over tensile strength; absent without both.
  std::optional<double> ratio() const {
    const Strengths& s = found.strengths;
    if (!s.tensile || !s.compressive) return std::nullopt;
    return *s.compressive / *s.tensile;
  }
};

enum class StrengthSearchEnd : std::uint8_t {
  reached,
  no_strength,   ///< the body as it is has none: nothing to begin with
  out_of_reach,  ///< no ratio of factors that was looked at gives the ratio of the strengths
  jumps,         ///< from one ratio of factors to the next the strengths jump over those asked for
  grains,        ///< toughness over strength is another one, and no limits change that
  no_scaling,    ///< strengths do not follow the factors: the strains are large
  given_up       ///< after `most_strength_tests` evaluations
};

struct StrengthSearch {
  StrengthSearchEnd end = StrengthSearchEnd::no_strength;
  std::vector<StrengthEvaluation> all;  ///< in their order
  std::optional<std::size_t>
      nearest;  ///< reached: the one that is; else the nearest by ratio, or by strength
  /// The least and the largest ratio of strengths that was found; absent unless both were asked for.
  std::optional<std::pair<double, double>> ratios;
  /// jumps: the factors of shear over tension on both sides, and their ratios of strengths.
  std::optional<std::pair<StrengthEvaluation, StrengthEvaluation>> jump;
};

/// Factors of shear over those of tension are looked at from 1/64 to 64.
inline constexpr int most_doublings = 6;
inline constexpr std::size_t most_strength_tests = 60;

/// By what factor grains are to be larger for the toughness asked for over the strength asked for: the square
/// of that ratio over the one found, since a packing has K = s sqrt(pi alpha R) with its strength s and radii
/// R. Of the tensile strength, or of the compressive one if that alone was asked for. All of `asked` must be
/// found.
double larger_grains(const Strengths& asked, const Strengths& found);

/// Whether the tests found what is asked for.
bool meets(const StrengthGoal& goal, const Strengths& found);

/// Looks for factors with which the tests find the strengths that are asked for. The one that is reported was
/// tested: nothing is extrapolated.
///
/// By similarity, as long as strains are small, strengths of a body are T = t f(s) and C = t g(s), with t and
/// t s the factors of tension and shear. So s follows from C/T, and t is set by each test for the next. With
/// one strength asked for s stays 1. With both s is doubled, or halved, until C/T is bracketed; one direction
/// ends after most_doublings, without a strength, or once two steps in a row have changed C/T by less than
/// 1 %, or have led away. Then the other is looked at, too. Within the bracket see crossing().
///
/// Toughness goes with a common factor as strengths do. With it alone s stays 1. With strengths, these are
/// found first; then the toughness is tested, and all are met by one more common factor, or cannot be:
/// `grains`.
///
/// Throws std::invalid_argument if nothing is asked for, or if a number is not positive.
StrengthSearch search_strengths(const StrengthGoal& goal, const StrengthTests& tests);

}  // namespace vbond::labtest
