#pragma once
// Symmetric sparse matrix of dense b x b blocks, stored in full, rows in order, columns ascending.
#include <cstdint>
#include <vector>

namespace odpd {

struct BlockCsr {
  int block = 1;                     ///< b: rows and columns of a block
  std::int32_t rows = 0;             ///< block rows (= block columns)
  std::vector<std::int32_t> start;   ///< rows + 1 offsets into `column`
  std::vector<std::int32_t> column;  ///< block column of each stored block, ascending in a row
  std::vector<double> value;         ///< b*b per block, row-major
};

}  // namespace odpd
