#pragma once
#include <string>

#include "judge.hpp"

namespace vbond::campaign {

/// A witness for critical loads that were told, where finding them once more takes too long: load steps by
/// Newton's method, and at each the number of negative eigenvalues by the signs of Eigen's L D L^T, of which
/// nothing is the solver's. It must be zero on a grid of load factors up to just below the first, rise at
/// each by as many as were told there, and not between, where it may fall. Behind a limit point there is no
/// balance close by. Where one is told with a gap the path of a body that is not quite symmetric may turn off
/// along one branch or another: then only that stability is lost there is judged, and nothing behind it.
/// Balances on the way are found with the factor of an earlier one as long as corrections converge.
struct Witnessed {
  Judgement judgement;
  int balances = 0;
  double searched_to = 0;  ///< the largest load factor at which it found what was told
};

Witnessed witness_of(const Model& model, const StaticStage& stage, const State& state, const Answer& answer,
                     int count);

}  // namespace vbond::campaign
