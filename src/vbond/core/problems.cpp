#include "vbond/core/problems.hpp"

#include <algorithm>

namespace vbond {

void Problems::add(Problem p) {
  count_ += 1 + p.more;
  std::string name = p.place.file + '\n' + p.rule;
  std::erase_if(name, [](char c) { return '0' <= c && c <= '9'; });
  Kind& kind = kinds_[std::move(name)];
  if (kind.shown > 0 && kind.shown >= most_) {  // one is always shown
    shown_[kind.last].more += 1 + p.more;
    return;
  }
  ++kind.shown;
  kind.last = shown_.size();
  shown_.push_back(std::move(p));
}

}  // namespace vbond
