#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/model.hpp"

/// The measured points of a fit.
namespace vbond::fit {

/// A column of history.csv and the column of the data that goes with it, which is named alike unless said.
struct Pair {
  std::string history, data;
};
/// "COLUMN" or "COLUMN=COLUMN OF THE DATA". Throws std::invalid_argument, naming the option.
Pair pair_of(const std::string& text, const std::string& option);

/// A curve that is measured.
struct Measured {
  Pair y;
  std::string sigma;  ///< a number, or a column of the data; empty: not known
};

/// A measured point; numbers in the units of history.csv.
struct Point {
  std::size_t curve = 0;  ///< of the measured ones
  double x = 0, y = 0;
  double sigma = 1;                  ///< standard deviation of y, or 1 if it is not known
  std::optional<std::size_t> stage;  ///< of the run, whose rows it is compared with; nothing: all
  std::uint32_t line = 0;            ///< of the file
};

struct Points {
  std::vector<Point> points;
  std::vector<std::string> passed_over;  ///< columns that nobody asked for
};

/// Reads the points of a CSV file (csv_table.hpp). A heading may end with a unit in brackets, as in
/// "force [kN]", which becomes that of history.csv; standard deviations as columns likewise. An empty field
/// is a point that was not measured. Rows belong to the stage that a column `stage` names, unless `stage`
/// says one for all. Throws CaseError with every mistake, IoError.
Points read_points(const std::filesystem::path& file, const Pair& x, const std::vector<Measured>& measured,
                   const std::optional<std::string>& stage, const std::vector<std::string>& stages,
                   UnitSystem units);

}  // namespace vbond::fit
