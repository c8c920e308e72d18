#include "vbond/observe/page/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "vbond/core/error.hpp"
#include "vbond/observe/page/block.hpp"

namespace vbond::page {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PackedArray& a) {
  const auto one_or_all = [](const std::vector<double>& x) { return x.size() == 1 ? Json(x[0]) : Json(x); };
  Json j{{"offset", a.offset},
         {"type", a.type},
         {"count", a.count},
         {"low", one_or_all(a.low)},
         {"step", one_or_all(a.step)}};
  if (a.delta > 0) j["delta"] = a.delta;
  return j;
}

/// Nine digits are more than a plot shows, and half the size.
Json to_json(double x) {
  return std::isnan(x) ? Json() : Json(std::stod(fmt::format("{:.9g}", x)));
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

/// The bytes of one field, frame after frame, each as long as all bonds there ever are.
template <class Get>
std::vector<std::uint8_t> of_bonds(const Sequence& s, const std::vector<std::size_t>& frames,
                                   std::size_t bonds, Get get) {
  std::vector<std::uint8_t> all(frames.size() * bonds);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::vector<std::uint8_t>& values = get(s.frames[frames[f]]);
    std::copy(values.begin(), values.end(), all.begin() + static_cast<std::ptrdiff_t>(f * bonds));
  }
  return all;
}

Json bond_fields_json(const Sequence& s, const std::vector<std::size_t>& frames, std::size_t bonds, bool si,
                      Block& block) {
  Json fields = Json::array();
  for (std::size_t k = 0; k < bond_field_count; ++k) {
    const BondField& field = bond_fields[k];
    const auto q = of_bonds(
        s, frames, bonds, [k](const QuantisedFrame& f) -> const auto& { return f.fields[k]; });
    const std::string_view key = field.key;
    const char* unit = key == "bend" || key == "twist" ? "rad" : key == "elongation" || !si ? "" : "J";
    fields.push_back({{"key", field.key},
                      {"label", field.label},
                      {"unit", unit},
                      {"signed", field.is_signed},
                      {"array", to_json(block.add(q, s.fields[k], bonds))}});
  }
  return fields;
}

Json speed_json(const Sequence& s, const std::vector<std::size_t>& frames, bool si, Block& block) {
  if (s.frames.empty() || s.frames[0].speed.empty()) return Json::array();
  std::vector<std::uint8_t> q;
  for (const std::size_t f : frames) q.insert(q.end(), s.frames[f].speed.begin(), s.frames[f].speed.end());
  return Json::array({{{"key", "speed"},
                       {"label", "speed"},
                       {"unit", si ? "m/s" : ""},
                       {"array", to_json(block.add(q, s.speed, s.frames[0].speed.size()))}}});
}

Json sequence_json(const Sequence& s, const Report& report, std::size_t stride, Block& block) {
  const std::vector<std::size_t> kept = thinned(s.frames.size(), stride);
  const bool si = report.units == UnitSystem::si, is_run = s.kind == SequenceKind::run;
  const std::size_t bonds = report.body.bonds.size() / 2, particles = report.body.radius.size();
  Json frames = Json::array();
  std::vector<std::uint16_t> displacement;
  for (const std::size_t f : kept) {
    const QuantisedFrame& frame = s.frames[f];
    frames.push_back({{"step", frame.step},
                      {"time", frame.time},
                      {"stage", is_run ? report.stage_of_frame.at(f) : ""},
                      {"bonds", frame.bonds()}});
    displacement.insert(displacement.end(), frame.displacement.begin(), frame.displacement.end());
  }
  const auto range = of_bonds(
      s, kept, bonds, [](const QuantisedFrame& f) -> const auto& { return f.range; });
  Json j{{"kind", is_run ? "run" : "mode"},
         {"name", s.name},
         {"note", s.note},
         {"loop", !is_run},
         {"frames", std::move(frames)}};
  j["reference"] = to_json(block.add(s.reference));
  j["displacement"] = to_json(block.add(displacement, s.displacement, 3 * particles));
  j["particle_fields"] = speed_json(s, kept, si, block);
  j["bond_fields"] = bond_fields_json(s, kept, bonds, si, block);
  j["bond_range"] = to_json(block.add(range, {0.0, 1.0}, bonds));
  return j;
}

Json radius_json(const std::vector<float>& radius, Block& block) {
  if (radius.empty()) return 0.0;
  const bool equal = std::all_of(radius.begin(), radius.end(), [&](float R) { return R == radius[0]; });
  return equal ? Json(radius[0]) : to_json(block.add(radius));
}

/// Steps of the frames that stay, for the rows of history that go with them.
std::vector<std::int64_t> steps_of(const Report& report, std::size_t stride) {
  std::vector<std::int64_t> steps;
  for (const Sequence& s : report.sequences)
    if (s.kind == SequenceKind::run)
      for (const std::size_t f : thinned(s.frames.size(), stride)) steps.push_back(s.frames[f].step);
  return steps;
}

