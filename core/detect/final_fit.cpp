#include "pcm/detect/final_fit.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/candidate_sums.h"
#include "pcm/detect/face_interior.h"
#include "pcm/detect/node_sums.h"
#include "pcm/detect/other_kind.h"
#include "pcm/detect/refined_shape.h"
#include "pcm/detect/sagitta.h"
#include "pcm/detect/tuning.h"
#include "pcm/place/departure.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/refit.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/flat_hull.h"
#include "pcm/shapes/primitive_list.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::uint32_t no_candidate = 0xffffffffu;
// Points of a candidate that its doubts come from; of very many candidates fewer, so that they take 64 MB.
constexpr std::size_t most_drawn = 500, least_drawn = 100, all_drawn = std::size_t(2) << 20;

// Keyed by candidate.
using GroupSums = std::map<std::uint32_t, CandidateSums>;

class Fitting {
public:
    Fitting(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses, const AssignedPoints& assigned,
            PointLabels& labels, const FinalFitOptions& options)
        : points_(points), assigned_(assigned), labels_(labels), options_(options)
    {
        for (std::uint32_t p = 0; p < assigned.parts.size(); ++p) {
            const SurfacePart& part = assigned.parts[p];
            if (part.points < options.least_points) continue;
            const Hypothesis& from = hypotheses[part.hypothesis];
            const bool piece = !from.whole && is_piece(part, from.threshold) && !is_kept(part, from);
            result_.pieces += piece;
            if (piece) result_.piece_points += part.points;
            if (!piece || options.keep_pieces) add(p, hypotheses);
        }
        candidate_of_.assign(assigned.parts.size(), no_candidate);
        for (std::uint32_t c = 0; c < candidates_.size(); ++c) candidate_of_[candidates_[c].part] = c;
    }

    FinalFit run()
    {
        const std::size_t lists = candidates_.size() * (options_.shifts.are_known() ? 2 : 1);
        const std::size_t drawn = std::clamp(all_drawn / std::max<std::size_t>(lists, 1), least_drawn, most_drawn);
        find_faces(improve(0, 0.25, drawn));
        improve(0.25, 0.5, 0);
        const std::vector<CandidateSums> sums = pass(0.5, 0.8, 0, drawn);
        std::vector<std::uint32_t> order(candidates_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return sums[a].all.points() > sums[b].all.points(); });
        std::vector<std::uint32_t> label_of(candidates_.size(), 0);
        for (const std::uint32_t c : order) {
            if (sums[c].all.points() < options_.least_points) continue;
            const double alike = sums[c].facts->alike.factor();
            Primitive primitive = primitive_of(candidates_[c], sums[c], alike);
            if (!primitive.fit.has_shape() || (options_.is_automatic && is_hidden(primitive, sums[c]))) continue;
            if (options_.is_automatic && is_of_other_kind(primitive.fit, candidates_[c], *sums[c].facts)) {
                ++result_.other_kinds;
                result_.other_points += primitive.points;
                continue;
            }
            if (options_.only_good && !candidates_[c].thin && primitive.fit.verdict != FitVerdict::good) continue;
            primitive.colour = colour_in_turn(result_.primitives.size());
            label_of[c] = primitive.label = static_cast<std::uint32_t>(result_.primitives.size() + 1);
            primitive.name = std::string(traits_of(primitive.fit.shape.kind).label) + " " +
                             std::to_string(++numbers_[primitive.fit.shape.kind]);
            result_.contested.push_back(is_contested(primitive, candidates_[c], sums[c]));
            result_.agreement.push_back(alike);
            result_.primitives.push_back(std::move(primitive));
        }
        relabel(label_of);
        return std::move(result_);
    }

