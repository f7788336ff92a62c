#include "pcm/detect/elbow_search.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/bend_points.h"
#include "pcm/detect/elbow_pieces.h"
#include "pcm/detect/tuning.h"
#include "pcm/piping/pipe_joints.h"
#include "pcm/piping/pipe_run.h"
#include "pcm/piping/tuning.h"
#include "pcm/place/bent_tube.h"
#include "pcm/place/fit_at.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/near_bend.h"
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

class ElbowSearch {
public:
    ElbowSearch(const PointCloud& cloud, std::vector<Primitive>& primitives, const ElbowOptions& options)
        : cloud_(cloud),
          primitives_(primitives),
          options_(options),
          tuned_(piping_tuning()),
          pieces_(cloud, primitives, options.limit)
    {
        found_.is_piece.assign(primitives.size(), false);
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const Primitive& p = primitives[i];
            const auto tube = traits_of(p.fit.shape.kind).tube(p.fit.shape, p.bounds, p.fit.errors);
            if (tube && tube->is_straight()) pipes_.push_back({i, *tube});
        }
    }

    // Pipes that may be pieces of elbows are joined after the others.
    ElbowReport run()
    {
        Watch watch(options_.progress);
        std::vector<Corner> corners = corners_by_distance();
        std::stable_partition(corners.begin(), corners.end(),
                              [&](const Corner& c) { return is_sure(c.a) && is_sure(c.b); });
        taken_.assign(2 * pipes_.size(), false);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            watch.report("Fitting elbows", 0.7 * static_cast<double>(i) / static_cast<double>(corners.size()));
            const Corner& corner = corners[i];
            if (is_done(corner.a) || is_done(corner.b)) continue;
            if (auto elbow = elbow_at(corner)) add(std::move(*elbow));
        }
        for (EndIndex end = 0; end < taken_.size(); ++end) {
            watch.report("Fitting elbows", 0.7 + 0.3 * static_cast<double>(end) / static_cast<double>(taken_.size()));
            if (is_done(end) || !is_sure(end)) continue;
            if (auto elbow = elbow_behind(end)) add(std::move(*elbow));
        }
        return std::move(found_);
    }

