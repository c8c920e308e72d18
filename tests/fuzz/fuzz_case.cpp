#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "vbond/case/read.hpp"

/// libFuzzer's entry: any text is either a case or refused with a CaseError, and what is accepted survives
/// the way through resolved.toml.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const vbond::Case c = vbond::parse_case({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
    const std::string resolved = vbond::to_toml(c);
    try {
      if (vbond::to_toml(vbond::parse_case(resolved, "fuzz.toml")) != resolved) std::abort();
    } catch (const vbond::CaseError&) {
      std::abort();
    }
  } catch (const vbond::CaseError&) {
  }
  return 0;
}
