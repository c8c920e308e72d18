#include <limits>
#include <system_error>

#include "campaign.hpp"
#include "commands.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/report/break_words.hpp"

namespace vbond::app {

int breaks(const std::filesystem::path& folder, bool all) {
  constexpr std::size_t usual = 100;
  const std::filesystem::path csv = folder / "breaks.csv";
  std::error_code e;
  if (std::filesystem::exists(folder / "resolved.toml", e) && !std::filesystem::exists(csv, e))
    throw IoError(csv.string() + ": there is none: no bond of this run has a strength");
  BreaksTold told = read_breaks(csv, all ? std::numeric_limits<std::size_t>::max() : usual);
  const Case c = read_case(folder / "resolved.toml");
  find_load_factors(told, c, folder);
  std::string text;
  for (const BreakTold& row : told.first) text += in_words(row, c.units) + '\n';
  if (static_cast<std::int64_t>(told.first.size()) < told.count)
    text += "these are the first " + std::to_string(told.first.size()) + "; --all tells of every one\n";
  say(text + in_words(told) + '\n');
  return done;
}

}  // namespace vbond::app
