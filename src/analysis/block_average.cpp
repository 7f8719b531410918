#include "odpd/analysis/block_average.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {
constexpr std::size_t most_blocks = 64;
constexpr std::size_t fewest_blocks = 16;
}  // namespace

BlockAverage::BlockAverage(std::size_t width)
    : width_(width), total_(width, 0.0), open_(width, 0.0) {}

void BlockAverage::add(std::span<const double> sample) {
  for (std::size_t c = 0; c < width_; ++c) {
    total_[c] += sample[c];
    open_[c] += sample[c];
  }
  ++samples_;
  if (++in_open_block_ < block_length_) return;
  blocks_.insert(blocks_.end(), open_.begin(), open_.end());
  std::fill(open_.begin(), open_.end(), 0.0);
  in_open_block_ = 0;
  if (blocks_.size() < most_blocks * width_) return;
  for (std::size_t k = 0; k < most_blocks / 2; ++k)
    for (std::size_t c = 0; c < width_; ++c)
      blocks_[k * width_ + c] = blocks_[2 * k * width_ + c] + blocks_[(2 * k + 1) * width_ + c];
  blocks_.resize(most_blocks / 2 * width_);
  block_length_ *= 2;
}

double BlockAverage::mean(std::size_t column) const {
  return total_[column] / static_cast<double>(samples_);
}

double BlockAverage::plateau(std::vector<double> blocks) {
  if (blocks.size() < fewest_blocks) return std::numeric_limits<double>::quiet_NaN();
  double largest = 0.0;
  while (blocks.size() >= fewest_blocks) {
    const auto n = static_cast<double>(blocks.size());
    double mean = 0.0;
    for (double b : blocks) mean += b / n;
    double square = 0.0, lagged = 0.0;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      square += (blocks[k] - mean) * (blocks[k] - mean);
      if (k > 0) lagged += (blocks[k] - mean) * (blocks[k - 1] - mean);
    }
    double error = std::sqrt(square / (n * (n - 1.0)));
    // Blocks that still follow each other count for fewer: (1 + c)/(1 - c) for a first-order autoregression.
    const double correlation = square > 0.0 ? std::min(lagged / square, 0.95) : 0.0;
    if (correlation > 2.0 / std::sqrt(n))
      error *= std::sqrt((1.0 + correlation) / (1.0 - correlation));
    if (std::isnan(error)) return error;  // of numbers that are undefined
    largest = std::max(largest, error);
    const std::size_t half = blocks.size() / 2;
    for (std::size_t k = 0; k < half; ++k) blocks[k] = 0.5 * (blocks[2 * k] + blocks[2 * k + 1]);
    blocks.resize(half);
  }
  return largest;
}

double BlockAverage::standard_error(std::size_t column) const {
  std::vector<double> means;
  for (std::size_t k = column; k < blocks_.size(); k += width_)
    means.push_back(blocks_[k] / static_cast<double>(block_length_));
  return plateau(std::move(means));
}

double BlockAverage::ratio(std::size_t numerator, std::size_t denominator) const {
  return total_[numerator] / total_[denominator];
}

double BlockAverage::ratio_error(std::span<const RatioTerm> terms) const {
  std::vector<double> deviation;
  for (std::size_t k = 0; k < blocks_.size(); k += width_) {
    double sum = 0.0;
    for (const RatioTerm& t : terms) {
      const double excess =
          blocks_[k + t.numerator] - ratio(t.numerator, t.denominator) * blocks_[k + t.denominator];
      sum += t.weight * excess / (mean(t.denominator) * static_cast<double>(block_length_));
    }
    deviation.push_back(sum);
  }
  return plateau(std::move(deviation));
}

double BlockAverage::jackknife_error(std::vector<double> left_out) {
  // Pseudo-values: deviations of the leave-one-out values, scaled to the deviations of the blocks themselves.
  const auto n = static_cast<double>(left_out.size());
  double mean_value = 0.0;
  for (double v : left_out) mean_value += v / n;
  for (double& v : left_out) v = (n - 1.0) * (mean_value - v);
  return plateau(std::move(left_out));
}

std::vector<double> BlockAverage::column_means(std::int64_t without_block) const {
  std::vector<double> means(width_, 0.0);
  const std::size_t n = blocks_.size() / width_;
  for (std::size_t k = 0; k < n; ++k) {
    if (static_cast<std::int64_t>(k) == without_block) continue;
    for (std::size_t c = 0; c < width_; ++c)
      means[c] += blocks_[k * width_ + c] / static_cast<double>((n - 1) * index(block_length_));
  }
  return means;
}

void BlockAverage::save(StateWriter& out, const std::string& name) const {
  out.write(name + "/counts", std::vector<std::int64_t>{samples_, block_length_, in_open_block_});
  out.write(name + "/total", total_);
  out.write(name + "/open", open_);
  out.write(name + "/blocks", blocks_);
}

void BlockAverage::load(const StateReader& in, const std::string& name) {
  const std::vector<std::int64_t> counts = in.read_integers(name + "/counts");
  total_ = in.read_doubles(name + "/total");
  open_ = in.read_doubles(name + "/open");
  blocks_ = in.read_doubles(name + "/blocks");
  if (counts.size() != 3 || total_.size() != width_ || open_.size() != width_ ||
      blocks_.size() % width_ != 0)
    throw IoError(
        fmt::format("the checkpoint's averages '{}' do not hold {} columns: it is damaged "
                    "or of another case",
                    name, width_));
  samples_ = counts[0];
  block_length_ = counts[1];
  in_open_block_ = counts[2];
}

}  // namespace odpd
