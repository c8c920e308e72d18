#include "vbond/terms/detail/rest_terms.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {

std::unique_ptr<RestTerm> Term::at_rest(const StaticBody&, State&) {
  return nullptr;
}

RestTerms::RestTerms(const StaticBody& body, State& state) {
  auto next = list_.begin();
  Terms::for_each([&]<class T>(T) { *next++ = T::at_rest(body, state); });
  for (const auto& t : list_)
    if (t != nullptr && t->is_there()) all_.push_back(t.get()), seen_.push_back(t.get());
}

std::vector<TermHold> RestTerms::holds(bool to_come) const {
  std::vector<TermHold> all;
  for (const RestTerm* t : all_) t->add_holds(to_come, all);
  return all;
}

std::optional<std::string> RestTerms::without_energy() const {
  for (const RestTerm* t : all_)
    if (auto where = t->without_energy()) return where;
  return std::nullopt;
}

}  // namespace vbond
