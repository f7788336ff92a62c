// The verdict on a shape that was followed through a cloud: whether its points are one surface, of that kind, with the
// noise that the points at the place have.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/place/cut_out_evidence.h"
#include "pcm/place/departure.h"
#include "pcm/place/fit_at.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/stations_around.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm {

// The shape that it was before it was followed, which it has left.
void come_back(const std::string& why, FitIssue issue, FittedPrimitive& result);

// The points as growth left them.
struct FollowedPoints {
    const PointSet& around;  // connected, up to around_thresholds from the shape
    double noise = 0;        // GrownShape::noise and agreement
    double agreement = 1;
    const std::optional<SweptPart>& part;  // GrownShape::part
    double inner_share = 1;                // GrownShape::inner_share
};

// Standard deviations, source units; 0: unknown.
struct KnownErrors {
    double close_noise = 0;   // points at the places, from their own surface
    double own_noise = 0;     // nearest points (EvenNoise): clutter or the other face of a plate enlarge close_noise
    double registration = 0;  // given shift of a scanner's station along each axis
};

// Keeps references. One object by one thread.
class FollowedVerdict {
public:
    FollowedVerdict(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options,
                    const KnownErrors& known, StationsAround& around, const ProgressFunction& progress);

    // Doubts a good fit whose points may be a ring or strip of another surface, nearly all next to points that leave
    // it, several surfaces within a wide threshold, there by chance, out of round or bulged. Says of the last, also of
    // a fit that is doubted as one of several surfaces, by how much they are.
    void judge(const FollowedPoints& followed, FittedPrimitive& result);
    // A shape of another of the wanted kinds, if these points are far more probable for it. It is to be followed in
    // turn, and if it cannot be, the fit is doubtful for the reason `other_doubt`.
    const std::optional<ShapeFit>& other_kind() const { return other_; }
    const std::string& other_doubt() const { return other_doubt_; }
    // A point of the bend, where the place may lie on that.
    const std::optional<Vec3d>& place_on_bend() const { return place_on_bend_; }
    // The stations that see the face at the place, where it was doubted as the middle of a plate.
    const std::vector<std::uint32_t>& stations_at_place() const { return stations_at_place_; }
    // Whether it was doubted because the threshold cuts the noise of its points.
    bool cuts_noise() const { return cuts_noise_; }

private:
    struct Stations {
        double spread = 0;       // along each axis, source units; 0: they are not apart, or nothing is known
        double most_spread = 0;  // upper limit of the spread, which few differences leave uncertain
    };

    // `around`: points of coarse levels, up to around_thresholds from the shape; `fitted`: random sample of those
    // fitted.
    void judge_noise(const FollowedPoints& followed, const std::vector<Vec3d>& around, const std::vector<Vec3d>& fitted,
                     FittedPrimitive& result);
    void judge_kind(const FollowedPoints& followed, const std::vector<Vec3d>& around, const std::vector<Vec3d>& fitted,
                    FittedPrimitive& result);
    // Says of points that were taken for those of several surfaces by how much they leave the shape together, if so.
    void name_departure(const FollowedPoints& followed, const std::vector<Vec3d>& fitted, FittedPrimitive& result);
    static void doubt_uneven(const Departure& departure, FittedPrimitive& result);
    // All of few points lie next to others that cross the shape, or neighbours leave the shape together by more than
    // noise and what is known of the stations' shifts explain, or a curved shape is far rougher than surfaces around.
    void doubt_others(const FollowedPoints& followed, const CutOutEvidence& cut_out, const Departure& departure,
                      double noise, ShapeFit& fit);
    // A plane is a narrow strip that surfaces next to it may have turned.
    void doubt_strip(const FollowedPoints& followed, const std::vector<Vec3d>& fitted, FittedPrimitive& result) const;
    // The place may lie on an elbow of the pipe that was found, or on a pipe of the elbow.
    void doubt_bent(const FollowedPoints& followed, double noise, FittedPrimitive& result);
    // Few points fit another kind with as many numbers as well.
    void doubt_equal_kind(const std::vector<Vec3d>& fitted, ShapeFit& fit) const;
    // Growth has ended with the rounds, not with the shape.
    void doubt_unsettled(const FollowedPoints& followed, FittedPrimitive& result) const;
    // Stations see the plane from two sides.
    void doubt_sides(double noise, FittedPrimitive& result);
    // Points of single stations, `some` of the plane's, leave it by far more than smooth surfaces around, and
    // neighbours do not share that, as on a rough surface: pipes side by side.
    void doubt_rough(double within, double smooth, const std::vector<PointOfStation>& some,
                     FittedPrimitive& result) const;
    bool is_far_above_close_noise(const ShapeFit& fit, double noise, double bend, const NearPoints& near);
    bool passes_places(const ShapeFit& fit, const NearPoints& near) const;
    std::optional<ShapeKind> far_better_kind(const FittedPrimitive& result, double noise,
                                             const std::vector<Vec3d>& around) const;
    void find_other_kind(const ShapeFit& fit, const PointSet& around);
    double resolution() const;
    double known_noise() const;
    const Stations& stations();
    Departure without_stations(const Departure& departure, const std::optional<SweptPart>& part,
                               const FittedPrimitive& result);
    bool is_of_stations(double noise, const SurfaceEvidence& evidence, const std::optional<SweptPart>& part,
                        const FittedPrimitive& result);

    const PointCloud& cloud_;
    const std::vector<Vec3d>& places_;
    const FitAtOptions& options_;
    const KnownErrors known_;
    StationsAround& around_;
    const ProgressFunction& progress_;
    std::optional<ShapeFit> other_;
    std::string other_doubt_;
    std::optional<Vec3d> place_on_bend_;
    std::vector<std::uint32_t> stations_at_place_;
    bool cuts_noise_ = false;
    std::optional<Stations> stations_;  // once they were looked for
};

}  // namespace pcm
