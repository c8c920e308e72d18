#include "vbond/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "vbond/core/error.hpp"
#include "vbond/report/block.hpp"
#include "vbond/report/detail/page_json.hpp"

namespace vbond::page {
namespace {

/// Nine digits are more than a plot shows, and half the size. Null for what is not finite.
Json to_json(double x) {
  if (!std::isfinite(x)) return {};
  const std::string text = fmt::format("{:.9g}", x);
  double rounded = x;  // kept if rounding leaves the range of double
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return rounded;
}

Json history_json(const History& h, bool si, const std::vector<std::size_t>& rows) {
  Json columns = Json::array(), values = Json::array();
  for (const HistoryColumn& c : h.columns) {
    columns.push_back({{"name", c.name}, {"unit", si ? unit_of_column(c.name) : ""}});
    Json column = Json::array();
    for (const std::size_t r : rows) column.push_back(to_json(c.values[r]));
    values.push_back(std::move(column));
  }
  return {{"columns", columns}, {"rows_in_file", h.rows()}, {"values", std::move(values)}};
}

Json breaks_json(const BreaksTold& told, UnitSystem units) {
  Json first = Json::array();
  for (const BreakTold& b : told.first)
    first.push_back({{"step", b.step},
                     {"when", when_in_words(b, units)},
                     {"bond", b.bond},
                     {"i", b.i},
                     {"j", b.j},
                     {"mode", static_cast<int>(break_mode(b.mode))},
                     {"cause", cause_in_words(b, units)},
                     {"energy", to_json(b.energy)}});
  return {{"count", told.count}, {"words", in_words(told)}, {"first", std::move(first)}};
}

/// What of the run's story goes into a page. Modes are shown whole or not at all.
struct Cut {
  bool frames = true;            ///< false: no sequences
  std::size_t stride = 1;        ///< of the run's frames
  std::size_t modes = 0;         ///< the first ones
  std::size_t history_rows = 0;  ///< at most
};

std::vector<std::size_t> kept_frames(const Sequence& s, const Cut& cut) {
  return thinned(s.frames.size(), s.kind == SequenceKind::run ? cut.stride : 1);
}

Json radius_json(const std::vector<float>& radius, Block& block) {
  if (radius.empty()) return 0.0;
  const bool equal = std::all_of(radius.begin(), radius.end(), [&](float R) { return R == radius[0]; });
  return equal ? Json(radius[0]) : to_json(block.add(radius));
}

Json stages_json(const std::vector<StageHolds>& stages, Block& block) {
  Json all = Json::array();
  for (const StageHolds& s : stages)
    all.push_back({{"name", s.name},
                   {"held", to_json(block.add(s.held))},
                   {"how", to_json(block.add(s.how))},
                   {"loaded", to_json(block.add(s.loaded))},
                   {"loads", to_json(block.add(s.loads))}});
  return all;
}

const Sequence* run_of(const Report& report) {
  for (const Sequence& s : report.sequences)
    if (s.kind == SequenceKind::run) return &s;
  return nullptr;
}

std::size_t modes_of(const Report& report) {
  return report.sequences.size() - (run_of(report) ? 1 : 0);
}

/// Sequences that stay, in their order.
std::vector<const Sequence*> kept_sequences(const Report& report, const Cut& cut) {
  std::vector<const Sequence*> kept;
  std::size_t modes = 0;
  for (const Sequence& s : report.sequences)
    if (cut.frames && (s.kind == SequenceKind::run || modes++ < cut.modes)) kept.push_back(&s);
  return kept;
}

/// Steps of the frames that stay, for the rows of history that go with them.
std::vector<std::int64_t> steps_of(const Report& report, const Cut& cut) {
  std::vector<std::int64_t> steps;
  if (const Sequence* run = run_of(report); run && cut.frames)
    for (const std::size_t f : kept_frames(*run, cut)) steps.push_back(run->frames[f].step);
  return steps;
}

std::vector<std::string> left_out(const Report& report, const PageLimits& limits, const Cut& cut,
                                  std::size_t rows) {
  std::vector<std::string> all = report.left_out;
  const std::string below =
      fmt::format("so that the page stays below {:g} MB", static_cast<double>(limits.bytes) / 1e6);
  const Sequence* run = run_of(report);
  if (cut.frames && cut.modes < modes_of(report))
    all.push_back(fmt::format("The first {} of the {} modes are shown, {}. ParaView shows them all.",
                              cut.modes, modes_of(report), below));
  if (cut.frames && cut.stride > 1 && run)
    all.push_back(fmt::format("One frame in {} is shown, and the last one: {} of {}, {}.", cut.stride,
                              kept_frames(*run, cut).size(), run->frames.size(), below));
  if (rows < report.history.rows())
    all.push_back(fmt::format(
        "Plots show {} of the {} rows of history.csv{}: those of the frames, and the "
        "smallest and largest values of every column in each stretch between.",
        rows, report.history.rows(), cut.history_rows < limits.history_rows ? ", " + below : std::string()));
  if (report.history.rows() > 0) all.push_back("Numbers of the plots are rounded to 9 digits.");
  if (!kept_sequences(report, cut).empty())
    all.push_back(
        "Colours of the 3D view have 255 steps between the smallest and the largest value of all frames, "
        "displacements 65,535 steps in each direction.");
  if (report.case_text.size() > limits.case_bytes)
    all.push_back("The case is too long for this page: it stands in resolved.toml.");
  return all;
}

/// Why the page has no sequence.
std::string why_no_frames(const Report& report, const PageLimits& limits) {
  if (report.sequences.empty()) return report.no_frames;
  return fmt::format(
      "No frames are shown: even two of them do not fit into a page of {:g} MB. ParaView shows them.",
      static_cast<double>(limits.bytes) / 1e6);
}

/// What needs no look at the frames.
Json words_json(const Report& report, const PageLimits& limits) {
  const auto pairs = [](const Lines& lines) {
    Json j = Json::array();
    for (const auto& [name, value] : lines) j.push_back(Json::array({name, value}));
    return j;
  };
  Json warnings = Json::array(), plots = Json::array();
  for (const Warning& w : report.warnings)
    warnings.push_back({{"level", to_text(w.level)}, {"text", w.text}});
  for (const Plot& p : preset_plots(report.history))
    plots.push_back({{"title", p.title}, {"x", p.x}, {"y", p.y}});
  const bool long_case = report.case_text.size() > limits.case_bytes;
  Json j{{"format", 1},
         {"program", report.program},
         {"title", report.title},
         {"units", report.units == UnitSystem::si ? "SI" : "reduced"}};
  j["facts"] = pairs(report.facts);
  j["results"] = pairs(report.results);
  j["warnings"] = std::move(warnings);
  j["rerun"] = {{"command", report.command}, {"case", long_case ? std::string() : report.case_text}};
  j["plots"] = std::move(plots);
  j["clock"] = clock_of(report.history);
  j["over"] = axis_of(report.history);
  if (report.live) j["live"] = *report.live;
  return j;
}

struct Packed {
  std::string json, block;
};

Packed pack(const Report& report, const PageLimits& limits, const Cut& cut) {
  Block block;
  const auto rows = rows_to_keep(report.history, steps_of(report, cut), cut.history_rows);
  const std::vector<const Sequence*> shown = kept_sequences(report, cut);
  Json j = words_json(report, limits), sequences = Json::array();
  j["left_out"] = left_out(report, limits, cut, rows.size());
  j["history"] = history_json(report.history, report.units == UnitSystem::si, rows);
  if (report.breaks.count > 0) j["breaks"] = breaks_json(report.breaks, report.units);
  j["radius"] = cut.frames ? radius_json(report.body.radius, block) : Json(0.0);
  j["bonds"] = to_json(block.add(cut.frames ? report.body.bonds : std::vector<std::uint32_t>{}));
  if (cut.frames && !report.body.capsules.empty())
    j["bond_radius"] = to_json(block.add(report.body.capsules));
  if (cut.frames && !report.body.images.empty()) j["bond_image"] = to_json(block.add(report.body.images));
  for (const Sequence* s : shown) sequences.push_back(sequence_json(*s, report, kept_frames(*s, cut), block));
  if (!shown.empty() && !report.stages.empty()) j["stages"] = stages_json(report.stages, block);
  j["first_shown"] = report.first_shown < shown.size() ? report.first_shown : 0;
  j["sequences"] = std::move(sequences);
  if (shown.empty()) j["no_frames"] = why_no_frames(report, limits);
  return {j.dump(-1, ' ', false, Json::error_handler_t::replace), block.bytes()};
}

/// These three stand in JSON only inside of strings, where \u means the same: so no text ends the element.
std::string escaped(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json)
    if (c == '<' || c == '>' || c == '&')
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      text += c;
  return text;
}

/// Where the line stands that the run takes the place of, without its line end.
std::pair<std::size_t, std::size_t> place_in(const std::string& page_template) {
  constexpr std::string_view mark = "<!-- run -->";
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t from = 0; from < page_template.size();) {
    const std::size_t to = std::min(page_template.find('\n', from), page_template.size());
    if (std::string_view(page_template).substr(from, to - from) == mark) places.push_back({from, to});
    from = to + 1;
  }
  if (places.size() != 1)
    throw IoError(
        fmt::format("the page template has {} lines \"{}\", expected 1: it is not that of this program",
                    places.size(), mark));
  return places[0];
}

