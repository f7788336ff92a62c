#include "pcm/detect/shared_points.h"

#include "pcm/cloud/growing_box_tree.h"
#include "pcm/detect/node_sums.h"
#include "pcm/detect/point_labels.h"
#include "pcm/detect/tuning.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr std::uint64_t most_compared = 500;  // points of a shape, about, that are compared with other shapes

struct Distances {
    std::uint64_t points = 0;
    double squares = 0;
    void add(const Distances& other)
    {
        points += other.points;
        squares += other.squares;
    }
};

// Keyed by two shapes, places in the list of shapes: points of the first one that are on the second one, and their
// distances from that. A shape and itself: all of its points that were compared.
using Shared = std::map<std::pair<std::uint32_t, std::uint32_t>, Distances>;

// Where points of a shape may be.
class Reach {
public:
    explicit Reach(const Primitive& one) : fit_(&one.fit), is_flat_(traits_of(one.fit.shape.kind).is_flat())
    {
        const Shape& shape = one.fit.shape;
        for (const Vec3d& corner : one.bounds.outline) box_.extend(corner);
        from_ = one.bounds.from;
        to_ = one.bounds.to;
        if (is_flat_) return;
        const double length = to_ - from_;  // 0 of a sphere
        const double wide = shape.radius + fit_->threshold;
        for (const double along : {from_ - length, to_ + length}) {
            const Vec3d middle = shape.point + along * shape.axis;
            box_.extend(middle - Vec3d{wide, wide, wide});
            box_.extend(middle + Vec3d{wide, wide, wide});
        }
    }
    bool is_flat() const { return is_flat_; }
    const Box3d& box() const { return box_; }
    bool is_on(const Vec3d& p) const { return box_.contains(p) && distance_to(fit_->shape, p) <= fit_->threshold; }
    // Not where it would continue.
    bool is_between_ends(const Vec3d& p) const
    {
        const double along = dot(p - fit_->shape.point, fit_->shape.axis);
        return is_flat_ || !(to_ > from_) || (along >= from_ && along <= to_);
    }

private:
    const ShapeFit* fit_;
    bool is_flat_;
    Box3d box_;
    double from_ = 0, to_ = 0;
};

class SharedPoints {
public:
    SharedPoints(const Tree& tree, const DetectOptions& options, DetectReport& report)
        : tree_(tree),
          rounding_(tree.info()),
          threads_(thread_count(options.threads)),
          watch_(options.progress),
          labels_(*report.labels),
          primitives_(report.primitives)
    {
        for (const Primitive& one : primitives_) {
            reaches_.emplace_back(one);
            if (!reaches_.back().box().empty())
                boxes_.add(reaches_.back().box(), static_cast<std::uint32_t>(reaches_.size() - 1));
        }
    }

    void run()
    {
        watch_.report(comparing, 0, true);
        const auto add = [](const Both& part, Both& to) {
            for (const auto& [pair, points] : part.on) to.on[pair].add(points);
            for (const auto& [pair, points] : part.continued) to.continued[pair].add(points);
        };
        sum_over_nodes<Both>(
            tree_, threads_, [&](Both& part, NodeId node) { see(node, part); },
            [&](const Both& part) { add(part, sums_); }, [&](double share) { watch_.report(comparing, share); });
        for (std::uint32_t i = 0; i < primitives_.size(); ++i)
            if (!reaches_[i].is_flat()) doubt_curved(i);
        for (const auto& [pair, points] : sums_.on)
            if (reaches_[pair.first].is_flat() && !reaches_[pair.second].is_flat()) doubt_flat(pair.first, pair.second);
        for (const auto& [pair, points] : sums_.continued)
            if (reaches_[pair.first].is_flat()) doubt_flat(pair.first, pair.second);
        watch_.finish("Done");
    }

private:
    struct Both {
        Shared on, continued;  // the latter beyond the ends of a curved shape
    };
    static constexpr const char* comparing = "Comparing shapes";

    std::uint64_t step_of(std::uint32_t shape) const { return 1 + primitives_[shape].points / most_compared; }

