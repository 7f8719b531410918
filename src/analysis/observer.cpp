#include "odpd/analysis/observer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace odpd {

namespace {

// Steps of the measured part that an entry asks for by times.
void read_time_window(const Config& entry, const Clock& clock, ObserverSettings& settings) {
  if (entry.has("from")) settings.from = std::llround(entry.non_negative("from", 0.0) / clock.dt);
  if (entry.has("until")) settings.until = std::llround(entry.positive("until") / clock.dt);
  const std::int64_t last = std::min(settings.until, clock.total_steps - clock.equilibration_steps);
  const std::int64_t every = settings.every;
  if ((entry.has("from") || entry.has("until")) && last / every <= settings.from / every)
    entry.fail(
        entry.has("from") ? "from" : "until",
        fmt::format(
            "no step of the run is left to sample: after {} and up to {} of its {} "
            "measured time units, every {} step(s)",
            static_cast<double>(settings.from) * clock.dt, static_cast<double>(last) * clock.dt,
            static_cast<double>(clock.total_steps - clock.equilibration_steps) * clock.dt, every));
}

}  // namespace

template <int D>
ObserverSettings ObserverEntry<D>::settings(std::int64_t default_every) const {
  ObserverSettings settings;
  settings.kind = kind;
  settings.name = config.text("name", kind);
  // It becomes the stem of files.
  if (!is_plain_name(settings.name) || settings.name == "particles")
    config.fail("name",
                "use letters, digits, _ and - (and not 'particles', which names a picture)");
  settings.every = config.positive_integer("every", default_every);
  settings.series = config.boolean("series", false);
  read_time_window(config, clock, settings);
  return settings;
}

template <int D>
Observer<D>::Observer(ObserverSettings settings, std::vector<std::string> columns)
    : settings_(std::move(settings)), columns_(std::move(columns)), average_(columns_.size()) {}

template <int D>
Observer<D>::Observer(ObserverSettings settings, std::size_t width)
    : settings_(std::move(settings)), average_(width) {}

template <int D>
void Observer<D>::add(std::vector<double> sample) {
  newest_ = std::move(sample);
  average_.add(newest_);
}

template <int D>
Scalar Observer<D>::mean_of(std::size_t column, std::string scalar_name) const {
  return {std::move(scalar_name), average_.mean(column), average_.standard_error(column)};
}

template <int D>
void Observer<D>::add_results(Results& results) const {
  for (std::size_t k = 0; k < columns_.size(); ++k)
    results.scalars.push_back(mean_of(k, named(columns_[k])));
}

template <int D>
void Observer<D>::save(StateWriter& out) const {
  average_.save(out, "average");
}

template <int D>
void Observer<D>::load(const StateReader& in) {
  average_.load(in, "average");
}

template struct ObserverEntry<2>;
template struct ObserverEntry<3>;
template class Observer<2>;
template class Observer<3>;

}  // namespace odpd