/// The page may ask the server it came from, which its policy forbids otherwise.
std::string allowed_to_ask(std::string page_template) {
  constexpr std::string_view none = "connect-src 'none'", own = "connect-src 'self'";
  const std::size_t at = page_template.find(none);
  if (at == std::string::npos)
    throw IoError("the page template lacks the policy \"" + std::string(none) +
                  "\": it is not that of this program");
  return page_template.replace(at, none.size(), own);
}

/// The next stride to try, not more than that which leaves the two ends; what frames take goes down with it.
std::size_t wider(std::size_t stride, std::size_t widest, std::size_t taken, std::size_t free) {
  const double over = static_cast<double>(taken) / static_cast<double>(std::max<std::size_t>(free, 1));
  const double wanted = std::min(static_cast<double>(stride) * over, static_cast<double>(widest));
  return std::max(stride + 1,
                  static_cast<std::size_t>(wanted));  // rounded down: rather once more than too wide
}

class Template {
 public:
  explicit Template(const std::string& text) {
    const auto [from, to] = place_in(text);
    before_ = text.substr(0, from);
    after_ = text.substr(to);
  }
  std::string with(const Packed& packed) const {
    return with("run", packed.json,
                "\n<script type=\"text/plain\" id=\"data\">" + base64(gzip(packed.block)) + "</script>");
  }
  std::string with(const std::string& id, const std::string& json, const std::string& more = {}) const {
    return before_ + "<script type=\"application/json\" id=\"" + id + "\">" + escaped(json) + "</script>" +
           more + after_;
  }

