// The kernel of unit_kernel.h. Included by the files that compile it for one level each, and by nothing else.
//
// Squares are compared in single precision, of offsets from the middle of the queries. How far that can be off is
// known: a candidate that it puts close to the k-th is never dropped silently. The nearest one dropped is remembered,
// and if it may be nearer than the k-th, the query is repeated with all candidates that come into question, in double.
//
// Let v be an offset in working units, off by at most 3.1 * 2^-24 * |v|: by nothing where the scales are equal and |v|
// is at most 2^24. Only candidates with |v| <= reach + root matter, where `reach` is the largest |v| of a query and
// `root` the distance in question: others are certainly farther. The sum of the squares of differences of such offsets
// is off by 5 * 2^-24 of itself, and by nothing where it is an integer below 2^24. So two squares whose roots differ by
// 8 * 2^-22 * (reach + root), and whose quotient is at least 1 + 2^-20, are in the right order: see bound_of().
//
// Equal distances are ordered by position, so that the order of the points in the tree makes no difference. A list
// orders them by index; where the nearest candidate dropped is as far as the k-th, the query is repeated in double as
// well.
#pragma once

#include "pcm/knn/unit_kernel.h"
#include "pcm/knn/unit_lists.h"

namespace pcm {
namespace {

template <class C, int Eights>
class BlockSearch {
public:
    // Searches for the queries of the block in `active`.
    BlockSearch(const LeafTree<C>& tree, const QueryBlock<C>& queries, const KernelRequest& request,
                std::uint32_t active)
        : tree_(tree),
          queries_(queries),
          request_(request),
          capacity_(list_capacity(request.neighbours)),
          active_(active)
    {
        find_box();
        for (int axis = 0; axis < 3; ++axis) middle_[axis] = box_[axis] + (box_[axis + 3] - box_[axis]) / 2;
        to_offsets(queries.block, x_, y_, z_);
        for (int axis = 0; axis < 3; ++axis)
            reach_ = larger_of(reach_, larger_of(-offset(box_[axis], axis), offset(box_[axis + 3], axis)));
        exact_ = tree.equal_scales && reach_ < 0x1p23f;
        const double limit = request.limit / (tree.working_unit * tree.working_unit);
        // Above the squares of all candidates at the distance that is still allowed.
        const float most = limit < 1e38 ? static_cast<float>(limit) * (1 + 0x1p-19f) + 1e-30f : infinite;
        for (std::uint32_t q = 0; q < leaf_points; ++q) {
            dropped_[q] = key_of(infinite, empty_slot);
            std::uint64_t* list = request.lists + q * capacity_;
            for (std::size_t i = 0; i < capacity_; ++i)
                list[i] = i < capacity_ - request.neighbours ? 0 : key_of(most, empty_slot);
        }
        set_bounds();
    }

    void run()
    {
        if (!exact_)
            if (const std::uint32_t apart = queries_apart()) {
                BlockSearch(tree_, queries_, request_, active_ & ~apart).run();
                return BlockSearch(tree_, queries_, request_, apart).run();
            }
        const std::uint32_t active = active_;
        walk<false>();
        std::uint32_t undecided = 0;
        for (std::uint32_t bits = active; bits; bits &= bits - 1) {
            const std::uint32_t q = lowest_bit(bits);
            const std::uint64_t last = list_of(q)[capacity_ - 1];
            take_list(q);
            if (static_cast<std::uint32_t>(last) != empty_slot && square_of(dropped_[q]) < bound_of_list(q))
                undecided |= 1u << q;
        }
        if (undecided) repeat(undecided);
        for (std::uint32_t bits = active; bits; bits &= bits - 1) {
            const std::size_t row = row_of(lowest_bit(bits));
            std::uint32_t* ids = request_.ids + row * request_.stride;
            for (std::uint32_t i = 0; i < request_.counts[row]; ++i) ids[i] = tree_.ids[ids[i]];
        }
    }

private:
    std::uint64_t* list_of(std::uint32_t q) const { return request_.lists + q * capacity_; }
    // Row of the query in the result.
    std::size_t row_of(std::uint32_t q) const
    {
        return static_cast<std::size_t>(__builtin_popcount(queries_.active & ((1u << q) - 1)));
    }

