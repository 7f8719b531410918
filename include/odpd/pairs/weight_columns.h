#pragma once
// Where W of many pairs goes.

namespace odpd {

/// Columns of W, W', W'' and -W'/r. Those that are null are not wanted.
struct WeightColumns {
  double *W = nullptr, *W_1 = nullptr, *W_2 = nullptr, *slope = nullptr;
};

}  // namespace odpd
