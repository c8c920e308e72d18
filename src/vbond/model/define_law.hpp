#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "vbond/model/bond.hpp"
#include "vbond/physics/flow_tangent.hpp"
#include "vbond/physics/laws.hpp"

/// What makes a BondLaw of a law's template. A law of the library is in BondLaws and needs no more; a law of
/// a program's own is made by including this header where &bond_law<Law> is used.
namespace vbond {

/// The law of a bond, with its constants.
template <template <class> class Law>
Law<double> law_of(const Bond& b) {
  Law<double> law{};
  law.a = b.a, law.R_i = b.R_i, law.R_j = b.R_j;
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    ((law.*coefficient<Law<double>, k> = b.coefficients[k]), ...);
  }
  (std::make_index_sequence<coefficients_of<Law<double>>>());
  if constexpr (HasRules<Law<double>>) law.rules = b.rules;
  return law;
}

/// The coefficients of a law, in the order of its fields.
template <class Law>
Coefficients coefficients_in(const Law& law) {
  Coefficients c{};
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    ((c[k] = law.*coefficient<Law, k>), ...);
  }
  (std::make_index_sequence<coefficients_of<Law>>());
  return c;
}

template <template <class> class Law>
LawHistory<Law<double>> history_of_bond(const BondHistory& h) {
  LawHistory<Law<double>> history;
  for (std::size_t k = 0; k < history_of<Law<double>>; ++k) history.value[k] = h[k];
  return history;
}

template <template <class> class Law>
BondHistory as_bond_history(const LawHistory<Law<double>>& h) {
  BondHistory history{};
  std::copy_n(h.value, history_of<Law<double>>, history.begin());
  return history;
}

namespace detail {

template <class Law>
constexpr std::span<const std::string_view> history_names() {
  if constexpr (Remembering<Law>) return Law::history;
  return {};
}

template <class Law>
constexpr std::size_t dissipated_at() {
  if constexpr (requires { Law::dissipated_at; }) return Law::dissipated_at;
  return most_history;
}

template <template <class> class Law>
constexpr auto crack_of() -> BondHistory (*)(const Bond&, const BondPose<double>&, const BondHistory&) {
  if constexpr (requires(const Law<double>& m, const BondPose<double>& b, const BondAxis<double>& axis,
                         const LawHistory<Law<double>>& h) { crack(m, b, axis, h); })
    return [](const Bond& b, const BondPose<double>& pose, const BondHistory& h) {
      const Law<double> law = law_of<Law>(b);
      return as_bond_history<Law>(crack(law, pose, bond_axis(law, pose), history_of_bond<Law>(h)));
    };
  return nullptr;
}

template <class Law>
constexpr auto field_infos() {
  std::array<LawFieldInfo, coefficients_of<Law>> infos;
  for (std::size_t k = 0; k < infos.size(); ++k) infos[k] = Law::fields()[k].info;
  return infos;
}
template <class Law>
inline constexpr auto fields_of = field_infos<Law>();

template <template <class> class Law>
Coefficients from_stiffness(const BondStiffness<double>& c, double a, const Coefficients& given) {
  Coefficients found = coefficients_in(Law<double>::from(c, a, 0.0, 0.0));
  for (std::size_t k = 0; k < coefficients_of<Law<double>>; ++k)
    if (fields_of<Law<double>>[k].input == LawInput::given) found[k] = given[k];
  return found;
}

template <class Law>
constexpr bool has_rules() {
  if constexpr (HasRules<Law>)
    static_assert(rules_come_last<Law>(),
                  "a law with rules is WithRules<Elastic>::Law or WithFlow<Elastic>::Law");
  return HasRules<Law>;
}

/// An elastic law with rules, or with flow: Form is WithRules or WithFlow.
template <template <class> class Law, template <template <class> class> class Form>
constexpr const BondLaw* in_form() {
  if constexpr (TakesRules<Law<double>>) return &bond_law<Form<Law>::template Law>;
  return nullptr;
}

}  // namespace detail

