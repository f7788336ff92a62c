#include "pcm/cloud/growing_box_tree.h"

#include <algorithm>
#include <utility>

namespace pcm {

void GrowingBoxTree::add(const Box3d& box, std::uint32_t number)
{
    Part added;
    added.boxes.push_back(box);
    added.numbers.push_back(number);
    while (!parts_.empty() && parts_.back().boxes.size() == added.boxes.size()) {
        const Part& last = parts_.back();
        added.boxes.insert(added.boxes.end(), last.boxes.begin(), last.boxes.end());
        added.numbers.insert(added.numbers.end(), last.numbers.begin(), last.numbers.end());
        parts_.pop_back();
    }
    added.tree = BoxTree(added.boxes);
    parts_.push_back(std::move(added));
}

std::vector<std::uint32_t> GrowingBoxTree::touching(const Box3d& box) const
{
    std::vector<std::uint32_t> found;
    for (const Part& part : parts_)
        for (const std::uint32_t i : part.tree.touching(box)) found.push_back(part.numbers[i]);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace pcm
