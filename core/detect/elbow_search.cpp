#include "pcm/detect/elbow_search.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/tuning.h"
#include "pcm/piping/pipe_joints.h"
#include "pcm/piping/pipe_run.h"
#include "pcm/piping/tuning.h"
#include "pcm/place/fit_at.h"
#include "pcm/place/near_points.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

using piping::AxesMeeting;
using piping::EndIndex;

constexpr std::size_t most_points = 20000;  // points around a corner that the bend's radius is estimated from
constexpr std::size_t tangent_steps = 40;   // tangents that are tried

// A detected cylinder as a part of a pipe.
struct Pipe {
    std::size_t primitive = 0;  // index in the list
    Tube tube;
};

// Two ends whose axes meet.
struct Corner {
    EndIndex a = 0, b = 0;
    AxesMeeting meeting;
};

// Arc of a tube that touches two lines from `at`.
struct BendFrame {
    Vec3d at{}, inwards{}, axis{};
    double turn = 0;
};

BendFrame frame_of(const TubeEnd& a, const TubeEnd& b, const AxesMeeting& meeting)
{
    BendFrame frame;
    frame.at = 0.5 * ((a.place + meeting.to_a * a.out) + (b.place + meeting.to_b * b.out));
    frame.inwards = normalised(-1 * (a.out + b.out));
    frame.axis = normalised(cross(a.out, -1 * b.out));
    frame.turn = meeting.turn;
    return frame;
}

// Points near a corner, and which of them are on the middle half of an arc that touches both lines `tangent` away from
// it. All such arcs have one plane and one line of symmetry.
class BendPoints {
public:
    BendPoints(const BendFrame& frame, const std::vector<Vec3d>& points, double tube, double threshold)
        : half_(std::tan(frame.turn / 2)),
          secant_(1 / std::cos(frame.turn / 2)),
          least_cosine_(std::cos(frame.turn / 4)),
          tube_(tube),
          threshold_(threshold)
    {
        const Vec3d across = cross(frame.axis, frame.inwards);
        for (const Vec3d& p : points) {
            const Vec3d d = p - frame.at;
            const double height = dot(d, frame.axis);
            if (std::fabs(height) <= tube + threshold)
                points_.push_back({p, -dot(d, frame.inwards), dot(d, across), height});
        }
    }

    std::size_t count(double tangent) const
    {
        const auto is_there = [&](const Placed& p) { return is_on(p, tangent / half_); };
        return static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(), is_there));
    }
    std::vector<Vec3d> on_arc(double tangent) const
    {
        std::vector<Vec3d> found;
        for (const Placed& p : points_)
            if (is_on(p, tangent / half_)) found.push_back(p.position);
        return found;
    }

private:
    struct Placed {
        Vec3d position{};
        double outwards = 0, across = 0, height = 0;  // from the corner
    };
    bool is_on(const Placed& p, double bend) const
    {
        const double out = p.outwards + bend * secant_;  // from the arc's centre
        const double away = std::sqrt(out * out + p.across * p.across);
        if (!(out > least_cosine_ * away)) return false;
        const double from_circle = away - bend;
        return std::fabs(std::sqrt(from_circle * from_circle + p.height * p.height) - tube_) <= threshold_;
    }

    double half_, secant_, least_cosine_, tube_, threshold_;
    std::vector<Placed> points_;
};

class ElbowSearch {
public:
    ElbowSearch(const PointCloud& cloud, std::vector<Primitive>& primitives, const ElbowOptions& options)
        : cloud_(cloud), primitives_(primitives), options_(options), tuned_(piping_tuning())
    {
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const Primitive& p = primitives[i];
            const auto tube = traits_of(p.fit.shape.kind).tube(p.fit.shape, p.bounds, p.fit.errors);
            if (tube && tube->is_straight()) pipes_.push_back({i, *tube});
        }
    }

    std::vector<Primitive> run()
    {
        Watch watch(options_.progress);
        const std::vector<Corner> corners = corners_by_distance();
        std::vector<bool> taken(2 * pipes_.size(), false);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            watch.report("Fitting elbows", static_cast<double>(i) / static_cast<double>(corners.size()));
            const Corner& corner = corners[i];
            if (taken[corner.a] || taken[corner.b]) continue;
            if (auto elbow = elbow_at(corner)) {
                taken[corner.a] = taken[corner.b] = true;
                elbow->name = "Elbow " + std::to_string(elbows_.size() + 1);
                elbow->cloud = primitives_[pipes_[corner.a / 2].primitive].cloud;
                elbow->colour = primitives_[pipes_[corner.a / 2].primitive].colour;
                elbows_.push_back(std::move(*elbow));
            }
        }
        return std::move(elbows_);
    }

