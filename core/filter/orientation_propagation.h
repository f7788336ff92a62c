// Normals that point to the same side along each surface, for clouds larger than memory.
//
// 1. In each unit of the pass that computes normals, points are joined with their nearest neighbours in the unit along
//    a spanning tree that prefers parallel normals (orientation_pieces.h): pieces, consistent in themselves.
// 2. Points and their nearest neighbours in other units, which the pass has found, vote by the cosine of their normals
//    on whether their two pieces agree; pieces are joined along a spanning tree that prefers clear votes.
// 3. What is joined points outward or up: the more distinct of both, over all its points.
// 4. Normals of pieces that the others disagree with are turned around.
//
// What it guarantees: neighbours that the spanning trees join agree, across units too. That is the side that a person
// would name where surfaces are sampled densely compared with their curvature and their distance from each other. At
// folds of more than a right angle, in foliage, and between sheets nearer to each other than the points of one sheet it
// is a guess: sheets that are found (two_surfaces.h) are marked, and nothing is joined across their gap. A
// surface that nearly touches another in one place may still be turned around by it, all of it; only the points there
// are marked. Surfaces that no neighbours join are
// decided one by one. The result does not depend on the threads.
//
// Memory, in addition to that of the pass: some 60 bytes per point of a unit while it is joined, and some 100 bytes per
// piece. Scratch files of 8 bytes a point, and of 20 bytes for each border neighbour of at most 500 points of a piece,
// lie in the tree's folder; they have no names.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/filter/orientation_pieces.h"
#include "pcm/filter/value_file.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/threads/watch.h"

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

namespace pcm {

// A neighbour, in another unit, of a point of a unit.
struct BorderNeighbour {
    std::uint32_t point;  // number in the unit
    bool across;          // whether the neighbour lies across a gap rather than next to the point (two_surfaces.h)
    PointPlace other;     // the neighbour
    bool operator<(const BorderNeighbour& o) const { return point != o.point ? point < o.point : other < o.other; }
};

// What is known of a unit whose points are joined: step 1.
struct UnitOrientation {
    struct Piece {
        PieceSums sums;
        PointPlace first;  // its first point: makes the order of pieces independent of the threads
    };
    struct BorderPair {
        PointPlace own, other;
        bool across;  // BorderNeighbour::across
    };
    std::vector<Piece> pieces;
    std::vector<BorderPair> border;   // those that vote
    std::vector<std::int32_t> piece;  // 1 + number of each point's piece; 0: none; negative on two surfaces
};

// How many of a point's nearest neighbours, with those in its own unit, may be border neighbours.
inline constexpr std::size_t voting_neighbours = 8;

// Makes the normals of a unit consistent. `neighbours`: those of each point in the unit. `two_surfaces`: one per point,
// as join_pieces() takes and changes it. `border`: ascending.
UnitOrientation join_unit(const TreeInfo& info, const NeighbourhoodUnit& unit, const JoinedNeighbours& neighbours,
                          std::vector<std::array<float, 3>>& normals, std::vector<std::uint8_t>& two_surfaces,
                          const std::deque<BorderNeighbour>& border);

// Steps 2 to 4.
class OrientationPropagation {
public:
    // The scratch files are in `folder`. Throws what making them throws.
    OrientationPropagation(const Tree& tree, const std::filesystem::path& folder);

    // A unit's points, which `parts` name, are joined. Pieces are numbered in the order of the calls. Any number of
    // threads may call.
    void add(const std::vector<NeighbourhoodUnit::Part>& parts, const UnitOrientation& unit);

    // After the last unit, when the cache holds the normals of join_unit() at `place`: whether each piece is to be
    // turned around. Reports progress from `begin` to `end`. Throws Error(cancelled) and what reading chunks throws.
    std::vector<bool> decide(L2Cache& cache, std::size_t place, unsigned threads, Watch& watch, double begin,
                             double end) const;

    // The same, and turns their normals around in the cache. Returns how many normals.
    std::uint64_t finish(L2Cache& cache, std::size_t place, unsigned threads, Watch& watch, double begin, double end);

private:
    using Piece = UnitOrientation::Piece;
    using BorderPair = UnitOrientation::BorderPair;
    using Vote = SideVote;
    class VotingPoints;

    // One vote for each pair of pieces.
    static void add_up(std::vector<Vote>& votes);
    // Those of some border pairs; of all.
    std::vector<Vote> votes_of(L2Cache& cache, std::size_t place, std::uint64_t begin, std::uint64_t end) const;
    std::vector<Vote> collect_votes(L2Cache& cache, std::size_t place, unsigned threads, Watch& watch, double begin,
                                    double end) const;
    std::vector<bool> decide_by(std::vector<Vote> votes) const;

    std::mutex mutex_;  // guards the pieces and the number of pairs
    std::vector<Piece> pieces_;
    std::uint64_t pairs_ = 0;  // number of border pairs in the file
    ValueFile piece_of_;       // 1 + the number of each point's piece; 0: none; negative on two surfaces
    File border_;              // the border pairs, those of a unit together
};

}  // namespace pcm