void say_what_is_left_out(const Report& report, const PageLimits& limits, std::size_t stride,
                          std::size_t rows, std::vector<std::string>& left_out) {
  const auto run = std::find_if(report.sequences.begin(), report.sequences.end(),
                                [](const Sequence& s) { return s.kind == SequenceKind::run; });
  const double megabytes = static_cast<double>(limits.bytes) / 1e6;
  if (stride == 0 && !report.sequences.empty())
    left_out.push_back(fmt::format(
        "No frames are shown: even two of them do not fit into a page of {:g} MB. ParaView shows them.",
        megabytes));
  if (stride > 1)
    left_out.push_back(fmt::format(
        "One frame in {} is shown, and the last one{}, so that the page stays below {:g} MB.", stride,
        run == report.sequences.end()
            ? std::string()
            : fmt::format(": {} of {}", thinned(run->frames.size(), stride).size(), run->frames.size()),
        megabytes));
  if (rows < report.history.rows())
    left_out.push_back(
        fmt::format("Plots show {} of the {} rows of history.csv: those of the frames, and "
                    "the smallest and largest values of every column in each stretch between.",
                    rows, report.history.rows()));
  if (report.history.rows() > 0) left_out.push_back("Numbers of the plots are rounded to 9 digits.");
  if (!report.sequences.empty() && stride > 0)
    left_out.push_back(
        "Colours of the 3D view have 255 steps between the smallest and the largest value of all frames, "
        "displacements 65,535 steps in each direction.");
}

struct Packed {
  std::string json, block;
};

/// The run with every stride-th frame; 0: with none.
Packed pack(const Report& report, const PageLimits& limits, std::size_t stride) {
  Block block;
  const bool si = report.units == UnitSystem::si;
  const auto rows =
      rows_to_keep(report.history, stride > 0 ? steps_of(report, stride) : std::vector<std::int64_t>{},
                   limits.history_rows);
  std::vector<std::string> left_out = report.left_out;
  say_what_is_left_out(report, limits, stride, rows.size(), left_out);
  Json warnings = Json::array(), plots = Json::array(), sequences = Json::array();
  for (const Warning& w : report.warnings)
    warnings.push_back({{"level", to_text(w.level)}, {"text", w.text}});
  for (const Plot& p : preset_plots(report.history))
    plots.push_back({{"title", p.title}, {"x", p.x}, {"y", p.y}});
  Json radius = stride > 0 ? radius_json(report.body.radius, block) : Json(0.0);
  Json bonds = to_json(block.add(stride > 0 ? report.body.bonds : std::vector<std::uint32_t>{}));
  if (stride > 0)
    for (const Sequence& s : report.sequences) sequences.push_back(sequence_json(s, report, stride, block));
  const bool long_case = report.case_text.size() > limits.case_bytes;
  if (long_case) left_out.push_back("The case is too long for this page: it stands in resolved.toml.");
  const auto pairs = [](const Lines& lines) {
    Json j = Json::array();
    for (const auto& [name, value] : lines) j.push_back(Json::array({name, value}));
    return j;
  };
  Json j{
      {"format", 1}, {"program", report.program}, {"title", report.title}, {"units", si ? "SI" : "reduced"}};
  j["facts"] = pairs(report.facts);
  j["results"] = pairs(report.results);
  j["warnings"] = std::move(warnings);
  j["rerun"] = {{"command", report.command}, {"case", long_case ? std::string() : report.case_text}};
  j["left_out"] = left_out;
  j["history"] = history_json(report.history, si, rows);
  j["plots"] = std::move(plots);
  j["radius"] = std::move(radius);
  j["bonds"] = std::move(bonds);
  j["first_shown"] = report.first_shown;
  j["sequences"] = std::move(sequences);
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

}  // namespace

/// The next stride to try: that by which the page is too large, or 0 if even the ends of a sequence are too
/// much.
std::size_t wider(std::size_t stride, std::size_t most_frames, std::size_t size, std::size_t limit) {
  if (stride >= most_frames) return 0;
  const double over = static_cast<double>(size) / static_cast<double>(std::max<std::size_t>(limit, 1));
  const double wanted = std::min(static_cast<double>(stride) * over, static_cast<double>(most_frames));
  return std::max(stride + 1,
                  static_cast<std::size_t>(wanted));  // rounded down: rather once more than too wide
}

std::string report_page(const std::string& page_template, const Report& report, const PageLimits& limits) {
  const auto [from, to] = place_in(page_template);
  const std::string before = page_template.substr(0, from), after = page_template.substr(to);
  std::size_t most = 0;
  for (const Sequence& s : report.sequences) most = std::max(most, s.frames.size());
  for (std::size_t stride = 1;;) {
    const Packed packed = pack(report, limits, stride);
    std::string page = before + "<script type=\"application/json\" id=\"run\">" + escaped(packed.json) +
                       "</script>\n<script type=\"text/plain\" id=\"data\">" + base64(gzip(packed.block)) +
                       "</script>" + after;
    if (page.size() <= limits.bytes || stride == 0) return page;
    stride = wider(stride, most, page.size(), limits.bytes);
  }
}

}  // namespace vbond::page
