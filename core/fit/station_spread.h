// How far the stations of a scanner are apart after their registration, from surfaces that several of them see.
//
// With Z the normals of a surface's points, those of station s in its three columns, and M what is left of a vector
// when all that a change of the surface explains is taken from it, the stations' shifts t leave u = Z^T M d in the
// distances d, and u is normal with the covariance tau^2 H^2 + noise^2 H, H = Z^T M Z. H and u of several surfaces are
// added. In the eigenvectors of H with eigenvalues above 0 the observations u / lambda are independent, with the
// variance tau^2 + noise^2 / lambda: one number is to be found, by greatest likelihood, which is the restricted one
// (REML, Patterson and Thompson 1971). There are at most 3 (stations - 1) of them: how far all are shifted together no
// surface shows.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace pcm {

struct StationSpread {
    double spread = 0;                      // tau, source units
    std::uint32_t freedom = 0;              // number of differences that it is from
    std::size_t stations = 0;               // with which surfaces have to do
    std::map<std::uint32_t, Vec3d> shifts;  // most probable ones, source units
};

// H and u in units of a surface's noise. One object by one thread.
class StationEvidence {
public:
    static constexpr std::size_t most_stations = 48;  // those with the least numbers; others are ignored

    // What one surface says: `h` has 3 x 3 numbers for each pair of stations, row by row, in the order of `stations`; u
    // three a station. `noise` > 0, source units.
    void add(const std::vector<std::uint32_t>& stations, const std::vector<double>& h, const std::vector<double>& u,
             double noise);
    void add(const StationEvidence& other);

    std::size_t stations() const { return pulls_.size(); }
    // How far the differences are from those that shifts of the stations explain, on average, source units; 0 without
    // evidence. Stations without a shift are where they are.
    double deviation_from(const std::map<std::uint32_t, Vec3d>& shifts) const;
    // `alike`: how many times as large errors of points are as those of independent ones.
    StationSpread spread(double alike = 1) const;

private:
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    std::map<Pair, std::array<double, 9>> products_;
    std::map<std::uint32_t, Vec3d> pulls_;
};

// By how much an error has to be larger that is estimated from few differences, so that it covers what a standard
// deviation does: the two-sided 68.27 % quantile of Student's t. 1 for 0.
double student_factor(std::uint32_t freedom);

}  // namespace pcm
