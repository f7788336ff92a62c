#include "pcm/filter/orientation_pieces.h"

#include "pcm/filter/two_surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace pcm {
namespace {

// Classes of |ni . nj|, descending from parallel normals.
constexpr std::array<float, 8> least_parallel{0.999F, 0.99F, 0.97F, 0.9F, 0.8F, 0.6F, 0.3F, 0.0F};

float dot_of(const std::array<float, 3>& a, const std::array<float, 3>& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vec3d position_of(const SearchPositions& positions, std::size_t i)
{
    Vec3d p;
    for (std::size_t a = 0; a < 3; ++a)
        p[a] = static_cast<double>(positions.is_wide() ? positions.wide[a][i] : positions.narrow[a][i]) *
               positions.scale[a];
    return p;
}

// What most of each point's nearest neighbours and the point itself have.
std::vector<std::uint8_t> smoothed(const JoinedNeighbours& neighbours, const std::vector<std::uint8_t>& flags)
{
    std::vector<std::uint8_t> result(flags.size());
    for (std::size_t i = 0; i < flags.size(); ++i) {
        std::size_t all = 1, set = flags[i];
        for (std::size_t e = i * JoinedNeighbours::most; e < (i + 1) * JoinedNeighbours::most; ++e) {
            if (neighbours[e] == JoinedNeighbours::none) continue;
            ++all;
            set += flags[neighbours[e]];
        }
        result[i] = 2 * set > all;
    }
    return result;
}

// The points of a unit that are joined, as a graph.
class Joiner {
public:
    Joiner(const SearchPositions& positions, const JoinedNeighbours& neighbours,
           const std::vector<std::array<float, 3>>& normals, const std::vector<std::uint8_t>& two_surfaces)
        : positions_(positions),
          neighbours_(neighbours),
          normals_(normals),
          two_surfaces_(two_surfaces),
          has_two_surfaces_(std::find(two_surfaces.begin(), two_surfaces.end(), 1) != two_surfaces.end()),
          edges_(neighbours.size()),
          sets_(positions.size())
    {
    }

    // Joins along the edges in the order of their classes. Those of the first class, most of all, at once.
    SidedSets join()
    {
        std::array<std::size_t, least_parallel.size() + 1> begin{};  // first place of each class from the second on
        for (std::uint32_t i = 0; i < positions_.size(); ++i)
            for (std::size_t e = first_edge(i); e < first_edge(i + 1); ++e) {
                const Edge edge = edges_[e] = edge_to(i, neighbours_[e]);
                if (edge == not_joined) continue;
                if (class_of(edge) == 0)
                    sets_.join(i, neighbours_[e], side_of(edge));
                else
                    ++begin[class_of(edge) + 1];
            }
        for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
        std::vector<std::uint32_t> others(begin.back());
        for (std::size_t e = 0; e < edges_.size(); ++e)
            if (edges_[e] != not_joined && class_of(edges_[e]) != 0)
                others[begin[class_of(edges_[e])]++] = static_cast<std::uint32_t>(e);
        for (const std::uint32_t e : others) sets_.join(e / JoinedNeighbours::most, neighbours_[e], side_of(edges_[e]));
        return std::move(sets_);
    }

private:
    // What joins a point with one of its neighbours: twice the class of their normals, and 1 where these point to
    // opposite sides.
    using Edge = std::uint8_t;
    static constexpr Edge not_joined = 255;
    static std::size_t class_of(Edge edge) { return edge >> 1; }
    static int side_of(Edge edge) { return edge & 1 ? -1 : 1; }
    static std::size_t first_edge(std::uint32_t i) { return std::size_t(i) * JoinedNeighbours::most; }

    bool is_defined(std::uint32_t i) const { return normals_[i] != std::array<float, 3>{}; }

    bool is_across_gap(std::uint32_t i, std::uint32_t j) const
    {
        return is_across(position_of(positions_, j) - position_of(positions_, i),
                         {normals_[i][0], normals_[i][1], normals_[i][2]});
    }

    Edge edge_to(std::uint32_t i, std::uint32_t j) const
    {
        if (j == JoinedNeighbours::none) return not_joined;
        // Only across a gap may the edge from j to i be another one.
        const bool may_be_gap = has_two_surfaces_ && (two_surfaces_[i] || two_surfaces_[j]);
        if (may_be_gap ? is_across_gap(i, j) : j < i && neighbours_.surely_lists(j, i)) return not_joined;
        const float cosine = dot_of(normals_[i], normals_[j]), parallel = std::fabs(cosine);
        if (cosine == 0 && !(is_defined(i) && is_defined(j))) return not_joined;
        unsigned number = 0;  // number of the class
        for (const float least : least_parallel) number += parallel < least;
        return static_cast<Edge>(2 * number + (cosine < 0));
    }

    const SearchPositions& positions_;
    const JoinedNeighbours& neighbours_;
    const std::vector<std::array<float, 3>>& normals_;
    const std::vector<std::uint8_t>& two_surfaces_;
    const bool has_two_surfaces_;
    std::vector<Edge> edges_;  // in the order of the neighbours
    SidedSets sets_;
};

}  // namespace

void JoinedNeighbours::resize(std::size_t points)
{
    numbers_.assign(points * most, none);
    first_.assign(points, none);
    shares_places_ = false;
}

void JoinedNeighbours::set(std::uint32_t point, const std::uint32_t* numbers, const double* squared, std::size_t count)
{
    std::uint32_t* const mine = numbers_.data() + std::size_t(point) * most;
    std::size_t kept = 0;
    first_[point] = point;
    for (std::size_t j = 0; j < count && (kept < most || squared[j] == 0); ++j) {
        if (numbers[j] >= first_.size()) continue;
        if (squared[j] == 0) {
            shares_places_ = true;
            first_[point] = std::min(first_[point], numbers[j]);
        }
        if (kept < most) mine[kept++] = numbers[j];
    }
}

SidedSets::SidedSets(std::size_t count) : numbers_(count)
{
    for (std::size_t i = 0; i < count; ++i) numbers_[i] = {static_cast<std::uint32_t>(i), 1, 1};
}

SidedSets::Found SidedSets::find(std::uint32_t number)
{
    std::uint32_t root = number;
    int side = 1;
    for (; numbers_[root].parent != root; root = numbers_[root].parent) side *= numbers_[root].side;
    // The way there becomes short.
    for (int left = side; numbers_[number].parent != root && number != root;) {
        Number& passed = numbers_[number];
        number = passed.parent;
        const int step = passed.side;
        passed.parent = root;
        passed.side = static_cast<std::int8_t>(left);
        left *= step;
    }
    return {root, side};
}

bool SidedSets::join(std::uint32_t a, std::uint32_t b, int side)
{
    Found x = find(a), y = find(b);
    if (x.set == y.set) return false;
    if (numbers_[x.set].size < numbers_[y.set].size) std::swap(x, y);
    numbers_[y.set].parent = x.set;
    numbers_[x.set].size += numbers_[y.set].size;
    numbers_[y.set].side = static_cast<std::int8_t>(x.side * y.side * side);
    return true;
}

void join_by_votes(SidedSets& sets, std::vector<SideVote> votes)
{
    std::sort(votes.begin(), votes.end(), [](const SideVote& x, const SideVote& y) {
        const std::int64_t clear = std::abs(x.sum), as_clear = std::abs(y.sum);
        if (clear != as_clear) return clear > as_clear;
        return x.a != y.a ? x.a < y.a : x.b < y.b;
    });
    for (const SideVote& vote : votes) sets.join(vote.a, vote.b, vote.sum < 0 ? -1 : 1);
}

void PieceSums::add(const Vec3d& p, const Vec3d& n)
{
    count += 1;
    squares += dot(p, p);
    flux += dot(n, p);
    positions = positions + p;
    normals = normals + n;
}

void PieceSums::join(const PieceSums& other, int side)
{
    count += other.count;
    squares += other.squares;
    flux += side * other.flux;
    positions = positions + other.positions;
    normals = normals + double(side) * other.normals;
}

double PieceSums::outward_or_up() const
{
    const Vec3d centre = positions / count;
    const double spread = std::sqrt(std::max(0.0, squares / count - dot(centre, centre)));
    const double up = normals[2] / count;
    const double outward = spread > 0 ? (flux - dot(centre, normals)) / (count * spread) : 0;
    const double clearer = std::fabs(up) >= std::fabs(outward) ? up : outward;
    if (std::fabs(clearer) > 1e-9) return clearer;
    for (const double component : normals)
        if (std::fabs(component) > 1e-9 * count) return component;
    return 1;
}

UnitPieces join_pieces(const SearchPositions& positions, const JoinedNeighbours& neighbours, const Vec3d& origin,
                       std::vector<std::array<float, 3>>& normals, std::vector<std::uint8_t>& two_surfaces)
{
    const std::size_t points = positions.size();
    const auto is_defined = [&](std::size_t i) { return normals[i] != std::array<float, 3>{}; };
    if (std::find(two_surfaces.begin(), two_surfaces.end(), 1) != two_surfaces.end())
        two_surfaces = smoothed(neighbours, two_surfaces);
    SidedSets sets = Joiner(positions, neighbours, normals, two_surfaces).join();
    UnitPieces pieces;
    pieces.piece.assign(points, no_piece);
    std::vector<std::uint32_t> number(points, no_piece);  // number of a set's piece
    for (std::uint32_t i = 0; i < points; ++i) {
        if (!is_defined(i)) continue;
        const SidedSets::Found found = sets.find(i);
        if (number[found.set] == no_piece) {
            number[found.set] = static_cast<std::uint32_t>(pieces.sums.size());
            pieces.sums.emplace_back();
        }
        pieces.piece[i] = number[found.set];
        if (found.side < 0)
            for (float& component : normals[i]) component = -component;
        pieces.sums[pieces.piece[i]].add(position_of(positions, i) + origin,
                                         {normals[i][0], normals[i][1], normals[i][2]});
    }
    std::vector<bool> flips;
    for (PieceSums& sums : pieces.sums) {
        flips.push_back(sums.outward_or_up() < 0);
        if (!flips.back()) continue;
        sums.flux = -sums.flux;
        sums.normals = -1.0 * sums.normals;
    }
    for (std::size_t i = 0; i < points; ++i)
        if (is_defined(i) && flips[pieces.piece[i]])
            for (float& component : normals[i]) component = -component;
    return pieces;
}

}  // namespace pcm
