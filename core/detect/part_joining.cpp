#include "pcm/detect/part_joining.h"

#include "pcm/cloud/growing_box_tree.h"
#include "pcm/detect/hypotheses.h"
#include "pcm/detect/surface_of_both.h"
#include "pcm/detect/tuning.h"
#include "pcm/detect/unit_parts.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t least_used = 20;  // points that a surface is fitted to
constexpr std::size_t most_used = 512;

class Joining {
public:
    Joining(AssignedPoints& assigned, std::vector<Hypothesis>& hypotheses, const PartJoinOptions& options)
        : assigned_(assigned), hypotheses_(hypotheses), options_(options), group_(assigned.parts.size())
    {
        std::iota(group_.begin(), group_.end(), 0u);
    }

    void run()
    {
        std::vector<std::uint32_t> order;
        for (std::uint32_t p = 0; p < assigned_.parts.size(); ++p)
            if (can_join(assigned_.parts[p])) order.push_back(p);
        bool is_changed = true;
        while (is_changed) {
            std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
                return assigned_.parts[a].points > assigned_.parts[b].points;
            });
            is_changed = join_once(order);
        }
        pack();
    }

private:
    bool can_join(const SurfacePart& part) const
    {
        return can_be_joined(kind_of(part)) && part.some.size() >= least_used &&
               static_cast<double>(part.mixed) <= tuned_.max_mixed * static_cast<double>(part.sampled);
    }

    ShapeKind kind_of(const SurfacePart& part) const { return hypotheses_[part.hypothesis].shape.kind; }
    bool is_small(const SurfacePart& part) const { return part.points < options_.least_points; }

    // Joins each part to the first of the larger ones that takes it; `order` keeps those that stay.
    bool join_once(std::vector<std::uint32_t>& order)
    {
        std::vector<std::uint32_t> kept;
        GrowingBoxTree reached;  // places in `kept`
        const auto add = [&](std::uint32_t k) {
            const SurfacePart& part = assigned_.parts[kept[k]];
            Box3d box = part.box;
            const double gap = most_gap(kind_of(part), box.diagonal(), options_);
            for (std::size_t a = 0; a < 3; ++a) box.min[a] -= gap, box.max[a] += gap;
            reached.add(box, k);
        };
        for (const std::uint32_t p : order) {
            const auto takes = [&](std::uint32_t k) { return join(kept[k], p); };
            const std::vector<std::uint32_t> near = reached.touching(assigned_.parts[p].box);
            if (std::any_of(near.begin(), near.end(), takes)) continue;
            kept.push_back(p);
            add(static_cast<std::uint32_t>(kept.size() - 1));
        }
        const bool is_changed = kept.size() < order.size();
        order = std::move(kept);
        return is_changed;
    }

    bool join(std::uint32_t to, std::uint32_t from)
    {
        SurfacePart &one = assigned_.parts[to], &other = assigned_.parts[from];
        const Hypothesis &a = hypotheses_[one.hypothesis], &b = hypotheses_[other.hypothesis];
        const auto surface = surface_of_both({a.shape, a.threshold, one.some, is_small(one)},
                                             {b.shape, b.threshold, other.some, is_small(other)}, options_);
        if (!surface) return false;
        Hypothesis both = a;
        both.shape = *surface;
        both.threshold = std::max(a.threshold, b.threshold);
        both.whole = a.whole && b.whole;
        both.box.extend(b.box);
        hypotheses_.push_back(std::move(both));
        add_to(one, other, most_used);
        one.hypothesis = static_cast<std::uint32_t>(hypotheses_.size() - 1);
        group_[from] = to;
        return true;
    }

    // Leaves out the parts that others have taken.
    void pack()
    {
        std::vector<std::uint32_t> place(assigned_.parts.size());
        std::vector<SurfacePart> parts;
        for (std::uint32_t p = 0; p < group_.size(); ++p) {
            if (group_[p] != p) continue;
            place[p] = static_cast<std::uint32_t>(parts.size());
            parts.push_back(std::move(assigned_.parts[p]));
        }
        for (auto& [number, part] : assigned_.numbers) {
            while (group_[part] != part) part = group_[part];
            part = place[part];
        }
        assigned_.parts = std::move(parts);
    }

    AssignedPoints& assigned_;
    std::vector<Hypothesis>& hypotheses_;
    const PartJoinOptions& options_;
    const JoiningTuning& tuned_ = detect_tuning().joining;
    std::vector<std::uint32_t> group_;  // for each part the one that has taken it, or itself
};

}  // namespace

void join_parts(AssignedPoints& assigned, std::vector<Hypothesis>& hypotheses, const PartJoinOptions& options)
{
    Joining(assigned, hypotheses, options).run();
}

AssignedPoints assign_joined(const ChosenPoints& points, const std::vector<Box3i>& units,
                             std::vector<Hypothesis>& hypotheses, AssignOptions assign, const PartJoinOptions& join,
                             PointLabels* labels)
{
    assign.least_points = std::max<std::uint64_t>(least_used, assign.least_points / 10);
    assign.some_from = 0;
    assign.most_some = most_used;
    AssignedPoints assigned = assign_points(points, units, hypotheses, assign, labels);
    join_parts(assigned, hypotheses, join);
    return assigned;
}

}  // namespace pcm
