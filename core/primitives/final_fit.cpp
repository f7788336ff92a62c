#include "pcm/primitives/final_fit.h"

#include "pcm/fit/shape_sums.h"
#include "pcm/threads/for_each_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr std::size_t groups = 64;       // of nodes, whose sums are added in their order
constexpr double piece_edge = 0.2;       // share of the edge where the surface of a piece continues
constexpr double piece_bend = 0.4;       // of the distances, what is left of them in a mean of 17; noise leaves 0.24
constexpr double piece_outline = 1.5;    // of so many times the square root of its points, a part of its outline
constexpr double enough_interior = 0.2;  // of a part's points: else those at edges are used too

struct Candidate {
    Shape shape;
    Vec3d middle{};
    double extent = 0;
    std::uint64_t points = 0;
    std::uint32_t part = 0;
};

struct Sums {
    explicit Sums(const Candidate& c) : interior(c.shape, c.middle, c.extent), all(c.shape, c.middle, c.extent) {}
    ShapeSums interior, all;
    const ShapeSums& best() const
    {
        const bool enough =
            static_cast<double>(interior.points()) >= enough_interior * static_cast<double>(all.points());
        return enough && interior.points() >= 20 ? interior : all;
    }
};

// Whether the part is a piece of a surface that bends away from the shape: its edge is often where the surface
// continues.
bool is_piece(const SurfacePart& part)
{
    const auto continued = static_cast<double>(part.continued);
    return continued > piece_edge * static_cast<double>(part.edge) &&
           part.smooth_squares > piece_bend * piece_bend * part.squares &&
           continued > piece_outline * std::sqrt(static_cast<double>(part.sampled));
}

// By candidate.
using GroupSums = std::map<std::uint32_t, Sums>;

class Fitting {
public:
    Fitting(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses, const AssignedPoints& assigned,
            PointLabels& labels, const FinalFitOptions& options)
        : points_(points), assigned_(assigned), labels_(labels), options_(options)
    {
        for (std::uint32_t p = 0; p < assigned.parts.size(); ++p) {
            const SurfacePart& part = assigned.parts[p];
            if (part.points < options.least_points) continue;
            const bool piece = is_piece(part);
            result_.pieces += piece;
            if (piece) result_.piece_points += part.points;
            if (!piece || options.keep_pieces) add(p, hypotheses);
        }
        candidate_of_.assign(assigned.parts.size(), none);
        for (std::uint32_t c = 0; c < candidates_.size(); ++c) candidate_of_[candidates_[c].part] = c;
    }

    FinalFit run()
    {
        for (int step = 0; step < 1; ++step) {
            const std::vector<Sums> sums = pass(0, 0.4);
            for (std::size_t c = 0; c < candidates_.size(); ++c)
                if (const auto better = sums[c].best().step()) candidates_[c].shape = *better;
        }
        const std::vector<Sums> sums = pass(0.4, 0.8);
        std::vector<std::uint32_t> order(candidates_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return sums[a].all.points() > sums[b].all.points(); });
        std::vector<std::uint32_t> label_of(candidates_.size(), 0);
        for (const std::uint32_t c : order) {
            if (sums[c].all.points() < options_.least_points) continue;
            Primitive primitive = primitive_of(candidates_[c], sums[c]);
            if (!primitive.fit.has_shape()) continue;
            label_of[c] = primitive.label = static_cast<std::uint32_t>(result_.primitives.size() + 1);
            primitive.name = std::string(traits_of(primitive.fit.shape.kind).label) + " " +
                             std::to_string(++numbers_[primitive.fit.shape.kind]);
            result_.primitives.push_back(std::move(primitive));
        }
        relabel(label_of);
        return std::move(result_);
    }