private:
    // Area of a plane's part by its box's diagonal, source units.
    double mean_width(const SurfacePart& part) const
    {
        return static_cast<double>(part.sampled) * options_.cell * options_.cell / part.box.diagonal();
    }

    bool is_contested(const Primitive& primitive, const FitCandidate& candidate, const CandidateSums& sums) const
    {
        const ContestTuning& tuned = detect_tuning().contest;
        const ShapeFit& fit = primitive.fit;
        return traits_of(fit.shape.kind).is_flat() && !candidate.whole &&
               mean_width(assigned_.parts[candidate.part]) <= tuned.max_width * fit.threshold &&
               (fit.issue == FitIssue::other_surface || sums.drawn_noise(fit) > tuned.min_noise * options_.noise);
    }

    // Whether a piece is a doubtful primitive in any case: a floor, a ceiling, a wall, or round far beyond the
    // threshold.
    bool is_kept(const SurfacePart& part, const Hypothesis& from) const
    {
        const PieceTuning& tuned = detect_tuning().pieces;
        if (traits_of(from.shape.kind).is_flat()) return is_wide(part, from.threshold);
        Vec3d sides = part.box.max - part.box.min;
        std::sort(sides.begin(), sides.end());
        const double turn = 2 * std::asin(std::min(1.0, 0.5 * sides[1] / from.shape.radius));
        return sagitta_of(from.shape, turn) > tuned.kept_sagitta * from.threshold;
    }

    // Whether a plane's part is as wide as floors and walls are.
    bool is_wide(const SurfacePart& part, double threshold) const
    {
        return mean_width(part) > detect_tuning().pieces.kept_width * threshold;
    }

    void add(std::uint32_t part, const std::vector<Hypothesis>& hypotheses)
    {
        const SurfacePart& from = assigned_.parts[part];
        FitCandidate candidate;
        candidate.part = part;
        candidate.whole = hypotheses[from.hypothesis].whole;
        candidate.thin = hypotheses[from.hypothesis].thin;
        candidate.of_strip = hypotheses[from.hypothesis].of_strip;
        candidate.threshold = hypotheses[from.hypothesis].threshold;
        candidate.shape = hypotheses[from.hypothesis].shape;
        candidate.middle = from.box.centre();
        candidate.corner = from.box.min;
        candidate.extent = std::max(from.box.diagonal(), candidate.threshold);
        candidates_.push_back(candidate);
    }

    std::uint32_t candidate(std::uint32_t label) const
    {
        if (label == 0) return no_candidate;
        const std::uint32_t part = assigned_.part_of(label & ~interior_label);
        return part == AssignedPoints::no_part ? no_candidate : candidate_of_[part];
    }

    // A step of least squares.
    std::vector<CandidateSums> improve(double begin, double end, std::size_t of_outline)
    {
        std::vector<CandidateSums> sums = pass(begin, end, of_outline, 0);
        for (std::size_t c = 0; c < candidates_.size(); ++c) {
            candidates_[c].fitted_to = sums[c].fitted_to = sums[c].chosen(candidates_[c].threshold);
            if (const auto better = sums[c].best().step()) candidates_[c].shape = *better;
        }
        return sums;
    }

    void find_faces(const std::vector<CandidateSums>& sums)
    {
        std::vector<MeetingSurface> surfaces;
        for (std::size_t c = 0; c < candidates_.size(); ++c) {
            const FitCandidate& one = candidates_[c];
            MeetingSurface surface{one.shape, assigned_.parts[one.part].box, one.threshold, {}};
            if (sums[c].outline) surface.outline.emplace(sums[c].outline->points(), one.shape);
            surfaces.push_back(std::move(surface));
        }
        faces_.emplace(std::move(surfaces));
    }

    std::vector<CandidateSums> pass(double begin, double end, std::size_t of_outline, std::size_t of_facts)
    {
        std::vector<CandidateSums> sums;
        for (const FitCandidate& c : candidates_) sums.emplace_back(c, of_outline, of_facts);
        sum_over_nodes<GroupSums>(
            points_.tree(), options_.threads,
            [&](GroupSums& part, NodeId node) { add_node(node, of_outline, of_facts, part); },
            [&](const GroupSums& part) {
                for (const auto& [c, own] : part) sums[c].add(own);
            },
            [&](double share) { options_.progress(begin + (end - begin) * share); });
        return sums;
    }

    void add_node(NodeId node, std::size_t of_outline, std::size_t of_facts, GroupSums& sums)
    {
        const std::vector<std::uint32_t> labels = labels_.get(node);
        if (std::all_of(labels.begin(), labels.end(), [](std::uint32_t l) { return l == 0; })) return;
        const std::vector<Vec3d> at = points_.positions(node);
        const std::vector<Vec3d> shifts =
            of_facts > 0 ? options_.shifts.of_points(points_.tree(), node) : std::vector<Vec3d>();
        const Box3d box = points_.tree().box(node);
        std::map<std::uint32_t, std::optional<FaceInteriors::InBox>> faces;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            const std::uint32_t c = candidate(labels[i]);
            if (c == no_candidate || distance_to(candidates_[c].shape, at[i]) > candidates_[c].threshold) continue;
            auto found = sums.find(c);
            if (found == sums.end()) found = sums.emplace(c, CandidateSums(candidates_[c], of_outline, of_facts)).first;
            auto face = faces.find(c);
            if (face == faces.end())
                face = faces.emplace(c, faces_ ? faces_->inside(c, box) : std::optional<FaceInteriors::InBox>()).first;
            const CandidatePoint seen{at[i], (static_cast<std::uint64_t>(node) << 32) + i,
                                      (labels[i] & interior_label) != 0, !face->second || face->second->has(at[i]),
                                      shifts.empty() ? nullptr : &shifts[i]};
            found->second.add(seen, candidates_[c].shape);
        }
    }

    Primitive primitive_of(const FitCandidate& candidate, const CandidateSums& sums, double alike)
    {
        Primitive primitive;
        primitive.fit = sums.best().result(candidate.threshold);
        primitive.points = sums.all.points();
        primitive.cloud = points_.tree().folder().string();
        primitive.estimator = "detect";
        const SurfacePart& part = assigned_.parts[candidate.part];
        if (!primitive.fit.has_shape()) return primitive;
        enlarge(primitive.fit.errors, alike);
        if (sums.fitted_to != FittedTo::interior) contain_inner(candidate, sums, alike, primitive.fit);
        bound(primitive, sums.facts->ends.points());
        if (primitive.fit.verdict == FitVerdict::good && !candidate.whole && is_piece(part, candidate.threshold)) {
            primitive.fit.verdict = FitVerdict::doubtful;
            primitive.fit.message =
                "the cloud's surface continues smoothly beyond the threshold: this may be a piece of something bent";
        }
        if (candidate.of_strip)
            doubt(primitive.fit, FitIssue::other_surface,
                  "it was found as the bend of a narrow strip, as the edges of posts and cones have, too: "
                  "compare it with a section");
        if (primitive.fit.verdict == FitVerdict::good && options_.is_automatic) judge(primitive.fit, part, sums);
        return primitive;
    }

    // What the points at edges have moved a shape by that has few others.
    static void contain_inner(const FitCandidate& candidate, const CandidateSums& sums, double alike, ShapeFit& fit)
    {
        if (sums.interior.points() < place_tuning().growth.min_compared) return;
        ShapeFit inner = sums.interior.result(candidate.threshold);
        enlarge(inner.errors, alike);
        const auto moved = sums.interior.step();
        if (moved) inner.shape = *moved;
        contain_edges(moved ? inner : ShapeFit(), candidate.middle, fit);
    }

    // Whether neighbours' distances agree: with the surface continuing at the edge, as those of ground do, or much, on
    // a curved shape or with more noise than the cloud has.
    bool is_bent(const ShapeFit& fit, const SurfacePart& part) const
    {
        const PieceTuning& tuned = detect_tuning().pieces;
        const bool continues =
            static_cast<double>(part.continued) > tuned.doubtful_edge * static_cast<double>(part.edge);
        const auto bends = [&](double bend) { return part.smooth_squares > bend * bend * part.squares; };
        const bool is_even = traits_of(fit.shape.kind).is_flat() && fit.noise <= options_.noise;
        return (continues && bends(tuned.doubtful_bend)) || (!is_even && bends(tuned.curved_bend));
    }

    static Shape shape_through(const std::vector<Vec3d>& points, const ShapeFit& fit)
    {
        return refined_shape(points, fit.shape, 1.5 * fit.threshold).value_or(fit.shape);
    }

    // As a fit at a place is judged, by points that were drawn. Where the stations' shifts make them far quieter, by
    // those without the shifts: stations that are apart are not surfaces.
    void judge(ShapeFit& judged, const SurfacePart& part, const CandidateSums& sums) const
    {
        ShapeFit fit = judged;
        fit.noise = sums.drawn_noise(fit);
        if (is_bent(fit, part))
            return doubt(judged, FitIssue::uneven,
                         "neighbouring points leave the shape together, more than their noise does: this may be a "
                         "piece of something bent");
        const std::vector<Vec3d> some = sums.facts->some.points(), moved = sums.facts->moved.points();
        const Doubt as_they_are = doubt_of(fit, fit.shape, some);
        if (as_they_are.reason.empty()) return;
        if (!moved.empty()) {
            const Shape shape = shape_through(moved, fit);
            const double most = detect_tuning().plates.max_moved_noise * rms_distance(fit.shape, some);
            if (rms_distance(shape, moved) <= most && doubt_of(fit, shape, moved).reason.empty()) return;
        }
        doubt(judged, as_they_are.issue, as_they_are.reason);
    }

    struct Doubt {
        FitIssue issue = FitIssue::none;
        std::string reason;  // empty: there is none
    };

    Doubt doubt_of(const ShapeFit& fit, const Shape& shape, const std::vector<Vec3d>& points) const
    {
        const double resolution = largest_magnitude(points_.tree().info().grid.scale);
        const SurfaceEvidence evidence = surface_evidence(shape, spread_of(fit), resolution, points);
        if (!evidence.is_one_surface())
            return {FitIssue::other_surface, evidence.reason() + ": detect there with a lower threshold"};
        const Departure departure = departure_of(shape, fit.threshold, points);
        if (departure.is_smooth(options_.noise)) return {FitIssue::uneven, departure.message("shape")};
        if (shape.kind != ShapeKind::sphere) return {};
        ShapeFit sphere = fit;
        sphere.shape = shape;
        if (const auto kind = other_kind(sphere, points))
            return {FitIssue::other_surface, std::string("a ") + traits_of(*kind).name +
                                                 " explains its points as well or better: fit that at one of them"};
        return {};
    }

    // Whether what bends there is within the threshold: a curved shape is flat, or a plane a line.
    static bool is_hidden(const Primitive& primitive, const CandidateSums& sums)
    {
        const ShapeSearchTuning& tuned = detect_tuning().search;
        const Shape& shape = primitive.fit.shape;
        const double threshold = primitive.fit.threshold;
        if (traits_of(shape.kind).is_flat())
            return width_of(primitive.bounds.outline) < tuned.width_thresholds * threshold;
        std::vector<Vec3d> points = sums.facts->ends.points();
        const std::vector<Vec3d> some = sums.facts->some.points();
        points.insert(points.end(), some.begin(), some.end());
        return sagitta_of(shape, turn_of(shape, points)) < tuned.sagitta_thresholds * threshold;
    }

    // Whether a doubtful shape is a piece of a cone or the like. Floors and walls that bend are kept.
    bool is_of_other_kind(const ShapeFit& fit, const FitCandidate& candidate, const CandidateFacts& facts) const
    {
        const bool is_flat = traits_of(fit.shape.kind).is_flat();
        if (fit.verdict == FitVerdict::good ||
            (is_flat && is_wide(assigned_.parts[candidate.part], candidate.threshold)))
            return false;
        const std::vector<Vec3d> moved = facts.moved.points();
        if (moved.empty()) return other_kind(fit, facts.some.points()).has_value();
        ShapeFit there = fit;
        there.shape = shape_through(moved, fit);
        return other_kind(there, moved).has_value();
    }

    // A plane whose points are on one line has no outline: no reason to end a detection.
    void bound(Primitive& primitive, const std::vector<Vec3d>& ends)
    {
        OutlineOptions outline;
        outline.kind = OutlineKind::convex;  // the ends have no other
        try {
            primitive.bounds = bounds_of(primitive.fit.shape, ends, outline);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::invalid_argument) throw;
            ++result_.unbounded;
        }
    }

    void relabel(const std::vector<std::uint32_t>& label_of)
    {
        struct Nothing {};
        sum_over_nodes<Nothing>(
            points_.tree(), options_.threads, [&](Nothing&, NodeId node) { relabel(node, label_of); },
            [](const Nothing&) {}, [&](double share) { options_.progress(0.8 + 0.2 * share); });
    }

    void relabel(NodeId node, const std::vector<std::uint32_t>& label_of)
    {
        std::vector<std::uint32_t> labels = labels_.get(node);
        if (std::all_of(labels.begin(), labels.end(), [](std::uint32_t l) { return l == 0; })) return;
        const std::vector<Vec3d> at = points_.positions(node);
        for (std::size_t i = 0; i < labels.size(); ++i) {
            const std::uint32_t c = candidate(labels[i]);
            const bool near = c != no_candidate && distance_to(candidates_[c].shape, at[i]) <= candidates_[c].threshold;
            labels[i] = near ? label_of[c] : 0;
        }
        labels_.set_all(node, labels);
    }

    const ChosenPoints& points_;
    const AssignedPoints& assigned_;
    PointLabels& labels_;
    const FinalFitOptions& options_;
    std::vector<FitCandidate> candidates_;
    std::vector<std::uint32_t> candidate_of_;  // one for each part
    std::optional<FaceInteriors> faces_;       // those of all candidates, when outlines are known
    std::map<ShapeKind, int> numbers_;
    FinalFit result_;
};

}  // namespace

FinalFit fit_parts(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses,
                   const AssignedPoints& assigned, PointLabels& labels, const FinalFitOptions& options)
{
    return Fitting(points, hypotheses, assigned, labels, options).run();
}

}  // namespace pcm
