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
constexpr std::uint8_t no_class = 255;

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
            if (neighbours[e] == no_number) continue;
            ++all;
            set += flags[neighbours[e]];
        }
        result[i] = 2 * set > all;
    }
    return result;
}

// The class of each neighbour of each point.
std::vector<std::uint8_t> classes_of(const SearchPositions& positions, const JoinedNeighbours& neighbours,
                                     const std::vector<std::array<float, 3>>& normals,
                                     const std::vector<std::uint8_t>& two_surfaces)
{
    std::vector<std::uint8_t> classes(neighbours.size(), no_class);
    for (std::size_t e = 0; e < neighbours.size(); ++e) {
        const std::array<float, 3> none{};
        const std::size_t i = e / JoinedNeighbours::most;
        if (neighbours[e] == no_number || normals[i] == none || normals[neighbours[e]] == none) continue;
        const std::uint32_t j = neighbours[e];
        if ((two_surfaces[i] || two_surfaces[j]) && is_across(position_of(positions, j) - position_of(positions, i),
                                                              {normals[i][0], normals[i][1], normals[i][2]}))
            continue;
        const float parallel = std::fabs(dot_of(normals[i], normals[neighbours[e]]));
        classes[e] = static_cast<std::uint8_t>(
            std::find_if(least_parallel.begin(), least_parallel.end(), [&](float least) { return parallel >= least; }) -
            least_parallel.begin());
    }
    return classes;
}

}  // namespace

void JoinedNeighbours::resize(std::size_t points)
{
    numbers_.assign(points * most, no_number);
    first_.assign(points, no_number);
}

void JoinedNeighbours::set(std::uint32_t point, const std::uint32_t* numbers, const double* squared, std::size_t count)
{
    std::uint32_t* const mine = numbers_.data() + std::size_t(point) * most;
    std::size_t kept = 0;
    first_[point] = point;
    for (std::size_t j = 0; j < count && (kept < most || squared[j] == 0); ++j) {
        if (numbers[j] == no_number) continue;
        if (squared[j] == 0) first_[point] = std::min(first_[point], numbers[j]);
        if (kept < most) mine[kept++] = numbers[j];
    }
}

SidedSets::SidedSets(std::size_t count) : parent_(count), size_(count, 1), side_(count, 1)
{
    for (std::size_t i = 0; i < count; ++i) parent_[i] = static_cast<std::uint32_t>(i);
}

SidedSets::Found SidedSets::find(std::uint32_t number)
{
    std::uint32_t root = number;
    int side = 1;
    for (; parent_[root] != root; root = parent_[root]) side *= side_[root];
    // The way there becomes short.
    for (int left = side; parent_[number] != root && number != root;) {
        const std::uint32_t next = parent_[number];
        const int step = side_[number];
        parent_[number] = root;
        side_[number] = static_cast<std::int8_t>(left);
        left *= step;
        number = next;
    }
    return {root, side};
}

bool SidedSets::join(std::uint32_t a, std::uint32_t b, int side)
{
    Found x = find(a), y = find(b);
    if (x.set == y.set) return false;
    if (size_[x.set] < size_[y.set]) std::swap(x, y);
    parent_[y.set] = x.set;
    size_[x.set] += size_[y.set];
    side_[y.set] = static_cast<std::int8_t>(x.side * y.side * side);
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
    SidedSets sets(points);
    {
        if (std::find(two_surfaces.begin(), two_surfaces.end(), 1) != two_surfaces.end())
            two_surfaces = smoothed(neighbours, two_surfaces);
        const std::vector<std::uint8_t> classes = classes_of(positions, neighbours, normals, two_surfaces);
        for (std::uint8_t c = 0; c < least_parallel.size(); ++c)
            for (std::size_t e = 0; e < classes.size(); ++e) {
                if (classes[e] != c) continue;
                const std::size_t i = e / JoinedNeighbours::most;
                const bool turned = dot_of(normals[i], normals[neighbours[e]]) < 0;
                sets.join(static_cast<std::uint32_t>(i), neighbours[e], turned ? -1 : 1);
            }
    }
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