 private:
  std::string before_, after_;
};

}  // namespace

std::string sweep_page(const std::string& page_template, const std::string& json) {
  return Template(page_template).with("sweep", json);
}

std::string fit_page(const std::string& page_template, const std::string& json) {
  return Template(page_template).with("fit", json);
}

std::string material_page(const std::string& page_template, const std::string& json) {
  return Template(page_template).with("material", json);
}

std::string report_page(const std::string& page_template, const Report& report, const PageLimits& limits) {
  const Template place(report.live ? allowed_to_ask(page_template) : page_template);
  const auto page_of = [&](const Cut& cut) { return place.with(pack(report, limits, cut)); };
  const Sequence* run = run_of(report);
  const std::size_t widest = run ? std::max<std::size_t>(run->frames.size(), 2) - 1 : 1;

  constexpr std::size_t fewest_rows = 16;  // fewer would save nothing
  Cut cut{.modes = modes_of(report), .history_rows = limits.history_rows};
  Cut none = cut;
  none.frames = false;
  while (std::min(none.history_rows, report.history.rows()) > fewest_rows &&
         page_of(none).size() > limits.bytes / 2)
    none.history_rows = std::min(none.history_rows, report.history.rows()) / 2;
  cut.history_rows = none.history_rows;

  std::string page = page_of(cut);
  if (page.size() <= limits.bytes) return page;
  Cut least = cut;
  least.stride = widest;
  const std::size_t fixed = page_of(least).size();
  if (fixed <= limits.bytes) {
    while (page.size() > limits.bytes) {
      cut.stride =
          wider(cut.stride, widest, page.size() - std::min(fixed, page.size()), limits.bytes - fixed);
      page = page_of(cut);
    }
    return page;
  }
  while (page.size() > limits.bytes && least.modes > 0) {
    --least.modes;
    page = page_of(least);
  }
  const bool any = run || least.modes > 0;
  return page.size() <= limits.bytes && any ? page : page_of(none);
}

}  // namespace vbond::page
