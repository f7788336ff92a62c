// How far neighbouring points share their errors.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/fit/shape_fit.h"

#include <array>
#include <map>

namespace pcm {

// Distances of points from their shape, summed in cubes. How many times as large the errors of the fit are as those of
// independent points is the root of
//
//     (sum over cubes of (sum of the distances in the cube)^2) / (sum of all squared distances),
//
// where that is above 1 by more than three of its own standard deviations. One object by one thread.
class ErrorAgreement {
public:
    // `edge` of the cubes, source units; 0: factor() is 1.
    ErrorAgreement(const Vec3d& corner, double edge) : corner_(corner), edge_(edge) {}

    void add(const Vec3d& p, double distance);
    void add(const ErrorAgreement& other);  // `other` has the same cubes; a fixed order gives the same bits
    double factor() const;                  // at least 1

private:
    struct CubeSum {
        double distances = 0, squares = 0;
    };
    Vec3d corner_{};
    double edge_ = 0;
    std::map<std::array<int, 3>, CubeSum> cubes_;
};

void enlarge(ShapeErrors& errors, double factor);

}  // namespace pcm