    // The queries on one side of a gap that is longer than half of the longest side of their box; 0: there is none.
    // Together they would be searched with the precision of their distance.
    std::uint32_t queries_apart() const
    {
        int longest = 0;
        for (int axis = 1; axis < 3; ++axis)
            if (offset(box_[axis + 3], axis) > offset(box_[longest + 3], longest)) longest = axis;
        const C low = box_[longest], high = box_[longest + 3], middle = middle_[longest];
        C below = low, above = high;
        std::uint32_t apart = 0;
        for (std::uint32_t bits = active_; bits; bits &= bits - 1) {
            const std::uint32_t q = lowest_bit(bits);
            const C v = queries_.block[static_cast<std::uint32_t>(longest) * leaf_points + q];
            if (v <= middle) {
                below = larger_of(below, v);
            } else {
                above = v < above ? v : above;
                apart |= 1u << q;
            }
        }
        return above - below > (high - low) / 2 ? apart : 0;
    }

    void find_box()
    {
        const std::uint32_t one = lowest_bit(active_);
        for (int axis = 0; axis < 3; ++axis) {
            const C* of = queries_.block + axis * leaf_points;
            C low = of[one], high = low;
            for (std::uint32_t q = 0; q < leaf_points; ++q) {
                const C v = active_ >> q & 1 ? of[q] : of[one];
                low = v < low ? v : low;
                high = high < v ? v : high;
            }
            box_[axis] = low;
            box_[axis + 3] = high;
        }
    }

    float offset(C position, int axis) const
    {
        return static_cast<float>(position - middle_[axis]) * tree_.ratio[axis];
    }

    void to_offsets(const C* block, float* x, float* y, float* z) const
    {
        float* to[3] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
            const C middle = middle_[axis];
            const float ratio = tree_.ratio[axis];
            const C* from = block + axis * leaf_points;
            float* out = to[axis];
            for (std::uint32_t i = 0; i < leaf_points; ++i) out[i] = static_cast<float>(from[i] - middle) * ratio;
        }
    }

    // Squares from here on are certainly above those that were found to be `square`; 0 of 0 where squares are exact: of
    // points at the query's own place it makes no difference which are taken.
    float bound_of(float square) const
    {
        if (square == infinite) return square;
        if (exact_ && square < 0x1p24f) return square * (1 + 0x1p-23f);  // the next float, or the one after it
        const float root = __builtin_sqrtf(square);
        const float blur = exact_ && reach_ + root < 0x1p24f ? 0 : (reach_ + root) * 0x1p-22f;
        return square * (1 + 0x1p-20f) + (16 * blur * root + 64 * blur * blur + (exact_ ? 0 : 1e-30f));
    }

    // Squares from here on are certainly above that of the last in the query's list. 0 where all in the list are at the
    // query's own place: there is nothing nearer, and nothing that would come before them. Without this, each of a
    // million points at one place would be compared with all of them.
    float bound_of_list(std::uint32_t q) const
    {
        const float square = square_of(list_of(q)[capacity_ - 1]);
        return square == 0 && is_settled(q) ? 0 : bound_of(square);
    }

    // Whether all in the list, which is full and has squares of 0, are at the query's place. False where squares in
    // double underflow to 0 for other places too.
    bool is_settled(std::uint32_t q) const
    {
        for (std::uint32_t axis = 0; axis < 3; ++axis)
            if (!(tree_.scale[axis] * tree_.scale[axis] > 0)) return false;
        const std::uint64_t* list = list_of(q);
        for (std::size_t i = capacity_ - request_.neighbours; i < capacity_; ++i) {
            const auto index = static_cast<std::uint32_t>(list[i]);
            const C* point = tree_.blocks + std::size_t(3) * leaf_points * (index / leaf_points) + index % leaf_points;
            for (std::uint32_t axis = 0; axis < 3 * leaf_points; axis += leaf_points)
                if (point[axis] != queries_.block[axis + q]) return false;
        }
        return true;
    }

    void set_bounds()
    {
        for (std::uint32_t q = 0; q < leaf_points; ++q) bounds_[q] = active_ >> q & 1 ? bound_of_list(q) : -1;
        find_worst();
    }

