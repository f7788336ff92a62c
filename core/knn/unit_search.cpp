#include "pcm/knn/unit_search.h"

#include "pcm/knn/flann_search.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/knn/unit_tree.h"
#include "pcm/system/cpu.h"

#include <algorithm>
#include <array>
#include <mutex>

namespace pcm {
namespace {

// The box of all positions.
struct PositionBox {
    Vec3i low{};
    Vec3d sides{};       // in steps
    bool narrow = true;  // differences fit std::int32_t
};

template <class Column>
PositionBox extent_of(const std::array<Column, 3>& columns)
{
    PositionBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(columns[axis].begin(), columns[axis].end());
        box.low[axis] = *low;
        box.sides[axis] = static_cast<double>(std::int64_t(*high) - std::int64_t(*low));
        if (std::int64_t(*high) - std::int64_t(*low) > std::numeric_limits<std::int32_t>::max()) box.narrow = false;
    }
    return box;
}

PositionBox extent_of(const SearchPositions& positions)
{
    return positions.is_wide() ? extent_of(positions.wide) : extent_of(positions.narrow);
}

// The points at `indices`, numbered as `ids` has them; all points when null, called by their indices.
template <class C>
std::vector<TreePoint<C>> points_of(const SearchPositions& positions, const Vec3i& low,
                                    const std::vector<std::uint32_t>* indices, bool by_index)
{
    std::vector<TreePoint<C>> points(indices ? indices->size() : positions.size());
    const auto take = [&](const auto& columns) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t from = indices ? (*indices)[i] : i;
            for (std::size_t axis = 0; axis < 3; ++axis)
                points[i].at[axis] = static_cast<C>(columns[axis][from] - low[axis]);
            points[i].id = static_cast<std::uint32_t>(by_index ? from : i);
        }
    };
    if (positions.is_wide())
        take(positions.wide);
    else
        take(positions.narrow);
    return points;
}

void run_kernel(const UnitKernels& kernels, const LeafTree<std::int32_t>& tree, const QueryBlock<std::int32_t>& queries,
                const KernelRequest& request)
{
    kernels.narrow(tree, queries, request);
}

void run_kernel(const UnitKernels& kernels, const LeafTree<std::int64_t>& tree, const QueryBlock<std::int64_t>& queries,
                const KernelRequest& request)
{
    kernels.wide(tree, queries, request);
}

// Room for one call of a kernel.
class BlockResult {
public:
    explicit BlockResult(std::size_t k, double limit)
        : lists_(list_words(k)), ids_(leaf_points * k), squares_(leaf_points * k), counts_(leaf_points)
    {
        request.neighbours = k;
        request.limit = limit;
        request.stride = k;
        request.ids = ids_.data();
        request.squares = squares_.data();
        request.counts = counts_.data();
        request.lists = lists_.data();
    }
    KernelRequest request;

private:
    AlignedArray<std::uint64_t> lists_;
    std::vector<std::uint32_t> ids_;
    std::vector<double> squares_;
    std::vector<std::uint32_t> counts_;
};

std::uint32_t lowest_bits(std::uint32_t count) { return count < 32 ? (1u << count) - 1 : ~0u; }

template <class C>
class TreeSearch final : public UnitSearch {
public:
    TreeSearch(std::vector<TreePoint<C>> points, const Vec3d& scale, const Vec3d& sides)
        : tree_(std::move(points), scale, sides), kernels_(unit_kernels())
    {
    }

    void search(const std::vector<std::uint32_t>* queries, const UnitSearchOptions& options,
                const std::function<void(const FoundNeighbours&)>& found) const override
    {
        const LeafTree<C>& tree = tree_.view();
        const std::size_t k = std::min<std::size_t>(options.neighbours, tree.points - 1);
        BlockResult result(std::max<std::size_t>(1, k), options.max_distance * options.max_distance);
        std::vector<std::uint32_t> wanted;
        if (queries) wanted = slots_of(*queries);
        for (std::uint32_t leaf = 0; leaf < tree.leaves; ++leaf) {
            const std::uint32_t active = queries ? wanted[leaf] : lowest_bits(tree_.points_in(leaf));
            if (!active) continue;
            std::uint32_t points[leaf_points];
            std::size_t size = 0;
            for (std::uint32_t slot = 0; slot < leaf_points; ++slot)
                if (active >> slot & 1) points[size++] = tree.ids[std::size_t(leaf) * leaf_points + slot];
            if (k > 0)
                run_kernel(kernels_, tree, {tree_.leaf(leaf), active, leaf}, result.request);
            else
                std::fill_n(result.request.counts, size, 0u);
            const KernelRequest& r = result.request;
            found({points, size, k, r.ids, r.squares, r.counts});
        }
    }

private:
    // For each leaf, one bit per slot.
    std::vector<std::uint32_t> slots_of(const std::vector<std::uint32_t>& queries) const
    {
        const LeafTree<C>& tree = tree_.view();
        std::call_once(once_, [&] {
            places_.resize(tree.points);
            for (std::size_t i = 0; i < tree.points; ++i) places_[tree.ids[i]] = static_cast<std::uint32_t>(i);
        });
        std::vector<std::uint32_t> bits(tree.leaves);
        for (const std::uint32_t query : queries)
            bits[places_[query] / leaf_points] |= 1u << places_[query] % leaf_points;
        return bits;
    }

    UnitTree<C> tree_;
    const UnitKernels& kernels_;
    mutable std::once_flag once_;
    mutable std::vector<std::uint32_t> places_;  // in the leaves, by index; made when it is needed first
};

// Nothing to search.
class EmptySearch final : public UnitSearch {
public:
    void search(const std::vector<std::uint32_t>*, const UnitSearchOptions&,
                const std::function<void(const FoundNeighbours&)>&) const override
    {
    }
};

template <class C>
std::unique_ptr<UnitSearch> make_tree_search(SearchPositions positions, const PositionBox& box)
{
    auto points = points_of<C>(positions, box.low, nullptr, true);
    const Vec3d scale = positions.scale;
    positions = {};
    return std::make_unique<TreeSearch<C>>(std::move(points), scale, box.sides);
}

}  // namespace

const UnitKernels& unit_kernels()
{
    switch (simd_level()) {
#ifdef PCM_HAVE_AVX
        case SimdLevel::avx512:
            return avx512_unit_kernels();
        case SimdLevel::avx2:
            return avx2_unit_kernels();
#endif
        default:
            return baseline_unit_kernels();
    }
}

std::unique_ptr<UnitSearch> make_unit_search(SearchPositions positions)
{
    if (positions.size() == 0) return std::make_unique<EmptySearch>();
    const PositionBox box = extent_of(positions);
    return box.narrow ? make_tree_search<std::int32_t>(std::move(positions), box)
                      : make_tree_search<std::int64_t>(std::move(positions), box);
}

std::unique_ptr<UnitSearch> make_unit_search(SearchPositions positions, NeighbourBackend backend)
{
    if (backend == NeighbourBackend::flann && positions.size() > 0) return make_flann_search(std::move(positions));
    return make_unit_search(std::move(positions));
}

}  // namespace pcm
