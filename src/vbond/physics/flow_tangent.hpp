#pragma once
#include <array>
#include <cstddef>

#include "vbond/physics/flow_step.hpp"
#include "vbond/physics/tangent.hpp"
#include "vbond/physics/with_offsets.hpp"
#include "vbond/physics/with_rubbing.hpp"

/// The tangent of bonds that yield or soften, for an increment that takes no time: loads at its end, after
/// the flow that it brings, as a function of the pose at its end.
namespace vbond {

/// Amounts of flow in an increment, as the memory counts them: axial, shear, bending, torsion.
inline constexpr std::size_t ways_to_flow = 4;
template <Scalar T>
using FlowAmounts = std::array<T, ways_to_flow>;

/// The memory after these amounts of flow, and by how much each load is then over its limit.
template <FlowingLaw Law, Scalar T>
LawHistory<Law> flowed_by(const FlowAmounts<T>& x, const Law& m, const BondPose<T>& b,
                          const BondAxis<T>& axis, const LawHistory<Law>& before, FlowAmounts<T>& over) {
  LawHistory<Law> h = before;
  if (m.rules->yield.stretches()) {
    FlowAlongAxis<Law, T> flow(m, axis.D, h);
    flow.flow.x = x[0];
    over[0] = flow.over();
    flow.keep(h);
  }
  if (m.rules->yield.turns()) {
    FlowAcrossAxis<Law, T> flow(m, b, axis, h);
    flow.slide.flow.x = x[1], flow.bend.flow.x = x[2], flow.twist.flow.x = x[3];
    flow.turn();
    over[1] = flow.shear_over(), over[2] = flow.bending_over(), over[3] = flow.torsion_over();
    flow.keep(h);
  }
  return h;
}

/// Amounts of flow with their derivatives: those that keep every load that flows at its limit. `over` is
/// what flowed_by() says, with derivatives in nine variables of the pose and then in the amounts.
template <std::size_t N>
FlowAmounts<Dual<N>> following_limits(FlowAmounts<Dual<N>> over, const FlowAmounts<double>& amounts) {
  const auto eliminate = [&](std::size_t from, std::size_t k) {
    const double part = over[from].d[9 + k] / over[k].d[9 + k];
    over[from] = over[from] - Dual<N>(part) * over[k];
  };
  for (std::size_t k = 0; k < ways_to_flow; ++k)  // the diagonal is largest: a limit hardly knows of others
    for (std::size_t from = 0; from < ways_to_flow; ++from)
      if (from != k && amounts[k] > 0.0 && amounts[from] > 0.0) eliminate(from, k);
  FlowAmounts<Dual<N>> x;
  for (std::size_t k = 0; k < ways_to_flow; ++k) {
    x[k].value = amounts[k];
    if (amounts[k] > 0.0)
      for (std::size_t v = 0; v < 9; ++v) x[k].d[v] = -over[k].d[v] / over[k].d[9 + k];
  }
  return x;
}

/// Loads of a flowing bond at the end of an increment from the memory `before`, whose pose has derivatives
/// `b`.
template <template <class> class Law, Scalar D>
requires FlowingLaw<Law<double>> BondLoads<D> loads_after_flow(const Law<double>& law,
                                                               const BondPose<double>& pose,
                                                               const BondPose<D>& b,
                                                               const LawHistory<Law<double>>& before) {
  const BondAxis<double> still = bond_axis(law, pose);
  const LawHistory<Law<double>> now = advance(law, pose, still, BondRates<double>{}, 0.0, before);
  FlowAmounts<double> amounts;
  for (std::size_t k = 0; k < ways_to_flow; ++k)
    amounts[k] = now.value[memory::axial + k] - before.value[memory::axial + k];

  const Law<D> m = with_scalar<D>(law);
  const BondAxis<D> axis = bond_axis(m, b);
  LawHistory<Law<D>> h;
  for (std::size_t k = 0; k < memory::count; ++k) h.value[k] = D(before.value[k]);
  if (std::any_of(amounts.begin(), amounts.end(), [](double x) { return x > 0.0; })) {
    FlowAmounts<D> x, over;
    for (std::size_t k = 0; k < ways_to_flow; ++k) x[k] = D::variable(amounts[k], 9 + k);
    flowed_by(x, m, b, axis, h, over);
    x = following_limits(over, amounts);
    h = flowed_by(x, m, b, axis, h, over);
  }
  if (now.value[memory::damage] > before.value[memory::damage]) soften(m, b, axis, BondRates<D>{}, D(0.0), h);
  return bond_loads(m, b, axis, h);
}

/// The same of a bond that rubs, whose slip follows from the pose in closed form.
template <template <class> class Law, Scalar D>
requires RubbingLaw<Law<double>> BondLoads<D> loads_after_flow(const Law<double>& law,
                                                               const BondPose<double>& /*pose*/,
                                                               const BondPose<D>& b,
                                                               const LawHistory<Law<double>>& before) {
  Law<D> m = with_scalar<D>(law);
  m.off_2 = D(law.off_2), m.off_3 = D(law.off_3);
  const BondAxis<D> axis = bond_axis(m, b);
  LawHistory<Law<D>> h;
  for (std::size_t k = 0; k < rubbed::count; ++k) h.value[k] = D(before.value[k]);
  return bond_loads(m, b, axis, advance(m, b, axis, BondRates<D>{}, D(0.0), h));
}

/// Loads of a flowing bond, offset or not, at the end of an increment from the memory `before`, and their
/// exact derivatives (the consistent tangent). What does not flow in the increment is as stiff as if it never
/// did.
template <template <class> class Law>
PairTangent<9> flow_tangent(const Law<double>& law, const BondPose<double>& pose,
                            const LawHistory<Law<double>>& before) {
  using D = Dual<9 + ways_to_flow>;
  const BondPose<D> b = moved_pose<9 + ways_to_flow>(pose);
  if constexpr (OffsetLaw<Law<double>>) {
    using Centred = typename Law<double>::Centred;
    const Law<D> m = with_scalar<D>(law);
    return tangent_of(m.at_centres(b, loads_after_flow(law.centred(), law.at_offsets(pose), m.at_offsets(b),
                                                       history_as<Centred>(before))));
  } else {
    return tangent_of(loads_after_flow(law, pose, b, before));
  }
}

}  // namespace vbond
