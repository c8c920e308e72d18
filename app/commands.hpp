#pragma once
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/calibration.hpp"
#include "vbond/case/published_bonds.hpp"

namespace vbond::app {

class Processes;

/// Exit statuses of the program; those of signals with a checkpoint written.
enum ExitStatus {
  done = 0,
  failed = 1,
  bad_input = 2,
  bad_io = 3,
  on_sighup = 129,
  on_sigint = 130,
  on_sigpipe = 141,
  on_sigterm = 143
};

struct RunOptions {
  std::filesystem::path case_file;              ///< "-": the standard input
  std::vector<std::string> changes;             ///< of keys of the case, as read_case takes them
  std::optional<std::filesystem::path> folder;  ///< default: see claim_folder
  bool force = false;                           ///< replace an earlier output
  int threads = 1;
  int ranks = 0;                      ///< to say what they take; 0: nothing
  bool report = false;                ///< write report.html at the end
  bool quiet = false;                 ///< print mistakes and failures only
  bool json = false;                  ///< print status.json as lines instead
  std::FILE* status_lines = nullptr;  ///< where these lines go, if so
  std::string program;                ///< as it was called, for the hint how to go on
  Processes* processes = nullptr;     ///< of run and resume: those that all make this run
};

struct SweepOptions {
  std::filesystem::path case_file;
  std::vector<std::string> sets;                ///< swept keys, see swept_key()
  std::optional<std::filesystem::path> folder;  ///< default: CASE.sweep in the current folder
  int jobs = 1;                                 ///< processes at once
  int threads = 1;                              ///< of each
  std::string program;                          ///< as it was called
};

struct PlotOptions {
  std::filesystem::path folder;
  std::vector<std::string> columns;  ///< of history.csv, a panel each
  std::optional<std::string> x;      ///< the column they are plotted against; else page::axis_of()
  bool still = false;                ///< also write report.png
};

struct WatchOptions {
  std::filesystem::path folder;
  bool once = false;    ///< say how the run stands now, and end
  bool page = false;    ///< show it in a browser, too
  int port = 0;         ///< of that page; 0: any that is free
  std::string program;  ///< as it was called, for the hint how to go on
};

struct HomogeniseOptions {
  std::string volume;   ///< of a body without a cell, with or without a unit; empty: of the box around it
  std::string surface;  ///< of a body without a cell: a group; empty: of that box
  bool along = false;   ///< at each balance of the case's static stages, as CSV
  std::optional<std::filesystem::path> report;  ///< a page to write besides: NAME.html, not there yet
};

int run(const RunOptions& options);
/// Of the options: threads, program, processes and what concerns printing.
int resume(const std::filesystem::path& folder, const RunOptions& options);
int check(const RunOptions& options);  ///< of the options: case_file, changes, threads, ranks
/// Runs a case with all combinations of values of some keys, or goes on with that: see docs/sweeps.md.
int sweep(const SweepOptions& options);
int calibrate(const CalibrateOptions& options, const PublishedBonds& published);
/// Writes report.html into the folder of a run.
int report(const std::filesystem::path& folder);
int plot(const PlotOptions& options);
/// Shows how the run in a folder stands until it ends.
int watch(const WatchOptions& options);
/// Says of each bond that broke in a run, or of the first hundred, when and why.
int breaks(const std::filesystem::path& folder, bool all);
/// Packs the grains of a case and writes its particles alone: a CSV file, or LAMMPS data if the name ends in
/// .data. Nothing is replaced.
int pack(const RunOptions& options, const std::filesystem::path& file);
/// Prints by what the stiffnesses of a case's bonds are to be multiplied so that its periodic cell has these
/// constants. bending: "area", "normal" or "shear", see BendingFollows.
int calibrate_body(const RunOptions& options, const CalibrateOptions& material, const std::string& bending);
/// Prints the elastic constants of a case's body as the case makes it, as text, or as JSON: of the material
/// that its periodic cell is a piece of, of the plate that a cell with two directions is, or of a finite
/// body. The page, if there is one, also has moduli by direction.
int homogenise(const RunOptions& options, const HomogeniseOptions& body);
/// Writes the body of a case, as its first stage begins, as files for LAMMPS with the plugin.
int export_lammps(const RunOptions& options, const std::filesystem::path& folder);
/// Prints what case files may hold: a key, a table, or with an empty text everything.
int reference(const std::string& key);
/// Prints a JSON Schema of case files.
int schema();

}  // namespace vbond::app
