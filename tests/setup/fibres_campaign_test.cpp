#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "plain_fibres.hpp"
#include "vbond/core/random.hpp"

#include "../campaigns/judge.hpp"

namespace vbond::fibres_campaign_test {
namespace {

using plain_fibres::Chains;
using plain_fibres::contour;
using vbond::testing::Tally;
using vbond::testing::Verdict;

/// A request by chance, impossible ones among them.
struct Request {
  double diameter, length, gap, wanted;  ///< wanted: fibres, or below 1 a volume share
  bool by_share, in_cell;
  std::string shape, vessel;
  double volume;
  double curl = 1.0;

  std::string amount(double n) const {
    return by_share ? "volume_share = " + std::to_string(n) : "fibres = " + std::to_string(std::lround(n));
  }
  Case with(double n) const {
    std::string keys = amount(n) + "\n" + shape;
    return plain_fibres::fibres(in_cell ? keys : keys + vessel, in_cell ? vessel : "");
  }
};

std::string list(const std::vector<double>& x) {
  std::string text = "[";
  for (const double v : x) text += (text.size() > 1 ? ", " : "") + std::to_string(v);
  return text + "]";
}

Request request(unsigned seed) {
  Random random(seed);
  // as many digits as the text of the case has
  const auto rounded = [](double x) { return std::round(1e4 * x) / 1e4; };
  const auto from = [&](double low, double high) { return rounded(low + (high - low) * random.uniform()); };
  Request q{};
  q.diameter = from(0.2, 0.5);
  const double spacing = rounded(q.diameter * from(1.0, 3.0) + 1e-4), side = from(2.5, 5.0);
  q.length = std::max(rounded(1.05 * spacing), from(1.0, 5.0));
  q.gap = random.uniform() < 0.5 ? 0.0 : rounded(0.3 * q.diameter * random.uniform());
  q.by_share = random.uniform() < 0.5;
  q.wanted = q.by_share ? rounded(std::pow(10.0, from(-2.5, -0.3))) : std::floor(from(1.0, 250.0));
  q.shape = "diameter = " + std::to_string(q.diameter) + "\nspacing = " + std::to_string(spacing) +
            "\ngap = " + std::to_string(q.gap) + "\nmass = 1\nseed = " + std::to_string(seed) + "\n";
  if (random.uniform() < 0.7)
    q.shape += "length = " + std::to_string(q.length) + "\n";
  else
    q.shape += "lengths = { uniform = { min = " + std::to_string(1.02 * spacing) +
               ", max = " + std::to_string(q.length) + " } }\n";
  if (random.uniform() < 0.4) q.shape += "curl = " + std::to_string(q.curl = from(0.5, 1.0)) + "\n";
  const double kind = random.uniform();
  if (kind < 0.3) {
    q.shape += "orientation = \"planar\"\nnormal = " + list({from(-1, 1), from(-1, 1), 1.0}) + "\n";
  } else if (kind < 0.6) {
    const double a = from(0.1, 0.8), b = (1 - a) * random.uniform(), c = 1 - a - b,
                 r = 0.5 * std::sqrt(a * b);
    q.shape += "orientation = \"tensor\"\norientation_tensor = " + list({a, b, c, r, 0, 0}) + "\n";
  }
  const double vessel = random.uniform(), height = rounded(side * from(0.1, 1.0));
  q.in_cell = vessel < 0.5;
  q.volume = side * side * height;
  if (q.in_cell)
    q.vessel = "[cell]\na = " + list({side, 0, 0}) +
               "\nb = " + list({vessel < 0.25 ? rounded(0.3 * side) : 0.0, side, 0}) +
               "\nc = " + list({0, 0, height}) + (vessel < 0.35 ? "\nopen = [\"c\"]" : "") + "\n";
  else
    q.vessel = std::string(vessel < 0.75 ? "box" : "layer") +
               " = { min = [0, 0, 0], max = " + list({side, side, height}) + " }\n";
  return q;
}

/// What is wrong with the fibres of a request, as it stands in the built case alone.
std::string mistakes(const Request& q, double wanted, const Built& b) {
  const Chains chains = plain_fibres::chains_of(b);
  if (chains.points.empty()) return "no fibre";
  const double least = plain_fibres::least_distance(chains, q.diameter + q.gap);
  if (least < (q.diameter + q.gap) * (1 - 1e-9))
    return "axes are " + std::to_string(least) + " apart instead of " + std::to_string(q.diameter + q.gap);
  double all = 0.0;
  for (const auto& p : chains.points) {
    const double L = contour(p);
    all += L;
    if (L > q.length * (1 + 1e-9)) return "a fibre is too long";
    if (std::abs(norm(p.back() - p.front()) / L - q.curl) > 1e-6) return "a fibre has another curl";
  }
  const double section = 0.25 * std::numbers::pi * q.diameter * q.diameter;
  if (!q.by_share && chains.points.size() != std::size_t(std::lround(wanted))) return "another number";
  // half a fibre of mean length, and half of the range of lengths, by which a few that are drawn may be off
  if (q.by_share &&
      std::abs(section * all / q.volume - wanted) > section * q.length / q.volume + 0.01 * wanted)
    return "another share: " + std::to_string(section * all / q.volume);
  if (q.in_cell) return "";
  for (const auto& p : chains.points)
    for (const Vec3d& r : p)
      if (r.z < 0.5 * q.diameter * (1 - 1e-9)) return "a fibre is outside";
  return "";
}

/// The number after these words, or NaN.
double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == std::string::npos ? NAN : std::stod(text.substr(at + words.size()));
}

// Every request is reached as it was asked for, or refused: as too dense, with what fits, which is then tried
// and reached (or a little less is); or since not even one fibre fits.
TEST(FibreCampaign, RequestsAreReachedOrRefusedWithWhatIsPossible) {
  const Tally tally = vbond::testing::campaign("fibres", 11, [](unsigned seed) -> Verdict {
    const Request q = request(seed);
    std::string text;
    try {
      const std::string wrong = mistakes(q, q.wanted, build(q.with(q.wanted)));
      return wrong.empty() ? Verdict{"reached"} : vbond::testing::wrong(wrong);
    } catch (const CaseError& e) {
      text = e.what();
    }
    for (const char* reason :
         {"does not fit in between", "meets its own image", "must be shorter than half of that",
          "meets itself", "has one bond and is straight", "is no fibre"})
      if (text.find(reason) != std::string::npos) return {"refused: no single fibre"};
    const double possible = number_after(text, q.by_share ? "use volume_share = " : "use fibres = ");
    if (std::isnan(possible)) return vbond::testing::wrong("refused by other words: " + text);
    if (!(possible < q.wanted)) return vbond::testing::wrong("what is possible is not less: " + text);
    for (const double part : {1.0, 0.9}) try {
        const double n = q.by_share ? part * possible : std::floor(part * possible);
        const std::string wrong = mistakes(q, n, build(q.with(n)));
        if (!wrong.empty()) return vbond::testing::wrong("what was called possible: " + wrong);
        return {part == 1.0 ? "refused, the possible was reached"
                            : "refused, nine tenths of the possible were reached"};
      } catch (const CaseError& e) {
        text = e.what();
      }
    return {"refused, nine tenths of the possible were refused again", text};
  });
  if (!tally.full) return;
  EXPECT_GE(tally["reached"], 1u);
}

}  // namespace
}  // namespace vbond::fibres_campaign_test
