#include "pcm/filter/orientation_propagation.h"

#include "pcm/filter/scratch_file.h"
#include "pcm/filter/search_positions.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

// Maximum border points of a piece whose neighbours vote. With 8000 as many neighbours disagree (indoors 0.206 %, in a
// forest 1.16 %).
constexpr std::size_t most_border_points = 500;
constexpr std::uint64_t neighbours_of_a_run = 8192;  // border neighbours that one thread takes at a time

Vec3i middle_of(const Box3i& box)
{
    Vec3i middle{};
    for (std::size_t a = 0; a < 3 && !box.empty(); ++a) middle[a] = box.min[a] / 2 + box.max[a] / 2;
    return middle;
}

// Border neighbours of a unit that vote: of each piece those of all its border points, or of the maximum number, spread
// over them. `border` is ascending.
std::vector<BorderNeighbour> spread_over_pieces(const std::deque<BorderNeighbour>& border, const UnitPieces& pieces)
{
    std::vector<std::size_t> count(pieces.sums.size(), 0), seen(pieces.sums.size(), 0);
    const auto for_each_point = [&](const auto& f) {
        for (std::size_t i = 0, end; i < border.size(); i = end) {
            for (end = i + 1; end < border.size() && border[end].point == border[i].point;) ++end;
            const std::uint32_t piece = pieces.piece[border[i].point];
            if (piece != no_piece) f(piece, i, end);
        }
    };
    for_each_point([&](std::uint32_t piece, std::size_t, std::size_t) { ++count[piece]; });
    std::vector<BorderNeighbour> chosen;
    for_each_point([&](std::uint32_t piece, std::size_t begin, std::size_t end) {
        const std::size_t step = (count[piece] + most_border_points - 1) / most_border_points;
        if (seen[piece]++ % step != 0) return;
        for (; begin < end; ++begin) chosen.push_back(border[begin]);
    });
    return chosen;
}

}  // namespace

// What the votes of some points depend on, read node by node.
class OrientationPropagation::VotingPoints {
public:
    struct Point {
        std::uint32_t piece = no_piece;
        bool on_two_surfaces = false;
        Vec3d normal{};
    };

    // `normals`: the place of normals in the schema.
    VotingPoints(L2Cache& cache, const ValueFile& pieces, std::size_t normals, std::vector<PointPlace> places)
        : places_(std::move(places))
    {
        std::sort(places_.begin(), places_.end());
        places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
        ColumnSet columns;
        columns.positions = false;
        columns.attributes.set(normals);
        NodeId node = no_node;
        L2Cache::Handle chunk;
        std::vector<double> piece;
        for (const PointPlace& place : places_) {
            if (place.node != node) {
                node = place.node;
                chunk = cache.get(node, columns);
                piece = pieces.get(node);
            }
            const double value = piece[place.index];
            const float* const n = chunk->attributes[normals]->as<float>() + std::size_t(3) * place.index;
            points_.push_back({value == 0 ? no_piece : static_cast<std::uint32_t>(std::fabs(value)) - 1,
                               value < 0,
                               {n[0], n[1], n[2]}});
        }
    }
    const Point& operator[](const PointPlace& place) const
    {
        const auto found = std::lower_bound(places_.begin(), places_.end(), place);
        return points_[static_cast<std::size_t>(found - places_.begin())];
    }

private:
    std::vector<PointPlace> places_;
    std::vector<Point> points_;
};

