#include "pcm/filter/orientation_propagation.h"

#include "pcm/filter/search_positions.h"
#include "pcm/filter/two_surfaces.h"
#include "pcm/knn/point_search.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t voting_neighbours = 8;
// Maximum border points of a piece that look around. With 8000 as many neighbours disagree (indoors 0.206 %, in a
// forest 1.16 %), and joining takes twice as long.
constexpr std::size_t most_border_points = 500;
constexpr std::size_t points_of_a_run = 512;  // border points that one thread takes at a time
// In case that a unit meets others inside of its box, some points of its inside look around, too.
constexpr std::uint32_t inside_step = 4096;

Vec3i middle_of(const Box3i& box)
{
    Vec3i middle{};
    for (std::size_t a = 0; a < 3 && !box.empty(); ++a) middle[a] = box.min[a] / 2 + box.max[a] / 2;
    return middle;
}

// Border points of a unit that look around: of each piece all, or the maximum number, spread over its border points.
std::vector<std::uint32_t> spread_over_pieces(const std::vector<std::uint32_t>& border, const UnitPieces& pieces)
{
    std::vector<std::size_t> count(pieces.sums.size(), 0), seen(pieces.sums.size(), 0);
    for (const std::uint32_t number : border)
        if (pieces.piece[number] != no_piece) ++count[pieces.piece[number]];
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t number : border) {
        const std::uint32_t piece = pieces.piece[number];
        if (piece == no_piece) continue;
        const std::size_t step = (count[piece] + most_border_points - 1) / most_border_points;
        if (seen[piece]++ % step == 0) chosen.push_back(number);
    }
    return chosen;
}

}  // namespace

// Looks around border points, for one thread.
class OrientationPropagation::Voter {
public:
    Voter(L2Cache& cache, BlockCache& blocks, const ValueFile& pieces, std::size_t place)
        : cache_(cache), pieces_(pieces), place_(place), search_(cache, blocks)
    {
        columns_.attributes.set(place);
    }

    void look_around(const Place& p, std::vector<Vote>& votes)
    {
        const Held& own = held(p.node);
        const std::uint32_t piece = own.piece(p.index);
        if (piece == no_piece) return;
        const bool of_two = own.on_two_surfaces(p.index);
        const Vec3d normal = own.normal(place_, p.index);
        const Vec3d place = cache_.tree().info().grid.to_source(own.chunk->positions->grid(p.index));
        search_.run(place, voting_neighbours + 1, found_);
        for (const Neighbour& f : found_) {
            const Held& other = held(f.node);
            const std::uint32_t neighbour = other.piece(f.index);
            if (neighbour == piece || neighbour == no_piece) continue;
            if ((of_two || other.on_two_surfaces(f.index)) && is_across(f.position - place, normal)) continue;
            const double cosine = dot(normal, other.normal(place_, f.index));
            votes.push_back({std::min(piece, neighbour), std::max(piece, neighbour),
                             static_cast<std::int64_t>(std::lround(1000 * cosine))});
        }
    }

private:
    struct Held {
        NodeId node = no_node;
        L2Cache::Handle chunk;
        std::vector<double> pieces;

        std::uint32_t piece(std::uint32_t index) const
        {
            return pieces[index] == 0 ? no_piece : static_cast<std::uint32_t>(std::fabs(pieces[index])) - 1;
        }
        bool on_two_surfaces(std::uint32_t index) const { return pieces[index] < 0; }
        Vec3d normal(std::size_t place, std::uint32_t index) const
        {
            const float* n = chunk->attributes[place]->as<float>() + std::size_t(3) * index;
            return {n[0], n[1], n[2]};
        }
    };

    const Held& held(NodeId node)
    {
        Held& slot = held_[node % held_.size()];
        if (slot.node != node) slot = {node, cache_.get(node, columns_), pieces_.get(node)};
        return slot;
    }

    L2Cache& cache_;
    const ValueFile& pieces_;
    const std::size_t place_;
    PointSearch search_;
    ColumnSet columns_;
    std::array<Held, 16> held_;
    std::vector<Neighbour> found_;
};

