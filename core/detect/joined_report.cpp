#include "pcm/detect/joined_report.h"

#include "pcm/detect/point_labels.h"
#include "pcm/shapes/primitive_list.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

// What the labels of both became: those of the second follow those of the first in `label_of`. No point has two.
std::shared_ptr<const PointLabels> joined_labels(const Tree& tree, const PointLabels& first, const PointLabels& second,
                                                 std::size_t first_count, const std::vector<std::uint32_t>& label_of)
{
    const auto labels = std::make_shared<PointLabels>(tree);
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        if (tree.node(node).points == 0) continue;
        std::vector<std::uint32_t> both = first.get(node);
        const std::vector<std::uint32_t> others = second.get(node);
        for (std::size_t i = 0; i < both.size(); ++i)
            if (const std::size_t number = both[i] ? both[i] : others[i] ? first_count + others[i] : 0; number > 0)
                both[i] = label_of[number - 1];
        labels->set_all(node, both);
    }
    return labels;
}

// Labels, colours and names in the order of the list, as each detection gives them.
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

}  // namespace

DetectReport joined(const Tree& tree, DetectReport rest, DetectReport others)
{
    const std::size_t first_count = rest.primitives.size();
    std::vector<Primitive> all = std::move(rest.primitives);
    std::move(others.primitives.begin(), others.primitives.end(), std::back_inserter(all));
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return all[a].points > all[b].points; });
    std::vector<std::uint32_t> label_of(all.size(), 0);
    rest.primitives.clear();
    for (const std::size_t i : order) {
        rest.primitives.push_back(std::move(all[i]));
        label_of[i] = static_cast<std::uint32_t>(rest.primitives.size());
    }
    number_again(rest.primitives);
    rest.labels = joined_labels(tree, *rest.labels, *others.labels, first_count, label_of);
    rest.outcome.points_in += others.outcome.points_in;
    rest.outcome.points_out += others.outcome.points_out;
    rest.outcome.seconds += others.outcome.seconds;
    rest.outcome.error = std::max(rest.outcome.error, others.outcome.error);
    rest.notes.insert(rest.notes.end(), others.notes.begin(), others.notes.end());
    return rest;
}

}  // namespace pcm
