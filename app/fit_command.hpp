#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace vbond::fit {
struct Result;
struct Task;
struct Tried;
}  // namespace vbond::fit

namespace vbond::app {

struct FitOptions {
  std::filesystem::path case_file, data_file;
  std::vector<std::string> vary;     ///< keys and bounds, see fit::varied_key
  std::string x;                     ///< see fit::pair_of
  std::vector<std::string> compare;  ///< likewise
  std::vector<std::string> sigma;    ///< one for each of them, or none
  std::optional<std::string> stage;
  std::optional<std::filesystem::path> output;  ///< default: CASE.fitted.toml in the current folder
  int iterations = 50;
  double difference = 1e-3;
  std::string derivatives = "automatic";  ///< or "differences"
  bool report = false;
  int threads = 1;
};

/// The command with all its options but --threads.
CLI::App* add_fit(CLI::App& app, FitOptions& o);

/// Varies keys of a case until columns of its history follow measured points: docs/fit.md.
int fit(const FitOptions& options);

/// The files of a fit, beside the fitted case.
struct FitFiles {
  std::filesystem::path fitted;  ///< NAME.toml
  std::filesystem::path result;  ///< NAME.json
  std::filesystem::path curves;  ///< NAME.csv
  std::filesystem::path runs;    ///< NAME.runs.csv: each run by its values
  std::filesystem::path page;    ///< NAME.html, if it is asked for
};
/// Throws std::invalid_argument if one of them would replace what is no part of this fit, or if the case
/// would not find its files from there.
FitFiles fit_files(const FitOptions& options, const fit::Task& task);

/// What the runs of a fit depend on, in one line: they are of use for no other. derivatives: see FitOptions.
std::string definition_of(const fit::Task& task, const std::string& derivatives);

/// The runs that an earlier try has left in NAME.runs.csv. None if there is no such file. Throws
/// std::invalid_argument if they are of another fit, IoError for a line that is no run.
std::vector<fit::Tried> read_runs(const std::filesystem::path& runs, const fit::Task& task,
                                  const std::string& derivatives);
/// The first lines of that file, and a line for a run.
std::string header_of_runs(const fit::Task& task, const std::string& derivatives);
std::string line_of(const fit::Tried& run);

/// NAME.json and NAME.csv, and the JSON of NAME.html (web/FORMAT.md).
std::string fit_as_json(const fit::Task& task, const fit::Result& result);
std::string fit_as_csv(const fit::Task& task, const fit::Result& result);
std::string fit_for_page(const fit::Task& task, const std::string& derivatives, const fit::Result& result);

}  // namespace vbond::app
