// A body that goes on where it was stopped, to the last bit.
#include <utility>

#include "vbond/statics/detail/body.hpp"

namespace vbond {

void StaticBody::make_room_for(std::vector<Assembly::Pair> pairs, bool flows) {
  flows_ = flows;
  if (!pairs.empty()) lay_out_for(std::move(pairs));
}

void StaticBody::stand_as_then(const Placement& at, const std::vector<BondId>& broken) {
  for (const BondId k : broken) state_.bonds[k].broken = true;
  touching_.forget();
  restore(at);
}

void StaticBody::take_tangent_of(PerBond<BondHistory> remembered) {
  if (remembered.empty()) return;
  std::swap(accepted_before_, remembered);
  stiffness_.current = false;
  stiffness_at_hand();
  std::swap(accepted_before_, remembered);
  of_tangent_ = std::move(remembered);
}

void StaticBody::go_on_from(State now, double load_factor, std::int64_t breaks,
                            PerBond<BondHistory> remembered_before) {
  state_ = std::move(now);
  load_factor_ = load_factor;
  breaks_ = breaks;
  touching_.forget();
  bonded_.assign(model_.particles(), false);
  for (const Bond& b : state_.bonds)
    if (!b.broken) bonded_[b.i] = bonded_[b.j] = true;
  if (flows()) {
    accepted_ = state_.bond_history;
    accepted_before_ = std::move(remembered_before);
    accepted_at_ = placement();
  }
  placed();
  for (RestTerm* t : terms_.all()) t->accept();
}

}  // namespace vbond
