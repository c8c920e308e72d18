#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "vbond/fit/case_run.hpp"
#include "vbond/run/run.hpp"
#include "vbond/statics/sensitivity.hpp"

/// Slopes of rows by values that are parameters of bonds.
namespace vbond::fit {

/// The numbers that are wanted of a row of history.csv.
using RowNumbers = std::function<std::vector<double>(const BodyView&)>;

/// Follows the balances of one run: at() once for each, in their order.
class BondSlopes {
 public:
  /// Keeps references. The state is that before the first stage, in which the bonds have just been made.
  /// Values whose bonds cannot be made anew, or that change none of them, have no slope.
  BondSlopes(const CaseText& text, const std::vector<Nudge>& nudges, const Run& run, State made);
  ~BondSlopes();

  /// A balance of this run, whose numbers `numbers` gives.
  void at(const BodyView& body, const BalancePoint& balance, const RowNumbers& numbers);
  /// A row that is none of a balance: there are no slopes any more.
  void lose(const std::string& why);
  std::vector<Slope> take() &&;

 private:
  struct Inside;
  std::unique_ptr<Inside> in_;
};

}  // namespace vbond::fit
