#include "pcm/place/face_at_place.h"

#include "pcm/place/tuning.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace pcm {
namespace {

constexpr int most_lowered = 2;  // halvings of the threshold

class FaceSearch {
public:
    FaceSearch(const Vec3d& place, const LocalFitOptions& options, NearPoints close)
        : place_(place), options_(options.fit), close_(std::move(close))
    {
        options_.kind = ShapeKind::plane;
        options_.progress = {};
    }

    std::optional<LocalFit> run()
    {
        const double noise = automatic_threshold(close_.points);
        for (int lowered = 0; lowered <= most_lowered && noise > 0; ++lowered) {
            options_.threshold = std::ldexp(noise, -lowered);
            const ShapeFit most = fit_shape(close_.points, options_);
            if (!holds_noise(most)) continue;
            const double gap = distance_to(most.shape, place_);
            if (!(gap > tuned_.min_gap * most.threshold)) continue;
            LocalFit face;
            face.near = through_place(most.shape, gap / 2);
            if (static_cast<double>(face.near.ids.size()) < share(tuned_.min_share) ||
                static_cast<double>(others(most, face.near)) > share(tuned_.max_others))
                continue;
            face.fit = fitted(face.near, gap / 2);
            if (face.fit.verdict != FitVerdict::good || !holds_noise(face.fit) ||
                distance_to(face.fit.shape, place_) > face.fit.threshold)
                continue;
            face.close = face.near;
            face.noise = face.fit.threshold;
            face.notes.push_back("most of the points around the place are those of another face, " + brief(gap) +
                                 " from it: the neighbourhood was narrowed to " + grouped(face.near.ids.size()) +
                                 " points of this one");
            return face;
        }
        return {};
    }

private:
    double share(double of) const { return of * static_cast<double>(close_.ids.size()); }

    static bool holds_noise(const ShapeFit& fit)
    {
        return fit.has_shape() && fit.noise < place_tuning().neighbourhood.max_noise_share * fit.threshold;
    }

    // Within all of the noise of the points, but no farther than the middle between the faces.
    ShapeFit fitted(const NearPoints& near, double most) const
    {
        ShapeFitOptions options = options_;
        options.threshold = most;
        const ShapeFit wide = fit_shape(near.points, options);
        const double enough = place_tuning().evidence.spread_noises * wide.noise;
        options.threshold = std::min(most, std::max(options_.threshold, enough));
        return wide.has_shape() && options.threshold < most ? fit_shape(near.points, options) : wide;
    }

    // The points up to a distance from the plane through the place that is parallel to this one.
    NearPoints through_place(Shape plane, double most) const
    {
        plane.point = place_;
        NearPoints face;
        face.points.origin = close_.points.origin;
        face.radius = close_.radius;
        face.spacing = close_.spacing;
        for (std::size_t i = 0; i < close_.ids.size(); ++i) {
            if (distance_to(plane, close_.points.source(i)) > most) continue;
            face.ids.push_back(close_.ids[i]);
            if (close_.points.has_normals())
                face.points.add(close_.points.source(i), close_.points.normal(i));
            else
                face.points.add(close_.points.source(i));
        }
        face.found = face.ids.size();
        return face;
    }

    // Number of points on neither face.
    std::size_t others(const ShapeFit& most, const NearPoints& face) const
    {
        std::size_t on = 0;
        for (const std::uint8_t is_on : most.is_inlier) on += is_on ? 1 : 0;
        const std::size_t both = on + face.ids.size();
        return both < close_.ids.size() ? close_.ids.size() - both : 0;
    }

    const FaceTuning& tuned_ = place_tuning().faces;
    const Vec3d place_;
    ShapeFitOptions options_;
    const NearPoints close_;
};

}  // namespace

std::optional<NearPoints> near_faces(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options)
{
    if (!options.may_choose(ShapeKind::plane)) return {};
    NearOptions near;
    near.places = true;
    near.count = place_tuning().neighbourhood.first_points;
    near.limit = options.limit;
    near.progress = options.progress;
    return points_near(cloud, place, near);
}

std::optional<LocalFit> fit_face(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options)
{
    std::optional<NearPoints> close = near_faces(cloud, place, options);
    if (!close) return {};
    return FaceSearch(place, options, std::move(*close)).run();
}

}  // namespace pcm
