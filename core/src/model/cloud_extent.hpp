// Where cloud is: seen from above, its lowest and its highest part.
#pragma once
#include "model/simulation.hpp"

namespace pileus::model {

struct CloudExtent {
  double cover = 0;  // share of the columns of cells that hold the centre of a cloudy parcel
  double base, top;  // heights of the lowest and highest cloudy parcel, m; NaN without cloud
};

/// `liquid`: of every parcel; cloudy ones have more than `threshold`.
CloudExtent cloud_extent(const Simulation& simulation, const double* liquid, double threshold);

}  // namespace pileus::model
