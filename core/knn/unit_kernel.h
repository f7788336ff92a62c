// The innermost part of unit_search.h: the neighbours of up to 32 queries that lie together, in a tree of leaves of 32
// points. Compiled once per level of system/cpu.h, out of unit_kernel_source.h. Plain arrays throughout: see cpu.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

inline constexpr std::uint32_t leaf_points = 32;
inline constexpr std::uint32_t no_leaf = 0xffffffff;
inline constexpr int most_tree_depth = 40;

// A tree over points in grid steps, C being their integers; differences of any two fit C. The points of leaf l are
// blocks[96 * l]: 32 x, then y, then z. All leaves are full but the last one, whose slots beyond the points hold
// copies. Nodes are in preorder: a node over the leaves [a, b) has its left child, over [a, (a + b) / 2), next to it.
template <class C>
struct LeafTree {
    const C* blocks = nullptr;
    const std::uint32_t* ids = nullptr;  // numbers of the points, in the order of the leaves
    const C* boxes = nullptr;            // six per node: lowest x, y, z, highest x, y, z
    std::uint64_t points = 0;            // at least 1
    std::uint32_t leaves = 0;
    double scale[3] = {1, 1, 1};  // source units per step
    // Distances are compared in working units: steps where the scales are equal.
    bool equal_scales = true;
    float ratio[3] = {1, 1, 1};  // working units per step
    double working_unit = 1;     // in source units
};

template <class C>
struct QueryBlock {
    const C* block = nullptr;          // laid out like a leaf
    std::uint32_t active = 0;          // bits of its 32 slots that are queries; one or more
    std::uint32_t own_leaf = no_leaf;  // the leaf of the tree that this is: no point is its own neighbour then
};

// How many are searched, and room for the result. The rows of the queries are in the order of their slots.
struct KernelRequest {
    std::size_t neighbours = 0;  // k, at least 1
    double limit = 0;            // squared distance in source units, inclusive
    std::size_t stride = 0;      // row length of ids and squares, k or more
    std::uint32_t* ids = nullptr;
    double* squares = nullptr;  // exact, ascending
    std::uint32_t* counts = nullptr;
    std::uint64_t* lists = nullptr;     // list_words(k) of scratch memory, aligned to 64 bytes
    std::uint32_t* repeated = nullptr;  // counts the queries that single precision could not decide; may be null
};

// Capacity of a list of k neighbours, a multiple of the widest vector; one of a few up to 64, for which the lists are
// kept in registers.
inline std::size_t list_capacity(std::size_t k)
{
    const std::size_t eights = (k + 7) / 8;
    return 8 * (eights == 5 ? 6 : (eights == 7 ? 8 : eights));
}
// One list per query.
inline std::size_t list_words(std::size_t k) { return leaf_points * list_capacity(k); }

struct UnitKernels {
    void (*narrow)(const LeafTree<std::int32_t>&, const QueryBlock<std::int32_t>&, const KernelRequest&);
    void (*wide)(const LeafTree<std::int64_t>&, const QueryBlock<std::int64_t>&, const KernelRequest&);
};

// Those of simd_level(); throws what that throws.
const UnitKernels& unit_kernels();

const UnitKernels& baseline_unit_kernels();
const UnitKernels& avx2_unit_kernels();
const UnitKernels& avx512_unit_kernels();

}  // namespace pcm
