#pragma once
#include <string>

namespace vbond::app {

/// How a command ended that has thrown: what is told of it, and the exit status.
struct Failure {
  int status;
  std::string text;
  bool anywhere = false;  ///< memory that has run out, or a mistake of the program: it may come at any place
};

/// Of the exception under way: to be called where it is caught.
Failure failure_under_way();

}  // namespace vbond::app
