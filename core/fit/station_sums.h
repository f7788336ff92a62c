// What shifted stations of a scanner do to a fit.
//
// A registration leaves each station s of a cloud shifted by some t_s, with a standard deviation of tau along each
// axis. A point of it with the unit normal n is then n . t_s farther from the surface, and a least-squares fit with the
// derivatives J of the distances moves by -A^-1 sum over s of G_s t_s, where A = sum of J J^T over all points and G_s =
// sum of J n^T over those of s. So its covariance is
//
//     noise^2 A^-1 + tau^2 A^-1 (sum over s of G_s G_s^T) A^-1:
//
// Turned stations are such clusters, too: a turn by omega_s around the shape's middle m moves p by omega_s x (p - m),
// so G_s has the sums of J ((p - m) x n)^T in its place. What turns shift as a whole is in tau, which surfaces near
// the shape show.
//
// a sandwich by cluster (Liang, Zeger 1986) whose filling is the one that the shifts make, which holds for any number
// of stations, even for one, where the residuals' own filling needs many more stations than the shape has numbers.
// tau is estimated from what no shape explains: station_spread.h.
#pragma once

#include "pcm/fit/station_spread.h"
#include "pcm/fit/surface_patch.h"
#include "pcm/shapes/fitted_shape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace pcm {

// How far stations are from where they should be: standard deviations.
struct StationMoves {
    double shift = 0;  // along each axis, source units
    double turn = 0;   // about each axis, radians
};

// The fit of a shape with its stations shifted as is most probable, which leaves the noise of the points alone.
struct ShiftedFit {
    std::array<double, most_parameters> moved{};
    std::map<std::uint32_t, Vec3d> shifts;  // keyed by station; source units
};

// Sums over the points of each station. Sums of parts may be added in a fixed order, so that the result does not depend
// on threads. One object by one thread. Memory: a kilobyte a station.
class StationSums {
public:
    // As ShapeSums.
    StationSums(const Shape& shape, const Vec3d& middle, double extent);

    void add(const Vec3d& p, std::uint32_t station);  // source coordinates
    void add(const StationSums& other);               // sums of the same shape, middle and extent

    std::size_t stations() const { return stations_.size(); }
    std::uint64_t points() const;

    // False where the points do not determine the shape: then nothing below is of use.
    bool is_determined() const;
    // Standard deviation of the points' distances, source units: as one cloud, and with their stations shifted.
    double noise_as_one() const;
    double noise_within() const;
    // What the stations' differences on this surface say of the spread; `noise` of independent points, source units.
    StationEvidence evidence(double noise) const;
    // Errors that stations cause that are moved independently.
    ShapeErrors errors_of(const StationMoves& moves) const;
    // With the shifts that are most probable for that spread; and how far a point is from it, source units.
    ShiftedFit shifted(double spread, double noise) const;
    double distance(const ShiftedFit& fit, const Vec3d& p, std::uint32_t station) const;

private:
    struct OfStation {
        std::uint64_t points = 0;
        double squares = 0;                                                // squared distances
        std::array<double, most_parameters> gradient{};                    // sum of J d
        std::array<double, most_parameters * most_parameters> products{};  // A; whole
        std::array<double, most_parameters * 3> across{};                  // G, row by row
        std::array<double, most_parameters * 3> around{};                  // G by turns
        std::array<double, 9> normals{};                                   // sum of n n^T
        Vec3d pulls{};                                                     // sum of n d
    };
    struct Seen {
        double distance = 0;
        std::array<double, most_parameters> by{};
        Vec3d normal{}, turned{};  // n, (p - m) x n
    };
    Seen see(const Vec3d& p) const;
    struct Whole;
    Whole whole() const;

    Shape shape_;
    Vec3d middle_;
    double extent_;
    SurfacePatch patch_;
    double side_ = 1;  // 1 or -1: the patch's normals by the shape's
    std::map<std::uint32_t, OfStation> stations_;
};

}  // namespace pcm
