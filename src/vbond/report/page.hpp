#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/report/break_words.hpp"
#include "vbond/report/history_read.hpp"
#include "vbond/report/sequence.hpp"
#include "vbond/report/warnings.hpp"

/// The report page: what stands in it, and how it comes into the template. web/FORMAT.md has the other side.
namespace vbond::page {

using Lines = std::vector<std::pair<std::string, std::string>>;

/// What a stage holds and loads, as its case asks for it: without functions of time, at load factor 1.
struct StageHolds {
  std::string name;
  std::vector<std::uint32_t> held;    ///< particles
  std::vector<std::uint32_t> how;     ///< of each, bits from the lowest: x, y, z, rx, ry, rz
  std::vector<std::uint32_t> loaded;  ///< particles
  std::vector<float> loads;           ///< of each, force and moment: six numbers  [force], [force*length]
};

/// Everything that the page shows but what is computed from it.
struct Report {
  std::string program;  ///< with its version
  std::string title;
  UnitSystem units = UnitSystem::reduced;
  Lines facts, results;
  std::vector<Warning> warnings;
  std::string command, case_text;     ///< how to run it again
  std::vector<std::string> left_out;  ///< known before the page is packed
  History history;
  BreaksTold breaks;  ///< the first listed_breaks of them in words
  Body body;
  std::vector<Sequence> sequences;
  std::string no_frames;                    ///< why there are no sequences, if so
  std::size_t first_shown = 0;              ///< number of the sequence that the page begins with
  std::vector<std::string> stage_of_frame;  ///< of the run's frames, one each
  std::vector<StageHolds> stages;           ///< those that hold or load particles
  std::optional<std::string> live;  ///< the page follows a run, of which this is the state of the data
};

constexpr std::size_t listed_breaks = 100;

struct PageLimits {
  std::size_t bytes = 25'000'000;  ///< of the whole file
  std::size_t history_rows = 4000;
  std::size_t frames = 2000;               ///< of the run
  std::size_t packed_bytes = 250'000'000;  ///< of the numbers of all frames before compression
  std::size_t case_bytes = 1'000'000;
};

/// The template with the overview of a sweep in it: JSON as web/FORMAT.md says. Throws IoError like
/// report_page.
std::string sweep_page(const std::string& page_template, const std::string& json);
/// The same of a fit, and of a material.
std::string fit_page(const std::string& page_template, const std::string& json);
std::string material_page(const std::string& page_template, const std::string& json);

/// The page: the template with the run in it. While it is larger than its limit, first rows of the history
/// are left out, if those alone take half of it; then frames of the run, evenly; then modes from the last
/// one; then all frames. The page says so. A live one may ask the server it came from for more. Throws
/// IoError if the template has not exactly one line "<!-- run -->", or not the policy that web/build.mjs
/// writes.
std::string report_page(const std::string& page_template, const Report& report, const PageLimits& limits);

}  // namespace vbond::page