template <template <class> class Law>
constinit const BondLaw LawObject<Law>::object{
    .name = Law<double>::name,
    .title = Law<double>::title,
    .fields = detail::fields_of<Law<double>>,
    .strained_past = Law<double>::strained_past,
    .rest_condition = Law<double>::rest_condition,
    .rest_way_out = Law<double>::rest_way_out,
    .history = detail::history_names<Law<double>>(),
    .dissipated_at = detail::dissipated_at<Law<double>>(),
    .damped = Damped<Law<double>>,
    .breakable = Breakable<Law<double>>,
    .has_rules = detail::has_rules<Law<double>>(),
    .with_rules = detail::in_form<Law, WithRules>(),
    .with_flow = detail::in_form<Law, WithFlow>(),
    .with_rubbing = detail::in_form<Law, WithRubbing>(),
    .has_offsets = OffsetLaw<Law<double>>,
    .damping_loads =
        [](const Bond& b, const BondPose<double>& pose, const BondRates<double>& rates) {
          if constexpr (Damped<Law<double>>)
            return bond_damping(law_of<Law>(b), pose, bond_axis(law_of<Law>(b), pose), rates);
          else
            return BondLoads<double>{};
        },
    .energy = [](const Bond& b, const BondPose<double>& pose,
                 const BondHistory& h) { return energy_with(law_of<Law>(b), pose, history_of_bond<Law>(h)); },
    .loads =
        [](const Bond& b, const BondPose<double>& pose, const BondHistory& h) {
          return loads_with(law_of<Law>(b), pose, bond_axis(law_of<Law>(b), pose), history_of_bond<Law>(h));
        },
    .tangent =
        [](const Bond& b, const BondPose<double>& pose, [[maybe_unused]] const BondHistory& before) {
          if constexpr (HasRules<Law<double>> && Remembering<Law<double>>)
            return flow_tangent(law_of<Law>(b), pose, history_of_bond<Law>(before));
          else if constexpr (Remembering<Law<double>>)
            return PairTangent<9>{};
          else
            return bond_tangent(law_of<Law>(b), pose);
        },
    .advance =
        [](const Bond& b, const BondPose<double>& pose, const BondRates<double>& rates, double dt,
           const BondHistory& h) {
          if constexpr (Remembering<Law<double>>) {
            return as_bond_history<Law>(advance(law_of<Law>(b), pose, bond_axis(law_of<Law>(b), pose), rates,
                                                dt, history_of_bond<Law>(h)));
          } else {
            return h;
          }
        },
    .crack = detail::crack_of<Law>(),
    .failure =
        [](const Bond& b, const BondPose<double>& pose, const BondHistory& h) {
          Failure<double> f{};
          if constexpr (Breakable<Law<double>>) {
            const Law<double> law = law_of<Law>(b);
            const auto history = history_of_bond<Law>(h);
            const BondAxis<double> axis = bond_axis(law, pose);
            const BondLoads<double> loads = loads_with(law, pose, axis, history);
            if constexpr (requires { bond_failure(law, pose, axis, loads, history); })
              f = bond_failure(law, pose, axis, loads, history);
            else if constexpr (requires { bond_failure(law, pose, axis, loads); })
              f = bond_failure(law, pose, axis, loads);
            else
              f.utilisation = utilisation_with(law, pose, axis, loads, history);
          }
          return f;
        },
    .tension = [](const Bond& b, double D,
                  const BondHistory& h) { return tension_with(law_of<Law>(b), D, history_of_bond<Law>(h)); },
    .stiffness = [](const Bond& b) { return stiffness(law_of<Law>(b)); },
    .stiffest =
        [](const Bond& b) {
          if constexpr (requires { stiffest(law_of<Law>(b)); })
            return stiffest(law_of<Law>(b));
          else
            return stiffness(law_of<Law>(b));
        },
    .damping =
        [](const Bond& b) {
          if constexpr (Damped<Law<double>>)
            return damping(law_of<Law>(b));
          else
            return BondStiffness<double>{};
        },
    .range = [](const Bond& b, const BondShape& s) { return bond_range(law_of<Law>(b), s); },
    .elastic_pose =
        [](const Bond& b, const BondPose<double>& pose, const BondHistory& h) {
          return elastic_pose_with(law_of<Law>(b), pose, history_of_bond<Law>(h));
        },
    .from_stiffness = detail::from_stiffness<Law>,
};

}  // namespace vbond
