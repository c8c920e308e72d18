#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/plan.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// What stands in a row of history.csv.
struct HistoryValues {
  Clock clock;
  EnergyBooks books;
  Energies energies;
  double balance_error = 0;  ///< relative
  std::int64_t bonds = 0;
  RangeCounts ranges;
  double peak_average = 0;            ///< last block average of the quantity watched for a peak  [force]
  std::optional<double> load_factor;  ///< static points
  std::optional<int> unstable;        ///< static points: negative eigenvalues of the tangent, if counted
  std::vector<Reaction> reactions;    ///< one per OutputPlan::reactions
  std::vector<double> axial_force;    ///< one per OutputPlan::axial_force, tension positive  [force]
  std::vector<Vec3d> displacements;   ///< one per OutputPlan::displacements, mean of r - r_0  [length]
};

/// The values of a run as it stands. Collects the particles only if the plan asks for displacements.
HistoryValues history_values(const OutputPlan& plan, const Simulation& run);

/// The values of a static point. Its energy books begin with the point: its own energy, nothing else.
HistoryValues history_values(const OutputPlan& plan, const Model& model, const StaticPoint& point);

/// The first line of history.csv: the names of the columns; see docs/output.md.
std::string history_header(const OutputPlan& plan);

/// One row with 17 significant digits, enough to give back every double. statics: with their columns.
std::string history_row(const HistoryValues& values, bool statics);

/// Writes history.csv row by row; what is written is readable at once and stays so if the run dies.
class HistoryWriter {
 public:
  /// Begins a new file, or with resume_step continues one: rows after that step, which a killed run
  /// may have written past its checkpoint, are dropped. A case that was edited meanwhile may ask for other
  /// columns: new ones are added behind, empty so far; those that it no longer asks for stay, empty from now
  /// on. A file that is missing is begun anew, see begun_anew(). Throws IoError.
  HistoryWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step);

  /// Throws IoError, also if the file was removed, replaced or changed by others: its rows are then lost.
  void write(const HistoryValues& values);

  /// Step of the last row in the file, -1 if there is none.
  std::int64_t last_step() const { return last_step_; }
  /// Largest |balance_error| of the rows in the file.
  double largest_balance_error() const { return largest_balance_error_; }
  /// A run goes on, but its history.csv was not there any more.
  bool begun_anew() const { return begun_anew_; }

 private:
  void keep_until(std::int64_t resume_step);
  /// The row of the plan in the columns of the file.
  std::string in_columns_of_file(const std::string& row) const;

  OutputPlan plan_;
  std::filesystem::path path_;
  std::vector<std::string> columns_;  ///< of the file, as they stand there
  std::optional<GrowingFile> file_;
  std::int64_t last_step_ = -1;
  double largest_balance_error_ = 0;
  bool begun_anew_ = false;
};

}  // namespace vbond
