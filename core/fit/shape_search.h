// The best of many minimal samples.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <functional>

namespace pcm {

struct SearchOptions {
    ShapeFitOptions fit;   // radii in working units
    double threshold = 0;  // working units, above 0
    // False: time is up. May throw.
    std::function<bool(double fraction)> on;
};

struct SearchResult {
    bool found = false;
    Shape shape;  // working units
    std::uint64_t samples = 0;
};

SearchResult search_shape(const WorkingPoints& points, const SearchOptions& options);

}  // namespace pcm