private:
    void add(std::uint32_t part, const std::vector<Hypothesis>& hypotheses)
    {
        const SurfacePart& from = assigned_.parts[part];
        Candidate candidate;
        candidate.part = part;
        candidate.points = from.points;
        candidate.shape = hypotheses[from.hypothesis].shape;
        candidate.middle = from.box.centre();
        candidate.extent = std::max(from.box.diagonal(), options_.threshold);
        RefineOptions refine;
        refine.threshold = options_.threshold;
        const ShapeFit fit = refine_shape(FitPoints::of(from.some), candidate.shape, refine);
        if (fit.has_shape() && from.some.size() >= 50) candidate.shape = fit.shape;
        candidates_.push_back(candidate);
    }

    // Calls see(node, numbers, at, labels) for all labelled points, by all threads; those of one group by one.
    template <class See>
    void visit(double begin, double end, const See& see)
    {
        const std::size_t nodes = points_.tree().nodes().size();
        for_each_index(
            groups, options_.threads,
            [&](std::size_t g) {
                for (std::size_t n = g * nodes / groups; n < (g + 1) * nodes / groups; ++n) {
                    const auto node = static_cast<NodeId>(n);
                    if (points_.tree().node(node).points > 0) see(g, node);
                }
            },
            [&](std::size_t begun) {
                options_.progress(begin + (end - begin) * static_cast<double>(begun) / static_cast<double>(groups));
            });
    }

    std::uint32_t candidate(std::uint32_t label) const
    {
        return label == 0 ? none : candidate_of_[assigned_.part_of[(label & ~interior_label) - 1]];
    }

    std::vector<Sums> pass(double begin, double end)
    {
        std::vector<GroupSums> by_group(groups);
        visit(begin, end, [&](std::size_t group, NodeId node) {
            const std::vector<std::uint32_t> labels = labels_.get(node);
            if (std::all_of(labels.begin(), labels.end(), [](std::uint32_t l) { return l == 0; })) return;
            const std::vector<Vec3d> at = points_.positions(node);
            GroupSums& sums = by_group[group];
            for (std::size_t i = 0; i < labels.size(); ++i) {
                const std::uint32_t c = candidate(labels[i]);
                if (c == none || distance_to(candidates_[c].shape, at[i]) > options_.threshold) continue;
                auto found = sums.find(c);
                if (found == sums.end()) found = sums.emplace(c, Sums(candidates_[c])).first;
                found->second.all.add(at[i]);
                if (labels[i] & interior_label) found->second.interior.add(at[i]);
            }
        });
        std::vector<Sums> sums;
        for (const Candidate& c : candidates_) sums.emplace_back(c);
        for (const GroupSums& group : by_group)
            for (const auto& [c, part] : group) {
                sums[c].all.add(part.all);
                sums[c].interior.add(part.interior);
            }
        return sums;
    }

    Primitive primitive_of(const Candidate& candidate, const Sums& sums) const
    {
        Primitive primitive;
        primitive.fit = sums.best().result(options_.threshold);
        primitive.points = sums.all.points();
        primitive.cloud = points_.tree().folder().string();
        primitive.estimator = "detect";
        const SurfacePart& part = assigned_.parts[candidate.part];
        if (primitive.fit.has_shape() && !part.some.empty())
            primitive.bounds = bounds_of(primitive.fit.shape, part.some, {});
        if (primitive.fit.verdict == FitVerdict::good && is_piece(part)) {
            primitive.fit.verdict = FitVerdict::doubtful;
            primitive.fit.message =
                "the cloud's surface continues smoothly beyond the threshold: this may be a piece of something bent";
        }
        return primitive;
    }

    void relabel(const std::vector<std::uint32_t>& label_of)
    {
        std::array<std::uint64_t, groups> counts{};
        visit(0.8, 1, [&](std::size_t group, NodeId node) {
            std::vector<std::uint32_t> labels = labels_.get(node);
            counts[group] += labels.size();
            if (std::all_of(labels.begin(), labels.end(), [](std::uint32_t l) { return l == 0; })) return;
            const std::vector<Vec3d> at = points_.positions(node);
            for (std::size_t i = 0; i < labels.size(); ++i) {
                const std::uint32_t c = candidate(labels[i]);
                const bool near = c != none && distance_to(candidates_[c].shape, at[i]) <= options_.threshold;
                labels[i] = near ? label_of[c] : 0;
            }
            labels_.set_all(node, labels);
        });
        result_.points = std::accumulate(counts.begin(), counts.end(), std::uint64_t(0));
    }

    const ChosenPoints& points_;
    const AssignedPoints& assigned_;
    PointLabels& labels_;
    const FinalFitOptions& options_;
    std::vector<Candidate> candidates_;
    std::vector<std::uint32_t> candidate_of_;  // of a part
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