UnitOrientation join_unit(const TreeInfo& info, const NeighbourhoodUnit& unit, const JoinedNeighbours& neighbours,
                          std::vector<std::array<float, 3>>& normals, std::vector<std::uint8_t>& two_surfaces,
                          const std::deque<BorderNeighbour>& border)
{
    UnitOrientation joined;
    if (unit.points == 0) return joined;
    UnitPositions positions = positions_of(unit, info.grid);
    const Vec3i middle = middle_of(info.box);  // origin of the sums
    Vec3d origin;
    for (std::size_t a = 0; a < 3; ++a)
        origin[a] = static_cast<double>(positions.origin[a] - middle[a]) * info.grid.scale[a];
    const UnitPieces pieces = join_pieces(positions.steps, neighbours, origin, normals, two_surfaces);
    for (const PieceSums& sums : pieces.sums) joined.pieces.push_back({sums, {no_node, 0}});
    for (const NeighbourhoodUnit::Part& part : unit.parts)
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::uint32_t piece = pieces.piece[part.first + i];
            if (piece == no_piece) continue;
            PointPlace& first = joined.pieces[piece].first;
            first = std::min(first, PointPlace{part.node, part.indices[i]});
        }
    for (const BorderNeighbour& found : spread_over_pieces(border, pieces))
        joined.border.push_back({unit.place_of(found.point), found.other, found.across});
    joined.piece.resize(unit.points);
    for (std::uint32_t n = 0; n < unit.points; ++n) {
        const auto number = static_cast<std::int32_t>(pieces.piece[n] == no_piece ? 0 : pieces.piece[n] + 1);
        joined.piece[n] = two_surfaces[n] ? -number : number;
    }
    return joined;
}

OrientationPropagation::OrientationPropagation(const Tree& tree, const std::filesystem::path& folder)
    : piece_of_(tree, folder), border_(scratch_file(folder))
{
}

void OrientationPropagation::add(const std::vector<NeighbourhoodUnit::Part>& parts, const UnitOrientation& unit)
{
    double first;
    std::uint64_t first_pair;
    {
        const std::lock_guard lock(mutex_);
        first = static_cast<double>(pieces_.size());
        pieces_.insert(pieces_.end(), unit.pieces.begin(), unit.pieces.end());
        first_pair = pairs_;
        pairs_ += unit.border.size();
    }
    border_.write_at(unit.border.data(), unit.border.size() * sizeof(BorderPair), first_pair * sizeof(BorderPair));
    std::vector<double> numbers;
    for (const NeighbourhoodUnit::Part& part : parts) {
        numbers.clear();
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::int32_t piece = unit.piece[part.first + i];
            numbers.push_back(piece + (piece > 0 ? first : piece < 0 ? -first : 0));
        }
        piece_of_.set(part.node, part.indices, numbers.data());
    }
}

std::vector<OrientationPropagation::Vote> OrientationPropagation::votes_of(L2Cache& cache, std::size_t place,
                                                                           std::uint64_t begin, std::uint64_t end) const
{
    std::vector<BorderPair> pairs(static_cast<std::size_t>(end - begin));
    border_.read_at(pairs.data(), pairs.size() * sizeof(BorderPair), begin * sizeof(BorderPair));
    std::vector<PointPlace> places;
    for (const BorderPair& pair : pairs) {
        places.push_back(pair.own);
        places.push_back(pair.other);
    }
    const VotingPoints points(cache, piece_of_, place, std::move(places));
    std::vector<Vote> votes;
    for (const BorderPair& pair : pairs) {
        const VotingPoints::Point &own = points[pair.own], &other = points[pair.other];
        if (own.piece == no_piece || other.piece == no_piece) continue;
        if (pair.across && (own.on_two_surfaces || other.on_two_surfaces)) continue;
        votes.push_back({std::min(own.piece, other.piece), std::max(own.piece, other.piece),
                         static_cast<std::int64_t>(std::lround(1000 * dot(own.normal, other.normal)))});
    }
    add_up(votes);
    return votes;
}

std::vector<OrientationPropagation::Vote> OrientationPropagation::collect_votes(L2Cache& cache, std::size_t place,
                                                                                unsigned threads, Watch& watch,
                                                                                double begin, double end) const
{
    std::mutex mutex;
    std::vector<Vote> votes;
    const auto runs = static_cast<std::size_t>((pairs_ + neighbours_of_a_run - 1) / neighbours_of_a_run);
    for_each_index(
        runs, threads,
        [&](std::size_t run) {
            const std::uint64_t first = run * neighbours_of_a_run;
            const std::vector<Vote> some = votes_of(cache, place, first, std::min(pairs_, first + neighbours_of_a_run));
            const std::lock_guard lock(mutex);
            votes.insert(votes.end(), some.begin(), some.end());
        },
        [&](std::size_t done) {
            watch.report("Orienting normals", begin + (end - begin) * static_cast<double>(done) /
                                                          static_cast<double>(std::max<std::size_t>(1, runs)));
        });
    add_up(votes);
    return votes;
}

