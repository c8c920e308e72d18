#pragma once
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/statics/results.hpp"

/// The reference: critical loads of the fundamental path, found without the solver's walk.
///
/// The path is followed in steps of the load factor, or where that turns of the displacement that changes
/// most. A step stands when its middle agrees with the cubic through its ends and the path turns little in
/// it. Where the number of negative eigenvalues differs at its ends, or the load factor turns back, the place
/// is narrowed down by bisection; then each eigenvalue that passes zero (at a limit point the rate of the
/// load factor) is fitted by polynomials through six balances around it, none of them close to singular, and
/// the zero of degree 5 is held against that of degree 3. Nearer and nearer spans are tried until both agree.
/// If none does, two branches pass each other there without meeting, and the path is followed on in small
/// steps.
namespace vbond::campaign {

struct ReferencePoint {
  PointKind kind = PointKind::bifurcation;
  double load_factor = 0;
  double error = 0;       ///< relative: of the fit, and what rounding of the tangent may make of it
  bool regained = false;  ///< an unstable direction becomes stable: special on a path, no critical load
  bool beyond_range =
      false;  ///< a bond is strained there, as physics/range.hpp has it, or by more than a half
};

struct Reference {
  std::vector<ReferencePoint> points;  ///< along the path, none beyond a limit point
  double searched_to = 0;              ///< there are no others up to this load factor
  int unstable_at_start = 0;
  std::string ended;       ///< "count", "limit point", "load factor", "range", or why it could go no further
  bool undecided = false;  ///< it could go no further
  int nodes = 0;           ///< balances it took
  std::vector<double> passings;  ///< load factors where branches pass each other close by

  struct Turning {
    double load_factor = 0, turned = 0;  ///< turned: of the tangent, summed up from the start  [rad]
  };
  std::vector<Turning> turning;  ///< along the path
};

struct ReferenceSettings {
  int count = 1;         ///< critical loads wanted
  double reach = 0;      ///< load factor at which it may end; 0: none
  bool near_by = false;  ///< look at critical points from so near that branches passing by are seen
  int most_nodes = 6000;
};

Reference find_reference(const Model& model, const StaticStage& stage, const State& state,
                         const ReferenceSettings& settings);

}  // namespace vbond::campaign
