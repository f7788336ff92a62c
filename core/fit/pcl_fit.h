// fit_shape() by the Point Cloud Library, for comparison: FitBackend::pcl.
//
// PCL computes in single precision, here of coordinates relative to the points' middle. Its answer is kept as it is;
// inliers, errors and verdict come from the same sums as those of our own fits (fit/shape_sums.h).
#pragma once

#include "pcm/fit/shape_fit.h"

namespace pcm {

struct PclOptions {
    // PCL's least squares of the inliers at the end, as its SACSegmentation does unless asked otherwise.
    bool optimise = true;
    // For RRANSAC and RMSAC: the number of points that must all fit a sample before it is scored. One is best (Matas,
    // Chum 2004); PCL's own default, 10 % of all points, lets no sample pass where outliers are many.
    std::size_t pretest = 1;
};

struct PclShape {
    bool found = false;
    Shape shape;  // source coordinates
    std::uint64_t samples = 0;
};

// PCL's answer alone. Of `options` it reads kind, estimator, threshold (0: automatic_threshold()), iterations,
// probability (not for PROSAC, which takes 0.95), seconds, seed, radii (planes and cones have none) and progress.
// At most options.iterations samples are drawn, with each estimator: PCL's RRANSAC and RMSAC do not count samples that
// fail the pretest, and never end where all do. MLESAC's threshold is two of PCL's standard deviations. PROSAC takes
// the points in their order for the order of quality. Cylinders and cones need normals; they are estimated where there
// are none. Throws as fit_shape(), and Error(unsupported) for a torus. One thread.
PclShape pcl_shape(const FitPoints& points, const ShapeFitOptions& options, const PclOptions& pcl = {});

bool has_pcl();                // whether the backend is installed, without loading it: for what is only shown
bool pcl_has(ShapeKind kind);  // all but the torus

// pcl_shape(), with inliers, errors and verdict.
ShapeFit pcl_fit(const FitPoints& points, const ShapeFitOptions& options);

}  // namespace pcm