    void see(NodeId node, Both& part) const
    {
        const std::vector<std::uint32_t> labels = labels_.get(node);
        if (std::all_of(labels.begin(), labels.end(), [](std::uint32_t l) { return l == 0; })) return;
        ColumnSet columns;
        columns.positions = true;
        const Chunk chunk = tree_.read_chunk(node, columns);
        for (std::uint32_t i = 0; i < labels.size(); ++i) {
            if (labels[i] == 0 || i % step_of(labels[i] - 1) != 0) continue;
            const std::uint32_t own = labels[i] - 1;
            const Vec3d p = rounding_(tree_.info().grid.to_source(chunk.positions->grid(i)));
            part.on[{own, own}].add({1, square_from(own, p)});
            compare(own, p, part);
        }
    }

    // Flat shapes with curved ones.
    void compare(std::uint32_t own, const Vec3d& p, Both& part) const
    {
        Box3d at;
        at.extend(p);
        for (const std::uint32_t other : boxes_.touching(at))
            if (reaches_[own].is_flat() != reaches_[other].is_flat() && reaches_[other].is_on(p))
                (reaches_[other].is_between_ends(p) ? part.on : part.continued)[{own, other}].add(
                    {1, square_from(other, p)});
    }

    double square_from(std::uint32_t shape, const Vec3d& p) const
    {
        const double distance = distance_to(primitives_[shape].fit.shape, p);
        return distance * distance;
    }

    static Distances distances(const Shared& shared, std::uint32_t one, std::uint32_t other)
    {
        const auto found = shared.find({one, other});
        return found == shared.end() ? Distances() : found->second;
    }
    // Between the ends of a curved shape and beyond them.
    Distances distances(std::uint32_t one, std::uint32_t other) const
    {
        Distances all = distances(sums_.on, one, other);
        all.add(distances(sums_.continued, one, other));
        return all;
    }
    double share_on(std::uint32_t one, std::uint32_t other) const
    {
        const std::uint64_t all = distances(sums_.on, one, one).points;
        return all > 0 ? static_cast<double>(distances(one, other).points) / static_cast<double>(all) : 0;
    }
    // Whether points of `one` that are on `other` are as near to it as all of them to their own shape.
    bool is_as_near(std::uint32_t one, std::uint32_t other) const
    {
        const Distances own = distances(one, one), there = distances(one, other);
        return there.squares * static_cast<double>(own.points) <= own.squares * static_cast<double>(there.points);
    }

    void doubt_curved(std::uint32_t curved)
    {
        double others = 0;
        for (const auto& [pair, points] : sums_.on)
            if (pair.second == curved && pair.first != curved)
                others += static_cast<double>(points.points * step_of(pair.first));
        const double most = detect_tuning().sharing.max_others * static_cast<double>(primitives_[curved].points);
        ShapeFit& fit = primitives_[curved].fit;
        if (others > most)
            doubt(fit, FitIssue::other_surface,
                  "planes have more of the points on it than it has: it may be a part of a post or a beam, so compare "
                  "it with a section");
    }

    void doubt_flat(std::uint32_t flat, std::uint32_t curved)
    {
        const SharingTuning& tuned = detect_tuning().sharing;
        ShapeFit& fit = primitives_[flat].fit;
        const Primitive& other = primitives_[curved];
        if (fit.verdict != FitVerdict::good || other.fit.verdict != FitVerdict::good) return;
        if (share_on(flat, curved) >= tuned.min_strip && share_on(curved, flat) <= tuned.max_own &&
            is_as_near(flat, curved))
            doubt(fit, FitIssue::other_surface,
                  "its points lie on " + other.name + ", too: it may be a strip of that, so compare it with a section");
    }

    const Tree& tree_;
    const SourceRounding rounding_;
    const unsigned threads_;
    Watch watch_;
    const PointLabels& labels_;
    std::vector<Primitive>& primitives_;
    std::vector<Reach> reaches_;
    GrowingBoxTree boxes_;
    Both sums_;
};

}  // namespace

void doubt_shared_points(const std::shared_ptr<const Tree>& tree, const DetectOptions& options, DetectReport& report)
{
    if (!report.primitives.empty() && report.labels) SharedPoints(*tree, options, report).run();
}

}  // namespace pcm
