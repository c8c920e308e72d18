#include "vbond/core/error.hpp"

namespace vbond {

std::string to_text(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& p : problems) {
    if (!text.empty()) text += '\n';
    if (!p.place.file.empty()) {
      text += p.place.file + ':';
      if (p.place.line > 0) text += std::to_string(p.place.line) + ':' + std::to_string(p.place.column) + ':';
      text += ' ';
    }
    text += p.what;
    if (!p.rule.empty()) text += "\n  " + p.rule;
    if (!p.way_out.empty()) text += "\n  " + p.way_out;
    if (p.more > 0) text += "\n  and " + std::to_string(p.more) + " more of this kind";
  }
  return printable(text);
}

}  // namespace vbond