    void find_worst()
    {
        Floats worst = Floats::load(bounds_);
        for (std::uint32_t q = Floats::width; q < leaf_points; q += Floats::width)
            worst = larger(worst, Floats::load(bounds_ + q));
        alignas(64) float lanes[Floats::width];
        worst.store(lanes);
        worst_ = lanes[0];
        for (std::uint32_t i = 1; i < Floats::width; ++i) worst_ = larger_of(worst_, lanes[i]);
    }

    // Not above the square of any distance between a query and a point in the box.
    float square_to(const C* box) const
    {
        float sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const C gap = larger_of(larger_of(box[axis] - box_[axis + 3], box_[axis] - box[axis + 3]), C(0));
            const float f = static_cast<float>(gap) * tree_.ratio[axis];
            sum += f * f;
        }
        return sum * (1 - 0x1p-20f);
    }

    struct Subtree {
        std::uint32_t node, first, last;  // over these leaves, the last not included
        float square;
        Subtree left() const { return {node + 1, first, first + (last - first) / 2, 0}; }
        Subtree right() const
        {
            const std::uint32_t half = (last - first) / 2;
            return {node + 2 * half, first + half, last, 0};
        }
    };

    // Visits every leaf that can hold neighbours, those around the queries first.
    template <bool Exact>
    void walk()
    {
        Subtree at{0, 0, tree_.leaves, 0}, aside[most_tree_depth];
        if (queries_.own_leaf == no_leaf) return descend<Exact>(at);
        int depth = 0;
        while (at.last - at.first > 1) {
            const Subtree left = at.left(), right = at.right();
            const bool in_left = queries_.own_leaf < left.last;
            aside[depth++] = in_left ? right : left;
            at = in_left ? left : right;
        }
        descend<Exact>(at);
        while (depth > 0) descend<Exact>(aside[--depth]);
    }

    template <bool Exact>
    void descend(Subtree from)
    {
        Subtree stack[most_tree_depth + 1];
        from.square = square_to(tree_.boxes + std::size_t(6) * from.node);
        stack[0] = from;
        for (int size = 1; size > 0;) {
            const Subtree at = stack[--size];
            if (at.square >= worst_) continue;
            if (at.last - at.first == 1) {
                visit<Exact>(at.first, tree_.boxes + std::size_t(6) * at.node);
                continue;
            }
            Subtree near = at.left(), far = at.right();
            near.square = square_to(tree_.boxes + std::size_t(6) * near.node);
            far.square = square_to(tree_.boxes + std::size_t(6) * far.node);
            if (far.square < near.square) {
                const Subtree other = near;
                near = far;
                far = other;
            }
            if (far.square < worst_) stack[size++] = far;
            if (near.square < worst_) stack[size++] = near;
        }
    }

