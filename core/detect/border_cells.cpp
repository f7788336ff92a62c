#include "pcm/detect/border_cells.h"

#include "pcm/detect/point_labels.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace pcm {
namespace {

constexpr std::uint64_t keys = std::uint64_t(1) << 63;
constexpr std::size_t read_cells = 65536;

bool before(const BorderCell& a, const BorderCell& b)
{
    return std::tie(a.key, a.hypothesis, a.label) < std::tie(b.key, b.hypothesis, b.label);
}

}  // namespace

JoinedLabels::JoinedLabels(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

std::uint32_t JoinedLabels::root(std::uint32_t label)
{
    while (parent_[label] != label) label = parent_[label] = parent_[parent_[label]];
    return label;
}

void JoinedLabels::join(std::uint32_t a, std::uint32_t b)
{
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
}

BorderCells::BorderCells() : file_(scratch_file("pcm-borders")) {}

void BorderCells::add(const std::vector<BorderCell>& cells)
{
    std::uint64_t place = 0;
    {
        const std::lock_guard lock(mutex_);
        place = cells_;
        cells_ += cells.size();
    }
    file_.write_at(cells.data(), cells.size() * sizeof(BorderCell), place * sizeof(BorderCell));
}

void BorderCells::join(const std::function<void(std::uint32_t, std::uint32_t)>& join, std::size_t most) const
{
    const std::uint64_t passes = cells_ / most + 1, width = keys / passes + 1;
    std::vector<BorderCell> some, read;
    for (std::uint64_t pass = 0; pass < passes; ++pass) {
        some.clear();
        for (std::uint64_t place = 0; place < cells_; place += read.size()) {
            read.resize(static_cast<std::size_t>(std::min<std::uint64_t>(read_cells, cells_ - place)));
            file_.read_at(read.data(), read.size() * sizeof(BorderCell), place * sizeof(BorderCell));
            for (const BorderCell& cell : read)
                if (cell.key / width == pass) some.push_back(cell);
        }
        std::sort(some.begin(), some.end(), before);
        for (std::size_t i = 1; i < some.size(); ++i)
            if (some[i].key == some[i - 1].key && some[i].hypothesis == some[i - 1].hypothesis)
                join(some[i].label, some[i - 1].label);
    }
}

}  // namespace pcm
