#include "vbond/case/names.hpp"

namespace vbond::keys {

std::string join(const std::vector<std::string>& names, std::string_view quote) {
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += ", ";
    text.append(quote).append(name).append(quote);
  }
  return text;
}

}  // namespace vbond::keys
