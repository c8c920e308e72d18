#include "vbond/observe/frame_names.hpp"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

#include "vbond/observe/detail/name_parts.hpp"

namespace vbond {
namespace {

/// A number in digits alone, which are taken off.
std::optional<std::int64_t> take_number(std::string_view& text) {
  if (text.empty() || text[0] < '0' || text[0] > '9') return std::nullopt;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

std::string frame_name(const char* kind, std::int64_t step) {
  return fmt::format("frames/{}_{:012}.vtp", kind, step);
}

std::string name_of_part(const char* kind, std::int64_t step, int part) {
  return fmt::format("frames/{}_{:012}_{}.vtp", kind, step, part);
}

std::string name_of_parts(const char* kind, std::int64_t step) {
  return fmt::format("frames/{}_{:012}.pvtp", kind, step);
}

std::optional<std::int64_t> step_of_frame(std::string_view name) {
  take_off_end(name, ".part");
  const bool lists = take_off_end(name, ".pvtp");
  if (!lists && !take_off_end(name, ".vtp")) return std::nullopt;
  if (!take_off_front(name, "particles_") && !take_off_front(name, "bonds_") &&
      !take_off_front(name, "walls_") && !take_off_front(name, "contacts_") && !take_off_front(name, "cell_"))
    return std::nullopt;
  const std::optional<std::int64_t> step = take_number(name);
  if (step && !lists && take_off_front(name, "_") && !take_number(name)) return std::nullopt;
  return name.empty() ? step : std::nullopt;
}

}  // namespace vbond
