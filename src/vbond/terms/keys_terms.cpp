#include "vbond/terms/keys_terms.hpp"

namespace vbond::keys {

void describe_terms(Table& t, TermSpecs& s, std::optional<StageKind> kind) {
  Terms::for_each([&]<class T>(T) { T::describe(t, s, kind); });
}

}  // namespace vbond::keys