OrientationPropagation::OrientationPropagation(const Tree& tree)
    : grid_(tree.info().grid), origin_(middle_of(tree.info().box)), piece_of_(tree, tree.folder())
{
}

UnitPieces OrientationPropagation::join(const NeighbourhoodUnit& unit, const JoinedNeighbours& neighbours,
                                        std::vector<std::array<float, 3>>& normals,
                                        std::vector<std::uint8_t>& two_surfaces) const
{
    UnitPositions positions = positions_of(unit, grid_);
    Vec3d origin;
    for (std::size_t a = 0; a < 3; ++a)
        origin[a] = static_cast<double>(positions.origin[a] - origin_[a]) * grid_.scale[a];
    return join_pieces(positions.steps, neighbours, origin, normals, two_surfaces);
}

void OrientationPropagation::add_unit(const NeighbourhoodUnit& unit, const JoinedNeighbours& neighbours,
                                      std::vector<std::array<float, 3>>& normals,
                                      std::vector<std::uint8_t>& two_surfaces, const std::vector<std::uint32_t>& border)
{
    if (unit.points == 0) return;
    const UnitPieces pieces = join(unit, neighbours, normals, two_surfaces);
    const auto place_of = [&](std::uint32_t number) { return Place{unit.part_of(number).node, unit.index_of(number)}; };
    std::vector<Piece> added(pieces.sums.size());
    for (std::size_t i = 0; i < added.size(); ++i) added[i] = {pieces.sums[i], {no_node, 0}};
    for (const NeighbourhoodUnit::Part& part : unit.parts)
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::uint32_t piece = pieces.piece[part.first + i];
            if (piece != no_piece) added[piece].first = std::min(added[piece].first, Place{part.node, part.indices[i]});
        }
    std::vector<Place> looking;
    for (const std::uint32_t number : spread_over_pieces(border, pieces)) looking.push_back(place_of(number));
    for (std::uint32_t n = 0; n < unit.points; n += inside_step) looking.push_back(place_of(n));
    std::size_t first;
    {
        const std::lock_guard lock(mutex_);
        first = pieces_.size();
        pieces_.insert(pieces_.end(), added.begin(), added.end());
        border_.insert(border_.end(), looking.begin(), looking.end());
    }
    std::vector<double> numbers;
    for (const NeighbourhoodUnit::Part& part : unit.parts) {
        numbers.clear();
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::uint32_t piece = pieces.piece[part.first + i];
            const double number = piece == no_piece ? 0 : static_cast<double>(first + piece + 1);
            numbers.push_back(two_surfaces[part.first + i] ? -number : number);
        }
        piece_of_.set(part.node, part.indices, numbers.data());
    }
}

std::vector<OrientationPropagation::Vote> OrientationPropagation::collect_votes(L2Cache& cache, std::size_t place,
                                                                                std::uint64_t memory_bytes,
                                                                                unsigned threads, Watch& watch,
                                                                                double begin, double end) const
{
    BlockCache blocks(block_share(memory_bytes));
    std::mutex mutex;
    std::vector<Vote> votes;
    const std::size_t runs = (border_.size() + points_of_a_run - 1) / points_of_a_run;
    for_each_index(
        runs, threads,
        [&](std::size_t run) {
            Voter voter(cache, blocks, piece_of_, place);
            std::vector<Vote> mine;
            for (std::size_t i = run * points_of_a_run; i < std::min(border_.size(), (run + 1) * points_of_a_run); ++i)
                voter.look_around(border_[i], mine);
            add_up(mine);
            const std::lock_guard lock(mutex);
            votes.insert(votes.end(), mine.begin(), mine.end());
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

std::vector<bool> OrientationPropagation::decide(std::vector<Vote> votes) const
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

std::uint64_t OrientationPropagation::finish(L2Cache& cache, std::size_t place, std::uint64_t memory_bytes,
                                             unsigned threads, Watch& watch, double begin, double end)
{
    threads = thread_count(threads);
    std::sort(border_.begin(), border_.end());
    const double middle = 0.5 * (begin + end);
    const std::vector<bool> flips = decide(collect_votes(cache, place, memory_bytes, threads, watch, begin, middle));
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
