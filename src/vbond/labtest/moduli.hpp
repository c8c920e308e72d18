#pragma once
#include <cstddef>
#include <vector>

#include "vbond/labtest/made_test.hpp"
#include "vbond/labtest/rows.hpp"

namespace vbond::labtest {

/// Moduli and Poisson's ratios: at rest from the stage "elastic"; in motion from rows between a tenth and
/// half of the peak, before which the platens begin to move, and beyond which bonds break. Notes say where
/// these are no elastic constants.
void find_elastic(const MadeTest& test, const std::vector<Row>& rows, std::size_t peak, TestResult& result);

}  // namespace vbond::labtest
