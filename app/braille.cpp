#include "braille.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

namespace vbond::app {
namespace {

constexpr int label_width = 12;

struct Limits {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double x) { low = std::min(low, x), high = std::max(high, x); }
  /// The dot of a value, 0 to dots - 1.
  int dot(double x, int dots) const {
    return high > low ? static_cast<int>(std::lround((x - low) / (high - low) * (dots - 1))) : dots / 2;
  }
};

class Canvas {
 public:
  Canvas(int columns, int rows)
      : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns * rows)) {}
  int width() const { return 2 * columns_; }
  int height() const { return 4 * rows_; }

  /// y upwards.
  void set(int x, int y) {
    // U+2800: dots of the left column are bits 0 1 2 6 from above, of the right one 3 4 5 7
    constexpr std::uint8_t bits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    const int down = height() - 1 - y;
    auto& cell = cells_[static_cast<std::size_t>(down / 4 * columns_ + x / 2)];
    cell = static_cast<std::uint8_t>(cell | bits[down % 4][x % 2]);
  }

  void line(int x0, int y0, int x1, int y1) {
    const int n = std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1});
    for (int k = 0; k <= n; ++k)
      set(static_cast<int>(std::lround(x0 + static_cast<double>(k) * (x1 - x0) / n)),
          static_cast<int>(std::lround(y0 + static_cast<double>(k) * (y1 - y0) / n)));
  }

  std::string row(int r) const {
    std::string text;
    for (int c = 0; c < columns_; ++c) {
      const std::uint8_t dots = cells_[static_cast<std::size_t>(r * columns_ + c)];
      text += static_cast<char>(0xe2);  // UTF-8 of U+2800 + dots
      text += static_cast<char>(0xa0 | dots >> 6);
      text += static_cast<char>(0x80 | (dots & 0x3f));
    }
    return text;
  }

 private:
  int columns_, rows_;
  std::vector<std::uint8_t> cells_;
};

bool is_point(const Curve& c, std::size_t k) {
  return std::isfinite(c.x[k]) && std::isfinite(c.y[k]);
}

void draw(const Curve& c, const Limits& x, const Limits& y, Canvas& canvas) {
  bool connected = false;
  int last_x = 0, last_y = 0;
  for (std::size_t k = 0; k < c.x.size(); ++k) {
    if (!is_point(c, k)) {
      connected = false;
      continue;
    }
    const int at_x = x.dot(c.x[k], canvas.width()), at_y = y.dot(c.y[k], canvas.height());
    canvas.line(connected ? last_x : at_x, connected ? last_y : at_y, at_x, at_y);
    connected = true;
    last_x = at_x, last_y = at_y;
  }
}

}  // namespace

std::string braille_panel(const Curve& c, int width, int height) {
  Limits x, y;
  for (std::size_t k = 0; k < c.x.size(); ++k)
    if (is_point(c, k)) x.add(c.x[k]), y.add(c.y[k]);
  if (!(x.low <= x.high)) return c.title + ": no values\n";
  Canvas canvas(width - label_width - 2, height);
  draw(c, x, y, canvas);
  std::string text = c.title + '\n';
  for (int r = 0; r < height; ++r) {
    const std::string label = r == 0            ? fmt::format("{:.5g}", y.high)
                              : r == height - 1 ? fmt::format("{:.5g}", y.low)
                                                : std::string();
    text += fmt::format("{:>{}} |{}\n", label, label_width, canvas.row(r));
  }
  const std::string low = fmt::format("{:.5g}", x.low), high = fmt::format("{:.5g}", x.high);
  const int room = width - label_width - 2 - static_cast<int>(low.size() + high.size());
  return text + fmt::format("{:{}}{}{:^{}.{}}{}\n", "", label_width + 2, low, c.x_name, std::max(room, 0),
                            std::max(room, 0), high);
}

}  // namespace vbond::app
