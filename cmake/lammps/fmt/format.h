// LAMMPS' headers of 29 Sep 2021 include the copy of libfmt that LAMMPS is built with; Debian does not install it. What
// they name of it, for sources that call none of it.
#pragma once
#include <string>

namespace fmt {
struct string_view;
struct format_args;
template <class... Args, class S>
format_args make_args_checked(const S& format, Args&&...);
}  // namespace fmt
