#pragma once
#include "vbond/model/contact.hpp"

namespace vbond {

/// Whether contacts feel how particles slide or roll over each other, and so would have to feel the jumps of
/// an imposed strain, which have no velocity.
constexpr bool feels_sliding(const ContactModel& c) {
  return c.law != ContactLaw::none &&
         (c.tangential != TangentialForm::none || c.rolling != RollingForm::none);
}

}  // namespace vbond