private:
    const Tube& tube_of(EndIndex end) const { return pipes_[end / 2].tube; }
    const TubeEnd& end_of(EndIndex end) const { return tube_of(end).ends[end % 2]; }
    double radius_of(const Corner& corner) const { return (tube_of(corner.a).radius + tube_of(corner.b).radius) / 2; }

    std::optional<Corner> corner_of(EndIndex i, EndIndex j) const
    {
        const Tube &a = tube_of(i), &b = tube_of(j);
        const double radius = (a.radius + b.radius) / 2;
        if (std::fabs(a.radius - b.radius) > tuned_.joints.max_radius_share * radius) return {};
        Corner corner{i, j, {}};
        const double sine = length(cross(end_of(i).out, end_of(j).out));
        if (sine < std::sin(tuned_.corners.min_turn)) return {};
        corner.meeting = piping::axes_meeting(end_of(i), end_of(j));
        const AxesMeeting& found = corner.meeting;
        if (found.turn < tuned_.corners.min_turn || found.turn > tuned_.corners.max_turn) return {};
        if (found.apart > tuned_.joints.max_offset * radius) return {};
        const double reach = tuned_.joints.max_gap * radius;
        if (std::max(found.to_a, found.to_b) > reach || std::min(found.to_a, found.to_b) < -radius) return {};
        return corner;
    }

    std::vector<Corner> corners_by_distance() const
    {
        std::vector<Corner> corners;
        for (EndIndex i = 0; i < 2 * pipes_.size(); ++i)
            for (EndIndex j = (i / 2 + 1) * 2; j < 2 * pipes_.size(); ++j)
                if (const auto corner = corner_of(i, j)) corners.push_back(*corner);
        std::stable_sort(corners.begin(), corners.end(), [](const Corner& one, const Corner& other) {
            return one.meeting.to_a + one.meeting.to_b < other.meeting.to_a + other.meeting.to_b;
        });
        return corners;
    }

    std::vector<Vec3d> points_around(const BendFrame& frame, double radius) const
    {
        NearOptions near;
        near.radius = radius;
        near.most = most_points;
        near.limit = options_.limit;
        return points_near(cloud_, frame.at, near).points.sources();
    }

    // The tangent, between what both ends leave open and what cylinders can have of a bend, with most points.
    std::vector<Vec3d> arc_points(const Corner& corner, const BendFrame& frame, double threshold) const
    {
        const double radius = radius_of(corner), half = std::tan(frame.turn / 2);
        const double nearest = std::min(corner.meeting.to_a, corner.meeting.to_b);
        const double least = std::max(nearest - radius, tuned_.corners.min_bend * radius * half);
        const double most = std::max(nearest + detect_tuning().elbows.max_reach * radius, least);
        const BendPoints points(frame, points_around(frame, most + 2 * radius), radius, threshold);
        double best = least;
        std::size_t most_on = 0;
        for (std::size_t i = 0; i <= tangent_steps; ++i) {
            const double tangent = least + (most - least) * static_cast<double>(i) / static_cast<double>(tangent_steps);
            const std::size_t count = points.count(tangent);
            if (count > most_on) best = tangent;
            most_on = std::max(most_on, count);
        }
        return points.on_arc(best);
    }

    // Fits from points of the arc's middle on different sides of the tube, until a good one joins both pipes. Where
    // none does, one of too few points may; what points leave together, or lie next to, is something else between two
    // pipes.
    std::optional<Primitive> elbow_at(const Corner& corner)
    {
        const BendFrame frame = frame_of(end_of(corner.a), end_of(corner.b), corner.meeting);
        const double radius = radius_of(corner);
        double threshold = detect_tuning().elbows.threshold * radius;
        for (const EndIndex end : {corner.a, corner.b})
            threshold = std::max(threshold, primitives_[pipes_[end / 2].primitive].fit.threshold);
        const std::vector<Vec3d> arc = arc_points(corner, frame, threshold);
        if (arc.size() < static_cast<std::size_t>(detect_tuning().elbows.min_points)) return {};
        std::optional<Elbow> doubtful;
        for (const Vec3d& side : {-1 * frame.inwards, frame.axis, -1 * frame.axis}) {
            const auto by_side = [&](const Vec3d& p, const Vec3d& q) { return dot(p - q, side) < 0; };
            Primitive fitted = fitted_at(*std::max_element(arc.begin(), arc.end(), by_side), radius);
            const bool is_good = fitted.fit.verdict == FitVerdict::good;
            auto elbow = fitted.fit.has_shape() ? joined(corner, std::move(fitted)) : std::nullopt;
            if (elbow && is_good) return cut(corner, std::move(*elbow));
            if (is_good) break;  // the others are the same
            if (elbow && !doubtful && elbow->primitive.fit.issue == FitIssue::thin_arc) doubtful = std::move(elbow);
        }
        if (!doubtful) return {};
        return cut(corner, std::move(*doubtful));
    }

    Primitive fitted_at(const Vec3d& place, double radius) const
    {
        FitAtOptions fit;
        fit.fit.kind = ShapeKind::torus;
        fit.fit.least_radius = (1 - 2 * tuned_.joints.max_radius_share) * radius;
        fit.fit.largest_radius = (1 + 2 * tuned_.joints.max_radius_share) * radius;
        fit.registration = options_.registration;
        fit.limit = options_.limit;
        fit.threads = options_.threads;
        fit.memory_bytes = options_.memory_bytes;
        fit.progress = options_.progress;
        return fit_at(cloud_, {place}, {}, fit).primitive;
    }

    Primitive& primitive_of(EndIndex end) { return primitives_[pipes_[end / 2].primitive]; }

    // An elbow and its part of the centre line.
    struct Elbow {
        Primitive primitive;
        CentrePiece bend;
    };

    // Nothing where the three are not one run.
    std::optional<Elbow> joined(const Corner& corner, Primitive elbow)
    {
        const std::vector<Primitive> three{primitive_of(corner.a), primitive_of(corner.b), elbow};
        const std::vector<PipeRun> runs = pipe_runs(three);
        if (runs.size() != 1 || runs[0].parts.size() != 3) return {};
        const auto bend = std::find_if(runs[0].line.begin(), runs[0].line.end(),
                                       [](const CentrePiece& piece) { return piece.is_bend(); });
        return Elbow{std::move(elbow), *bend};
    }

    // So that none of the three has points of another one.
    Primitive cut(const Corner& corner, Elbow elbow)
    {
        cut_pipe(corner.a, elbow.primitive.fit.shape.point, primitive_of(corner.a));
        cut_pipe(corner.b, elbow.primitive.fit.shape.point, primitive_of(corner.b));
        cut_elbow(elbow.bend, elbow.primitive);
        return std::move(elbow.primitive);
    }

    // An arc begins where its centre is nearest to the axis.
    static void cut_pipe(EndIndex end, const Vec3d& centre, Primitive& pipe)
    {
        const double begin = dot(centre - pipe.fit.shape.point, pipe.fit.shape.axis);
        ShapeBounds& bounds = pipe.bounds;
        if (!(begin > bounds.from && begin < bounds.to)) return;
        (end % 2 == 0 ? bounds.from : bounds.to) = begin;
    }

    // To the arc of the centre line, of which points may not show the ends.
    static void cut_elbow(const CentrePiece& bend, Primitive& elbow)
    {
        const Shape& shape = elbow.fit.shape;
        ShapeBounds& bounds = elbow.bounds;
        const bool reversed = dot(bend.axis, shape.axis) < 0;
        const Vec3d d = (reversed ? bend.to : bend.from) - shape.point;
        const Vec3d first = normalised(d - dot(d, shape.axis) * shape.axis);
        const double turn = std::atan2(dot(cross(bounds.zero, first), shape.axis), dot(bounds.zero, first));
        // The arc of the points from `first` on, its middle less than half a circle away from that of the bend.
        const double middle = (bounds.begin + bounds.end) / 2 - turn - bend.angle / 2;
        const double shift = bend.angle / 2 + std::remainder(middle, 2 * pi), half = (bounds.end - bounds.begin) / 2;
        const double begin = std::max(0.0, shift - half), end = std::min(bend.angle, shift + half);
        bounds.zero = first;
        bounds.begin = begin;
        bounds.end = end;
    }

    const PointCloud& cloud_;
    std::vector<Primitive>& primitives_;
    const ElbowOptions& options_;
    const PipingTuning& tuned_;
    std::vector<Pipe> pipes_;
    std::vector<Primitive> elbows_;
};

}  // namespace

std::vector<Primitive> find_elbows(const PointCloud& cloud, std::vector<Primitive>& primitives,
                                   const ElbowOptions& options)
{
    return ElbowSearch(cloud, primitives, options).run();
}

}  // namespace pcm
