#pragma once
#include <string>
#include <vector>

namespace vbond::app {

/// One curve; NaN breaks it.
struct Curve {
  std::string title, x_name;
  const std::vector<double>&x, &y;
};

/// A panel of text, `width` characters wide, with the curve in Unicode braille: 2 x 4 dots a character.
/// width >= 40, height >= 2 lines for the curve itself.
std::string braille_panel(const Curve& curve, int width, int height);

}  // namespace vbond::app
