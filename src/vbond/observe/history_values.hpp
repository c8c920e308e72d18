#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/body_view.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/stress.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/fragments.hpp"
#include "vbond/observe/plan.hpp"

namespace vbond {

/// The cell of a periodic body.
struct CellValues {
  double volume = 0;        ///< [length^3]
  double density = 0;       ///< of mass  [mass/length^3]
  SymmetricParts strain{};  ///< components of the deformation gradient, less 1 on the diagonal
  SymmetricParts stress{};  ///< Cauchy's, tension > 0  [stress]
  friend bool operator==(const CellValues&, const CellValues&) = default;
};
CellValues cell_values(const Model& model, const BodyPart& body);

/// What a row of history.csv is made of: see quantities.hpp for its columns.
struct HistoryValues {
  Clock clock;
  EnergyBooks books;
  MassBooks mass;
  std::int64_t present = 0;  ///< particles that take part
  Energies energies;
  double balance_error = 0;    ///< relative
  std::vector<double> losses;  ///< one per OutputPlan::losses: that part of books.dissipated  [energy]
  std::int64_t bonds = 0;
  RangeCounts ranges;
  std::optional<FragmentCount> fragments;  ///< where bonds may break
  std::int64_t broken = 0;                 ///< bonds
  double peak_average = 0;                 ///< last block average of the quantity watched for a peak  [force]
  std::optional<double> load_factor;       ///< static points
  std::optional<int> unstable;             ///< static points: negative eigenvalues of the tangent, if counted
  std::vector<Reaction> reactions;         ///< one per OutputPlan::reactions
  std::vector<double> axial_force;         ///< one per OutputPlan::axial_force, tension positive  [force]
  /// One per OutputPlan::displacements, mean of r - r_0; nothing where no particle is there.  [length]
  std::vector<std::optional<Vec3d>> displacements;
  std::vector<std::optional<Vec3d>> velocities;  ///< one per OutputPlan::velocities; static points: none
  std::vector<SymmetricParts> stresses;          ///< one per OutputPlan::stresses  [stress]
  std::vector<SymmetricParts> strains;           ///< likewise
  std::vector<WallState> walls;                  ///< one per OutputPlan::walls; empty: not known
  std::optional<CellValues> cell;                ///< of periodic bodies
  std::vector<std::optional<GripView>> grips;    ///< one per OutputPlan::grips; nothing: not in this stage
  /// Of each quantity of OutputPlan::of_terms the cells of its groups.
  std::map<std::string, std::vector<std::vector<Cell>>> of_terms;
};

/// The values of a body as it stands, by sums over what each process has: nobody asks for the whole state.
HistoryValues history_values(const OutputPlan& plan, const BodyView& body);

}  // namespace vbond
