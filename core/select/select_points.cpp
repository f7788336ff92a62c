#include "pcm/select/select_points.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/vector.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace pcm {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;  // error of one rounding

PointSet scan_into_set(const std::shared_ptr<const Tree>& tree, const Selection& selection, const PlaceTest* test,
                       const SelectOptions& select)
{
    PointSet set(tree);
    std::mutex mutex;
    ScanOptions options;
    options.test = test;
    options.select = select;
    scan_points(*tree, selection, options, [&](const ScannedPoints& found) {
        const std::lock_guard lock(mutex);
        set.set(found.node, found.numbers);
    });
    return set;
}

// The squared distance of a point from a segment; d is relative to its begin, `along` leads to its end.
double squared_from_segment(const Vec3d& d, const Vec3d& along, double squared_length)
{
    const double t = squared_length > 0 ? std::clamp(dot(along, d) / squared_length, 0.0, 1.0) : 0.0;
    const Vec3d w = d - t * along;
    return dot(w, w);
}

// Within a radius of a line of segments.
class StrokeTest final : public PlaceTest {
public:
    StrokeTest(const std::vector<Vec3d>& stroke, double radius) : squared_radius_(radius * radius), radius_(radius)
    {
        for (std::size_t i = 0; i + 1 < stroke.size() || i == 0; ++i) {
            const Vec3d& to = stroke[std::min(i + 1, stroke.size() - 1)];
            Segment segment{stroke[i], to - stroke[i], 0};
            segment.squared_length = dot(segment.along, segment.along);
            if (i % run_length == 0) runs_.push_back({{}, i});
            runs_.back().box.extend(stroke[i]);
            runs_.back().box.extend(to);
            segments_.push_back(segment);
        }
        for (Run& run : runs_)
            for (std::size_t a = 0; a < 3; ++a) {
                const double slack =
                    radius + 1e-12 * (radius + std::max(std::fabs(run.box.min[a]), std::fabs(run.box.max[a])));
                run.box.min[a] -= slack;
                run.box.max[a] += slack;
                bounds_.extend(run.box);
            }
    }

    bool holds(const Vec3d& p) const override
    {
        for (const Run& run : runs_) {
            if (!run.box.contains(p)) continue;
            for (std::size_t i = run.first; i < std::min(run.first + run_length, segments_.size()); ++i)
                if (squared_from_segment(p - segments_[i].begin, segments_[i].along, segments_[i].squared_length) <=
                    squared_radius_)
                    return true;
        }
        return false;
    }

    // A capsule is convex, so a box with all corners in one is inside. Outside: the ball around the box is.
    BoxRelation relation(const Box3d& box) const override
    {
        if (box.empty() || !bounds_.intersects(box)) return BoxRelation::outside;
        const Vec3d centre = box.centre();
        const double half = box.diagonal() / 2;
        BoxRelation relation = BoxRelation::outside;
        for (const Run& run : runs_) {
            if (!run.box.intersects(box)) continue;
            for (std::size_t i = run.first; i < std::min(run.first + run_length, segments_.size()); ++i) {
                const Segment& segment = segments_[i];
                const double margin =
                    64 * epsilon *
                    (length(centre - segment.begin) + half + std::sqrt(segment.squared_length) + radius_);
                const double from =
                    std::sqrt(squared_from_segment(centre - segment.begin, segment.along, segment.squared_length));
                if (from > half + radius_ + margin) continue;
                relation = BoxRelation::crosses;
                if (corners_within(box, segment, radius_ - margin)) return BoxRelation::inside;
            }
        }
        return relation;
    }

private:
    struct Segment {
        Vec3d begin, along;
        double squared_length;
    };
    struct Run {
        Box3d box;  // grown by the radius
        std::size_t first;
    };
    static constexpr std::size_t run_length = 16;

    static bool corners_within(const Box3d& box, const Segment& segment, double radius)
    {
        if (!(radius > 0)) return false;
        for (std::size_t i = 0; i < 8; ++i) {
            const Vec3d corner{i & 1 ? box.max[0] : box.min[0], i & 2 ? box.max[1] : box.min[1],
                               i & 4 ? box.max[2] : box.min[2]};
            if (squared_from_segment(corner - segment.begin, segment.along, segment.squared_length) > radius * radius)
                return false;
        }
        return true;
    }

    std::vector<Segment> segments_;
    std::vector<Run> runs_;
    Box3d bounds_;
    double squared_radius_, radius_;
};

}  // namespace

PointSet select_points(const std::shared_ptr<const Tree>& tree, const Selection& selection,
                       const SelectOptions& options)
{
    return scan_into_set(tree, selection, nullptr, options);
}

PointSet brush_points(const std::shared_ptr<const Tree>& tree, const std::vector<Vec3d>& stroke, double radius,
                      const Selection& limit, const SelectOptions& options)
{
    if (stroke.empty())
        throw Error(ErrorCode::invalid_argument, {}, "the stroke of the brush has no points", "give one or more");
    for (const Vec3d& p : stroke) require_place("the brush's place", p);
    if (!(radius >= 0) || !std::isfinite(radius))
        throw Error(ErrorCode::invalid_argument, {},
                    "the radius of the brush is " + exact(radius) + "; it is 0 or more, and finite");
    const StrokeTest test(stroke, radius);
    return scan_into_set(tree, limit, &test, options);
}

}  // namespace pcm