private:
    struct Elbow {
        Primitive primitive;
        double agreement = 1;
        std::vector<EndIndex> ends;       // ends of the pipes that it joins
        std::optional<CentrePiece> bend;  // its part of the centre line; nothing where it joins no pipe
        std::optional<SweptPart> part;    // as FittedPrimitive::part
    };

    void add(Elbow elbow)
    {
        for (const EndIndex end : elbow.ends) taken_[end] = true;
        elbow.primitive.name = "Elbow " + std::to_string(found_.elbows.size() + 1);
        elbow.primitive.cloud = primitives_.front().cloud;
        found_.elbows.push_back(std::move(elbow.primitive));
        found_.agreement.push_back(elbow.agreement);
    }

    const Tube& tube_of(EndIndex end) const { return pipes_[end / 2].tube; }
    const TubeEnd& end_of(EndIndex end) const { return tube_of(end).ends[end % 2]; }
    // Whether it is joined, or no pipe's.
    bool is_done(EndIndex end) const { return taken_[end] || found_.is_piece[pipes_[end / 2].primitive]; }
    bool is_sure(EndIndex end) const
    {
        const std::size_t index = pipes_[end / 2].primitive;
        return primitives_[index].fit.verdict == FitVerdict::good || !pieces_.may_be(index);
    }
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

    std::vector<Vec3d> points_around(const Vec3d& place, double radius) const
    {
        NearOptions near;
        near.radius = radius;
        near.most = most_points;
        near.limit = options_.limit;
        return points_near(cloud_, place, near).points.sources();
    }

    // The tangent, between what both ends leave open and what cylinders can have of a bend, with most points.
    std::vector<Vec3d> arc_points(const Corner& corner, const BendFrame& frame, double threshold) const
    {
        const double radius = radius_of(corner), half = std::tan(frame.turn / 2);
        const double nearest = std::min(corner.meeting.to_a, corner.meeting.to_b);
        const double least = std::max(nearest - radius, tuned_.corners.min_bend * radius * half);
        const double most = std::max(nearest + detect_tuning().elbows.max_reach * radius, least);
        const BendPoints points(frame, points_around(frame.at, most + 2 * radius), radius, threshold);
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
    std::optional<Elbow> elbow_at(const Corner& corner)
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
            FittedPrimitive fitted = fitted_at(*std::max_element(arc.begin(), arc.end(), by_side), radius);
            const bool is_good = fitted.primitive.fit.verdict == FitVerdict::good;
            if (!fitted.primitive.fit.has_shape()) continue;
            auto elbow = is_good ? between_pipes(corner, std::move(fitted)) : between(corner, std::move(fitted));
            if (elbow && is_good) return accepted(std::move(*elbow));
            if (is_good) break;  // the others are the same
            if (elbow && !doubtful && elbow->primitive.fit.issue == FitIssue::thin_arc) doubtful = std::move(elbow);
        }
        if (!doubtful) return {};
        return accepted(std::move(*doubtful));
    }

    // The pipe behind it may have too few points, or be hidden.
    std::optional<Elbow> elbow_behind(EndIndex end)
    {
        const ShapeFit& pipe = primitive_of(end).fit;
        if (!(pipe.noise > 0)) return {};
        const PipeAtPlace at{pipe.shape, pipe.threshold, pipe.noise, end_of(end).place};
        const double reach = around_thresholds * pipe.threshold;
        std::vector<Vec3d> around;
        for (const Vec3d& p : points_around(at.place, reach_of_bends(at) + pipe.shape.radius))
            if (distance_to(pipe.shape, p) <= reach) around.push_back(p);
        const auto bend = bend_near(at, around);
        if (!bend || dot(bend->direction, end_of(end).out) < 0) return {};
        const double radii = bend->radius / pipe.shape.radius;
        if (!(radii >= detect_tuning().elbows.min_bend && radii <= detect_tuning().elbows.max_bend)) return {};
        const auto place = place_on(*bend, at.place, around);
        if (!place || is_found(*place)) return {};
        FittedPrimitive fitted = fitted_at(*place, pipe.shape.radius);
        if (fitted.primitive.fit.verdict != FitVerdict::good) return {};
        Elbow elbow{std::move(fitted.primitive), fitted.agreement, {}, {}, fitted.part};
        add_end(end, elbow);
        if (elbow.ends.empty()) return {};
        add_other_ends(elbow);
        return accepted(std::move(elbow));
    }

    // Whether it lies on an elbow already, that of another part of the same pipe.
    bool is_found(const Vec3d& place) const
    {
        return std::any_of(found_.elbows.begin(), found_.elbows.end(), [&](const Primitive& elbow) {
            return distance_to(elbow.fit.shape, place) <= elbow.fit.threshold;
        });
    }

    FittedPrimitive fitted_at(const Vec3d& place, double radius) const
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
        return fit_at(cloud_, {place}, {}, fit);
    }

    Primitive& primitive_of(EndIndex end) { return primitives_[pipes_[end / 2].primitive]; }

    // The elbow's part of the centre line; nothing where the pipes and the elbow are not one run.
    std::optional<CentrePiece> bend_of(const std::vector<EndIndex>& ends, const Primitive& elbow)
    {
        std::vector<Primitive> parts{elbow};
        for (const EndIndex end : ends) parts.push_back(primitive_of(end));
        const std::vector<PipeRun> runs = pipe_runs(parts);
        if (runs.size() != 1 || runs[0].parts.size() != parts.size()) return {};
        return *std::find_if(runs[0].line.begin(), runs[0].line.end(),
                             [](const CentrePiece& piece) { return piece.is_bend(); });
    }

    std::optional<Elbow> between(const Corner& corner, FittedPrimitive fitted)
    {
        Elbow elbow{std::move(fitted.primitive), fitted.agreement, {corner.a, corner.b}, {}, {}};
        elbow.bend = bend_of(elbow.ends, elbow.primitive);
        if (!elbow.bend) return {};
        return elbow;
    }

    // In place of pieces of the elbow other pipes, where there are some.
    std::optional<Elbow> between_pipes(const Corner& corner, FittedPrimitive fitted)
    {
        if (!is_piece_of(corner.a, fitted.primitive) && !is_piece_of(corner.b, fitted.primitive))
            return between(corner, std::move(fitted));
        Elbow elbow{std::move(fitted.primitive), fitted.agreement, {}, {}, fitted.part};
        for (const EndIndex end : {corner.a, corner.b})
            if (!is_piece_of(end, elbow.primitive)) elbow.ends.push_back(end);
        if (!elbow.ends.empty() && !(elbow.bend = bend_of(elbow.ends, elbow.primitive))) return {};
        add_other_ends(elbow);
        return elbow;
    }

    void add_other_ends(Elbow& elbow)
    {
        for (EndIndex end = 0; end < taken_.size() && elbow.ends.size() < 2; ++end)
            if (may_join(end, elbow)) add_end(end, elbow);
    }

    bool is_piece_of(EndIndex end, const Primitive& elbow) { return pieces_.is_of(pipes_[end / 2].primitive, elbow); }

    bool may_join(EndIndex end, const Elbow& elbow)
    {
        const Shape& torus = elbow.primitive.fit.shape;
        const auto is_same_pipe = [&](EndIndex other) { return other / 2 == end / 2; };
        return !is_done(end) && std::none_of(elbow.ends.begin(), elbow.ends.end(), is_same_pipe) &&
               length(end_of(end).place - torus.point) <= torus.radius + tuned_.joints.max_gap * torus.second &&
               !is_piece_of(end, elbow.primitive);
    }

    void add_end(EndIndex end, Elbow& elbow)
    {
        std::vector<EndIndex> ends = elbow.ends;
        ends.push_back(end);
        const auto bend = bend_of(ends, elbow.primitive);
        if (!bend) return;
        elbow.ends = std::move(ends);
        elbow.bend = bend;
    }

    // Cut so that neither it nor the pipes have points of another one.
    Elbow accepted(Elbow elbow)
    {
        for (std::size_t i = 0; i < primitives_.size(); ++i)
            if (!found_.is_piece[i]) found_.is_piece[i] = pieces_.is_of(i, elbow.primitive);
        for (const EndIndex end : elbow.ends) cut_pipe(end, elbow.primitive.fit.shape.point, primitive_of(end));
        if (elbow.bend) cut_elbow(*elbow.bend, elbow.primitive);
        if (elbow.part && elbow.ends.size() < 2) cut_free_ends(elbow);
        return elbow;
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

    // Where no pipe of the list continues it, to what is bent of the points: those of the pipe there lie on the torus,
    // too, for a while.
    void cut_free_ends(Elbow& elbow)
    {
        const Shape& shape = elbow.primitive.fit.shape;
        ShapeBounds& bounds = elbow.primitive.bounds;
        const double middle = (bounds.begin + bounds.end) / 2, half = (bounds.end - bounds.begin) / 2;
        const auto from_middle = [&](const Vec3d& p) {
            return std::remainder(angle_about(shape, bounds.zero, p) - middle, 2 * pi);
        };
        const Vec3d u = normalised(elbow.part->start - dot(elbow.part->start, shape.axis) * shape.axis);
        const auto place = [&](double angle) {
            return shape.point + std::cos(angle) * u + std::sin(angle) * cross(shape.axis, u);
        };
        const double pipe = elbow.ends.empty() ? 0 : from_middle(end_of(elbow.ends.front()).place);
        const double last = pipe > 0 ? half : std::min(half, from_middle(place(elbow.part->to)));
        const double first = pipe < 0 ? -half : std::max(-half, from_middle(place(elbow.part->from)));
        if (!(last > first)) return;
        bounds.begin = std::max(0.0, middle + first);
        bounds.end = middle + last;
        if (bounds.begin >= 2 * pi) bounds.begin -= 2 * pi, bounds.end -= 2 * pi;
    }

    const PointCloud& cloud_;
    std::vector<Primitive>& primitives_;
    const ElbowOptions& options_;
    const PipingTuning& tuned_;
    std::vector<Pipe> pipes_;
    std::vector<bool> taken_;  // keyed by end
    ElbowPieces pieces_;
    ElbowReport found_;
};

}  // namespace

ElbowReport find_elbows(const PointCloud& cloud, std::vector<Primitive>& primitives, const ElbowOptions& options)
{
    return ElbowSearch(cloud, primitives, options).run();
}

}  // namespace pcm
