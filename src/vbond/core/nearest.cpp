#include "vbond/core/nearest.hpp"

#include <algorithm>
#include <cstddef>

namespace vbond {
namespace {

constexpr std::size_t short_word = 3;         // up to this length another letter makes another word
constexpr std::size_t longest_compared = 64;  // the distance costs length^2, and no key is longer

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c == '-' ? '_' : c;
}

/// Optimal string alignment distance, three rows at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped =
          i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// True if the two differ in letters and not in their order or number, as "bcc" and "fcc" do.
bool has_other_letters(std::string_view a, std::string_view b) {
  const auto sorted = [](std::string_view word) {
    std::string letters;
    for (const char c : word) letters += lower(c);
    std::sort(letters.begin(), letters.end());
    return letters;
  };
  return a.size() == b.size() && sorted(a) != sorted(b);
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view wrong, const std::vector<std::string>& names) {
  if (wrong.size() > longest_compared) return std::nullopt;
  std::optional<std::string> best;
  std::size_t least = longest_compared;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(wrong, name);
    // a third of the letters may be wrong: more is another word; an abbreviation of three or more letters
    // will do
    const bool abbreviation = wrong.size() >= 3 && name.compare(0, wrong.size(), wrong) == 0;
    const bool close =
        distance <= std::max<std::size_t>(1, std::max(wrong.size(), name.size()) / 3) || abbreviation;
    const bool another_word = wrong.size() <= short_word && has_other_letters(wrong, name);
    if (close && !another_word && distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

}  // namespace vbond