    // The queries whose bounds reach into the box.
    std::uint32_t queries_near(const C* box) const
    {
        const Floats zero = Floats::all(0);
        Floats low[3], high[3];
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = Floats::all(offset(box[axis], axis));
            high[axis] = Floats::all(offset(box[axis + 3], axis));
        }
        std::uint32_t bits = 0;
        for (std::uint32_t q = 0; q < leaf_points; q += Floats::width) {
            const Floats x = Floats::load(x_ + q), y = Floats::load(y_ + q), z = Floats::load(z_ + q);
            const Floats gx = larger(larger(low[0] - x, x - high[0]), zero);
            const Floats gy = larger(larger(low[1] - y, y - high[1]), zero);
            const Floats gz = larger(larger(low[2] - z, z - high[2]), zero);
            const Floats gap = multiply_add(gx, gx, multiply_add(gy, gy, gz * gz));
            bits |= less_bits(gap * Floats::all(1 - 0x1p-20f), Floats::load(bounds_ + q)) << q;
        }
        return bits;
    }

    template <bool Exact>
    void visit(std::uint32_t leaf, const C* box)
    {
        std::uint32_t queries = queries_near(box);
        if (!queries) return;
        const C* block = tree_.blocks + std::size_t(3) * leaf_points * leaf;
        alignas(64) float x[leaf_points], y[leaf_points], z[leaf_points], squares[leaf_points];
        to_offsets(block, x, y, z);
        const std::uint64_t first = std::uint64_t(leaf) * leaf_points;
        const std::uint32_t present = tree_.points - first >= leaf_points ? ~0u : (1u << (tree_.points - first)) - 1;
        for (; queries; queries &= queries - 1) {
            const std::uint32_t q = lowest_bit(queries);
            const Floats qx = Floats::all(x_[q]), qy = Floats::all(y_[q]), qz = Floats::all(z_[q]);
            const Floats bound = Floats::all(bounds_[q]);
            std::uint32_t bits = 0;
            for (std::uint32_t i = 0; i < leaf_points; i += Floats::width) {
                const Floats dx = Floats::load(x + i) - qx, dy = Floats::load(y + i) - qy,
                             dz = Floats::load(z + i) - qz;
                const Floats square = multiply_add(dx, dx, multiply_add(dy, dy, dz * dz));
                square.store(squares + i);
                bits |= less_bits(square, bound) << i;
            }
            bits &= present;
            if (leaf == queries_.own_leaf) bits &= ~(1u << q);
            if (!bits) continue;
            if constexpr (Exact) {
                // Those up to the last of the list are in it, and so in the result.
                const std::uint64_t last = list_of(q)[capacity_ - 1];
                for (; bits; bits &= bits - 1) {
                    const std::uint32_t t = lowest_bit(bits), index = static_cast<std::uint32_t>(first) + t;
                    if (key_of(squares[t], index) > last) insert_exact(row_of(q), q, index);
                }
            } else {
                std::uint64_t* list = list_of(q);
                insert<Eights>(list, capacity_, bits, squares, static_cast<std::uint32_t>(first), dropped_ + q);
                bounds_[q] = bound_of_list(q);
            }
        }
        if (!Exact) find_worst();
    }

    double exact_square(std::uint32_t q, std::uint32_t index) const
    {
        const C* point = tree_.blocks + std::size_t(3) * leaf_points * (index / leaf_points) + index % leaf_points;
        const C* query = queries_.block + q;
        const double dx = static_cast<double>(point[0] - query[0]) * tree_.scale[0];
        const double dy = static_cast<double>(point[leaf_points] - query[leaf_points]) * tree_.scale[1];
        const double dz = static_cast<double>(point[2 * leaf_points] - query[2 * leaf_points]) * tree_.scale[2];
        return (dx * dx + dy * dy) + dz * dz;
    }

    // Whether a candidate comes after another: farther, or as far and after it by position, x first.
    bool is_after(double square, std::uint32_t index, double other_square, std::uint32_t other) const
    {
        if (square != other_square) return square > other_square;
        const C* a = tree_.blocks + std::size_t(3) * leaf_points * (index / leaf_points) + index % leaf_points;
        const C* b = tree_.blocks + std::size_t(3) * leaf_points * (other / leaf_points) + other % leaf_points;
        for (std::uint32_t axis = 0; axis < 3; ++axis, a += leaf_points, b += leaf_points)
            if (*a != *b) return *a > *b;
        return index > other;
    }

    // Into the sorted row of the result, if it comes before the last of k.
    void insert_exact(std::size_t row, std::uint32_t q, std::uint32_t index)
    {
        const double square = exact_square(q, index);
        if (square > request_.limit) return;
        double* squares = request_.squares + row * request_.stride;
        std::uint32_t* ids = request_.ids + row * request_.stride;
        const auto after = [&](std::size_t i) { return is_after(squares[i], ids[i], square, index); };
        std::size_t count = request_.counts[row];
        if (count == request_.neighbours) {
            if (!after(count - 1)) return;
            --count;
        }
        std::size_t at = count;
        for (; at > 0 && after(at - 1); --at) {
            squares[at] = squares[at - 1];
            ids[at] = ids[at - 1];
        }
        squares[at] = square;
        ids[at] = index;
        request_.counts[row] = static_cast<std::uint32_t>(count + 1);
    }

    void take_list(std::uint32_t q)
    {
        const std::size_t row = row_of(q);
        const std::uint64_t* list = list_of(q) + (capacity_ - request_.neighbours);
        std::uint32_t* ids = request_.ids + row * request_.stride;
        double* squares = request_.squares + row * request_.stride;
        std::size_t count = 0;
        for (; count < request_.neighbours && static_cast<std::uint32_t>(list[count]) != empty_slot; ++count)
            ids[count] = static_cast<std::uint32_t>(list[count]);
        exact_squares(q, ids, count, squares);
        // In order but for what single precision rounded.
        for (std::size_t i = 1; i < count; ++i) {
            const double square = squares[i];
            const std::uint32_t id = ids[i];
            std::size_t at = i;
            for (; at > 0 && is_after(squares[at - 1], ids[at - 1], square, id); --at) {
                squares[at] = squares[at - 1];
                ids[at] = ids[at - 1];
            }
            squares[at] = square;
            ids[at] = id;
        }
        while (count > 0 && squares[count - 1] > request_.limit) --count;
        request_.counts[row] = static_cast<std::uint32_t>(count);
    }

    // As exact_square(), a batch at a time.
    void exact_squares(std::uint32_t q, const std::uint32_t* indices, std::size_t count, double* squares) const
    {
        constexpr std::size_t batch = 16;
        alignas(64) C d[3][batch] = {};
        for (std::size_t first = 0; first < count; first += batch) {
            const std::size_t size = count - first < batch ? count - first : batch;
            for (std::size_t i = 0; i < size; ++i) {
                const std::uint32_t index = indices[first + i];
                const C* point =
                    tree_.blocks + std::size_t(3) * leaf_points * (index / leaf_points) + index % leaf_points;
                d[0][i] = point[0] - queries_.block[q];
                d[1][i] = point[leaf_points] - queries_.block[leaf_points + q];
                d[2][i] = point[2 * leaf_points] - queries_.block[2 * leaf_points + q];
            }
            alignas(64) double sums[batch];
            for (std::size_t i = 0; i < batch; ++i) {
                const double dx = static_cast<double>(d[0][i]) * tree_.scale[0];
                const double dy = static_cast<double>(d[1][i]) * tree_.scale[1];
                const double dz = static_cast<double>(d[2][i]) * tree_.scale[2];
                sums[i] = (dx * dx + dy * dy) + dz * dz;
            }
            for (std::size_t i = 0; i < size; ++i) squares[first + i] = sums[i];
        }
    }

    // Compares all further candidates that may be among the nearest k of the queries in `undecided`, in double.
    void repeat(std::uint32_t undecided)
    {
        if (request_.repeated) *request_.repeated += static_cast<std::uint32_t>(__builtin_popcount(undecided));
        active_ = undecided;
        set_bounds();
        walk<true>();
    }

    const LeafTree<C>& tree_;
    const QueryBlock<C>& queries_;
    const KernelRequest& request_;
    const std::size_t capacity_;
    std::uint32_t active_;
    C box_[6];     // box of the queries
    C middle_[3];  // middle of the box: the origin of the offsets
    alignas(64) float x_[leaf_points];
    alignas(64) float y_[leaf_points];
    alignas(64) float z_[leaf_points];
    alignas(64) float bounds_[leaf_points];  // candidates with squares below it may be neighbours; -1: no query
    std::uint64_t dropped_[leaf_points];     // the smallest key that was dropped from each list
    float worst_ = infinite;                 // the largest bound
    float reach_ = 0;                        // the largest magnitude of the queries' offsets
    bool exact_ = false;                     // the offsets of all points near the queries are integers below 2^24
};

template <class C>
void search_block(const LeafTree<C>& tree, const QueryBlock<C>& queries, const KernelRequest& request)
{
    constexpr bool many_registers = Keys::width >= 4;  // for lists of up to 64 keys
    switch (list_capacity(request.neighbours) / 8) {
        case 1:
            return BlockSearch<C, 1>(tree, queries, request, queries.active).run();
        case 2:
            return BlockSearch<C, 2>(tree, queries, request, queries.active).run();
        case 3:
            return BlockSearch<C, 3>(tree, queries, request, queries.active).run();
        case 4:
            return BlockSearch<C, 4>(tree, queries, request, queries.active).run();
        case 6:
            return BlockSearch < C, many_registers ? 6 : 0 > (tree, queries, request, queries.active).run();
        case 8:
            return BlockSearch < C, many_registers ? 8 : 0 > (tree, queries, request, queries.active).run();
        default:
            return BlockSearch<C, 0>(tree, queries, request, queries.active).run();
    }
}

}  // namespace
}  // namespace pcm