void OrientationPropagation::add_up(std::vector<Vote>& votes)
{
    std::sort(votes.begin(), votes.end(),
              [](const Vote& x, const Vote& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
    std::size_t kept = 0;
    for (const Vote& vote : votes) {
        if (kept > 0 && votes[kept - 1].a == vote.a && votes[kept - 1].b == vote.b)
            votes[kept - 1].sum += vote.sum;
        else
            votes[kept++] = vote;
    }
    votes.resize(kept);
}

std::vector<bool> OrientationPropagation::decide_by(std::vector<Vote> votes) const
{
    // By first points: the numbers of pieces depend on the threads.
    std::vector<std::uint32_t> order(pieces_.size()), rank(pieces_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return pieces_[a].first < pieces_[b].first; });
    for (std::uint32_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
    for (Vote& vote : votes) {
        const auto [a, b] = std::minmax(rank[vote.a], rank[vote.b]);
        vote = {a, b, vote.sum};
    }
    SidedSets sets(pieces_.size());
    join_by_votes(sets, std::move(votes));
    std::vector<PieceSums> sums(pieces_.size());
    for (std::uint32_t r = 0; r < order.size(); ++r) {
        const SidedSets::Found found = sets.find(r);
        sums[found.set].join(pieces_[order[r]].sums, found.side);
    }
    std::vector<bool> flips(pieces_.size());
    for (std::uint32_t r = 0; r < order.size(); ++r) {
        const SidedSets::Found found = sets.find(r);
        flips[order[r]] = found.side * sums[found.set].outward_or_up() < 0;
    }
    return flips;
}

std::vector<bool> OrientationPropagation::decide(L2Cache& cache, std::size_t place, unsigned threads, Watch& watch,
                                                 double begin, double end) const
{
    return decide_by(collect_votes(cache, place, thread_count(threads), watch, begin, end));
}

std::uint64_t OrientationPropagation::finish(L2Cache& cache, std::size_t place, unsigned threads, Watch& watch,
                                             double begin, double end)
{
    threads = thread_count(threads);
    const double middle = 0.5 * (begin + end);
    const std::vector<bool> flips = decide(cache, place, threads, watch, begin, middle);
    if (std::find(flips.begin(), flips.end(), true) == flips.end()) return 0;
    ColumnSet columns;
    columns.positions = false;
    columns.attributes.set(place);
    std::atomic<std::uint64_t> flipped{0};
    const std::size_t nodes = cache.tree().nodes().size();
    for_each_index(
        nodes, threads,
        [&](std::size_t n) {
            const auto node = static_cast<NodeId>(n);
            const std::vector<double> pieces = piece_of_.get(node);
            const auto is_flipped = [&](double piece) {
                return piece != 0 && flips[static_cast<std::size_t>(std::fabs(piece)) - 1];
            };
            if (std::none_of(pieces.begin(), pieces.end(), is_flipped)) return;
            L2Cache::Edit edit = cache.edit(node, columns);
            float* const normals = edit.column(place).as<float>();
            for (std::size_t i = 0; i < pieces.size(); ++i) {
                if (!is_flipped(pieces[i])) continue;
                for (std::size_t a = 0; a < 3; ++a) normals[3 * i + a] = -normals[3 * i + a];
                ++flipped;
            }
            edit.mark_written();
        },
        [&](std::size_t done) {
            watch.report("Orienting normals",
                         middle + (end - middle) * static_cast<double>(done) / static_cast<double>(nodes));
        });
    return flipped;
}

}  // namespace pcm
