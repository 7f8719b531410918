#include "odpd/scene/vector_key.h"

#include <fmt/format.h>

#include <vector>

#include "odpd/core/index.h"

namespace odpd {

namespace {
template <int D>
Vec<D> vector_of(const Config& config, const std::string& key, const std::vector<double>& values) {
  if (values.size() != D)
    config.fail(key, fmt::format("{} components are needed in {} dimensions, there are {}", D, D,
                                 values.size()));
  Vec<D> v;
  for (int c = 0; c < D; ++c) v[c] = values[index(c)];
  return v;
}
}  // namespace

template <int D>
Vec<D> read_vector(const Config& config, const std::string& key) {
  return vector_of<D>(config, key, config.numbers(key));
}

template <int D>
Vec<D> read_optional_vector(const Config& config, const std::string& key) {
  return vector_of<D>(config, key, config.numbers(key, std::vector<double>(D, 0.0)));
}

template Vec<2> read_vector<2>(const Config&, const std::string&);
template Vec<3> read_vector<3>(const Config&, const std::string&);
template Vec<2> read_optional_vector<2>(const Config&, const std::string&);
template Vec<3> read_optional_vector<3>(const Config&, const std::string&);

}  // namespace odpd
