#pragma once
#include <cstdint>
#include <optional>

#include "vbond/model/bond_event.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/fragments.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond {

/// The first break of a run and the largest load at a break.
struct BreakRecord {
  std::optional<double> first_time;    ///< [time]
  std::optional<double> first_load;    ///< [force]
  std::optional<double> largest_load;  ///< [force]
  friend bool operator==(const BreakRecord&, const BreakRecord&) = default;
};

/// Writes breaks.csv, a row for each bond that broke, as CsvWriter does.
class BreaksWriter {
 public:
  BreaksWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step);
  BreaksWriter(const BreaksWriter&) = delete;
  BreaksWriter& operator=(const BreaksWriter&) = delete;

  /// load: of the first group whose reaction is asked for. Throws IoError.
  void write(const Clock& clock, const BondEvent& event, std::optional<double> load);
  /// Of the rows in the file.
  const BreakRecord& record() const { return record_; }
  bool begun_anew() const { return file_.begun_anew(); }

 private:
  static CsvWriter::Look looker(BreakRecord& record, const std::vector<std::string>& columns);

  BreakRecord record_;
  CsvWriter file_;  // last: as it is opened it takes up the rows of an earlier run
};

/// Writes fragments.csv, the fragments at the end of each stage, as CsvWriter does.
class FragmentsWriter {
 public:
  /// stage: the one that a run goes on with; rows of it and of later ones are dropped.
  FragmentsWriter(const OutputPlan& plan, std::optional<std::int64_t> stage);

  /// The fragments at the end of this stage. Throws IoError.
  void write(const Clock& clock, std::int64_t stage, const Fragments& fragments,
             const FragmentMotion& motion);

 private:
  CsvWriter file_;
};

/// Drops what a killed run has written after this, where bonds break no more in the case as it is now.
void cut_breaks(const OutputPlan& plan, const Clock& resumed);

}  // namespace vbond
