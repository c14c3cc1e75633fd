#include "model/schedule.hpp"

#include <cmath>
#include <limits>

namespace pileus::model {

double Schedule::next() const {
  return every_ > 0 ? count_ * every_ : std::numeric_limits<double>::infinity();
}

double Schedule::next_after(double time) const {
  if (!(every_ > 0)) return std::numeric_limits<double>::infinity();
  return (std::floor(time / every_ + 1e-9) + 1) * every_;
}

void Schedule::done(double time) {
  if (every_ > 0) count_ = std::floor(time / every_ + 1e-9) + 1;
}

}  // namespace pileus::model
