#pragma once
#include <string>

namespace vbond::app {

/// How a command ended that has thrown: what is told of it, and the exit status.
struct Failure {
  int status;
  std::string text;
  bool unforeseen = false;  ///< memory has run out, or the program has a mistake: at any place
};

/// Of the exception under way: to be called where it is caught.
Failure failure_under_way();

}  // namespace vbond::app
