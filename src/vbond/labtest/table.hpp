#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "vbond/observe/csv.hpp"

namespace vbond::labtest {

/// A table of a run, row by row. Throws IoError if it is not there or damaged.
class Table {
 public:
  explicit Table(const std::filesystem::path& path) : reader_(path) {}
  bool next() { return reader_.next(); }
  bool has(const std::string& column) const { return index_of(reader_.header(), column).has_value(); }
  std::optional<double> find(const std::string& column) const {
    const auto place = index_of(reader_.header(), column);
    return place ? csv_number<double>(reader_.cells()[*place]) : std::nullopt;
  }
  double number(const std::string& column) const {
    if (const auto x = find(column)) return *x;
    reader_.refuse();
  }
  std::string word(const std::string& column) const { return reader_.cells()[reader_.place(column)]; }

 private:
  CsvReader reader_;
};

}  // namespace vbond::labtest
