// The interface between the library and the shared object with the Point Cloud Library's sample consensus in it, which
// is loaded only if that backend is chosen: core builds and runs without PCL (licence BSD).
#pragma once

#include "pcm/fit/shape_fit.h"

#include <cstddef>
#include <cstdint>

namespace pcm {

enum class PclModel : std::uint8_t { plane, cylinder, sphere, cone };

struct PclRequest {
    PclModel model;
    Estimator estimator;
    const float* xyz;      // three coordinates per point, all finite, near 0
    const float* normals;  // three per point; null: none, which cylinders and cones refuse
    std::size_t points;
    double threshold, probability, least_radius, largest_radius;
    std::uint32_t iterations;  // maximum number of samples
    std::uint32_t seed;
    double pretest;               // RRANSAC and RMSAC: the share of all points, in percent, that has to fit a sample
    bool optimise;                // finish with least squares of the inliers
    bool (*stop)(void* context);  // called before each sample: true ends the search with the best one so far
    void* context;
};

struct PclAnswer {
    // As PCL has them: plane NX NY NZ D; cylinder POINT AXIS RADIUS; sphere CENTRE RADIUS; cone APEX AXIS ANGLE.
    double coefficients[7];
    std::uint64_t samples;
};

struct PclFunctions {
    std::uint32_t version;
    // False where no sample fits any points, and for what PCL throws, which is then in `message`.
    bool (*fit)(const PclRequest& request, PclAnswer& answer, char* message);
};

inline constexpr std::uint32_t pcl_module_version = 1;
inline constexpr std::size_t pcl_message_bytes = 256;

// The one symbol of the shared object: see system/shared_module.h.
inline constexpr const char* pcl_module_symbol = "pcm_pcl_functions";

}  // namespace pcm
