#include "pcm/detect/joined_report.h"

#include "pcm/detect/point_labels.h"
#include "pcm/detect/tuning.h"
#include "pcm/shapes/primitive_list.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

// The labels of two searches: those of the second follow those of the first.
class BothLabels {
public:
    BothLabels(const Tree& tree, const PointLabels& first, const PointLabels& second, const std::vector<Primitive>& all,
               std::size_t first_count)
        : tree_(tree), first_(first), second_(second), all_(all), first_count_(first_count)
    {
        find_kept();
    }

    // Number of points of each, keyed by label - 1, that are the other search's.
    std::vector<std::uint64_t> lost() const
    {
        std::vector<std::uint64_t> lost(all_.size(), 0);
        for_each_node([&](NodeId, std::vector<std::uint32_t>& one, const std::vector<std::uint32_t>& other) {
            for (std::size_t i = 0; i < one.size(); ++i)
                if (one[i] && other[i]) ++lost[(is_first(one[i], other[i]) ? other[i] : one[i]) - 1];
        });
        return lost;
    }

    // Each point's one, as `label_of` has it by label - 1.
    std::shared_ptr<const PointLabels> together(const std::vector<std::uint32_t>& label_of) const
    {
        const auto labels = std::make_shared<PointLabels>(tree_);
        for_each_node([&](NodeId node, std::vector<std::uint32_t>& one, const std::vector<std::uint32_t>& other) {
            for (std::size_t i = 0; i < one.size(); ++i)
                if (const std::uint32_t label = !other[i] || (one[i] && is_first(one[i], other[i])) ? one[i] : other[i];
                    label > 0)
                    one[i] = label_of[label - 1];
            labels->set_all(node, one);
        });
        return labels;
    }

private:
    // Whether a point that both searches have found is the first one's, by the labels of both shapes.
    bool is_first(std::uint32_t first, std::uint32_t second) const { return is_kept_[first - 1] || !is_good(second); }

    bool is_good(std::uint32_t label) const { return all_[label - 1].fit.verdict == FitVerdict::good; }

    // A good shape is replaced by good ones only that have most of its points.
    void find_kept()
    {
        std::vector<std::uint64_t> taken(first_count_, 0);
        for_each_node([&](NodeId, std::vector<std::uint32_t>& one, const std::vector<std::uint32_t>& other) {
            for (std::size_t i = 0; i < one.size(); ++i)
                if (one[i] && other[i] && is_good(other[i])) ++taken[one[i] - 1];
        });
        for (std::uint32_t i = 0; i < first_count_; ++i)
            is_kept_.push_back(is_good(i + 1) &&
                               static_cast<double>(taken[i]) <
                                   detect_tuning().contest.min_taken * static_cast<double>(all_[i].points));
    }

    template <class See>
    void for_each_node(const See& see) const
    {
        for (NodeId node = 0; node < tree_.nodes().size(); ++node) {
            if (tree_.node(node).points == 0) continue;
            std::vector<std::uint32_t> one = first_.get(node), other = second_.get(node);
            for (std::uint32_t& label : other)
                if (label > 0) label += static_cast<std::uint32_t>(first_count_);
            see(node, one, other);
        }
    }

    const Tree& tree_;
    const PointLabels &first_, &second_;
    const std::vector<Primitive>& all_;
    const std::size_t first_count_;
    std::vector<bool> is_kept_;  // keyed by the first search's label - 1
};

}  // namespace

void number_again(std::vector<Primitive>& primitives)
{
    std::map<ShapeKind, int> numbers;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        Primitive& one = primitives[i];
        one.label = static_cast<std::uint32_t>(i + 1);
        one.colour = colour_in_turn(i);
        one.name =
            std::string(traits_of(one.fit.shape.kind).label) + " " + std::to_string(++numbers[one.fit.shape.kind]);
    }
}

DetectReport joined(const Tree& tree, DetectReport rest, DetectReport others, std::uint64_t least_points)
{
    const std::size_t first_count = rest.primitives.size();
    std::vector<Primitive> all = std::move(rest.primitives);
    std::move(others.primitives.begin(), others.primitives.end(), std::back_inserter(all));
    std::vector<double> agreement = std::move(rest.agreement);
    agreement.resize(first_count, 1);
    agreement.insert(agreement.end(), others.agreement.begin(), others.agreement.end());
    agreement.resize(all.size(), 1);
    const BothLabels both(tree, *rest.labels, *others.labels, all, first_count);
    const std::vector<std::uint64_t> lost = both.lost();
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double most = detect_tuning().contest.max_lost * static_cast<double>(all[i].points);
        all[i].points -= lost[i];
        if (static_cast<double>(lost[i]) <= most && all[i].points >= least_points) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return all[a].points > all[b].points; });
    std::vector<std::uint32_t> label_of(all.size(), 0);
    std::vector<Primitive> kept;
    rest.agreement.clear();
    std::uint64_t points = 0;
    for (const std::size_t i : order) {
        kept.push_back(all[i]);
        rest.agreement.push_back(agreement[i]);
        label_of[i] = static_cast<std::uint32_t>(kept.size());
        points += all[i].points;
    }
    rest.labels = both.together(label_of);
    rest.primitives = std::move(kept);
    number_again(rest.primitives);
    rest.outcome.points_in += others.outcome.points_in;
    rest.outcome.points_out = points;
    rest.outcome.seconds += others.outcome.seconds;
    rest.outcome.error = std::max(rest.outcome.error, others.outcome.error);
    rest.notes.insert(rest.notes.end(), others.notes.begin(), others.notes.end());
    return rest;
}

}  // namespace pcm
