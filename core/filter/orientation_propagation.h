// Normals that point to the same side along each surface, for clouds larger than memory.
//
// 1. In each unit of the pass that computes normals, points are joined with their nearest neighbours in the unit along
//    a spanning tree that prefers parallel normals (orientation_pieces.h): pieces, consistent in themselves.
// 2. Around points at the borders of units neighbours are searched in the whole cloud. Pairs of points in different
//    pieces vote, by the cosine of their normals, on whether the two pieces agree; pieces are joined along a spanning
//    tree that prefers clear votes.
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
// Memory, in addition to that of the pass: some 60 bytes per point of a unit while it is joined, 16 bytes per border
// point, and some 100 bytes per piece. A scratch file of 8 bytes a point lies in the tree's folder; it has no name.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/filter/orientation_pieces.h"
#include "pcm/filter/value_file.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/threads/watch.h"

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

namespace pcm {

class OrientationPropagation {
public:
    // Throws what making the scratch file throws.
    explicit OrientationPropagation(const Tree& tree);

    // A unit whose normals are computed; makes them consistent, and at a level sets those of points that take the
    // values of others. `neighbours`: those of each point in the unit. `two_surfaces`: one per point, as join_pieces()
    // takes and changes it. `border`: points, by number, ascending, with neighbours outside of the unit. Any number of
    // threads may call.
    void add_unit(const NeighbourhoodUnit& unit, const JoinedNeighbours& neighbours,
                  std::vector<std::array<float, 3>>& normals, std::vector<std::uint8_t>& two_surfaces,
                  const std::vector<std::uint32_t>& border);

    // After the last unit, when the cache holds the normals of add_unit() at `place`: turns those around that the
    // pieces' neighbours disagree with. Returns how many. `memory_bytes`: the filter's limit. Reports progress from
    // `begin` to `end`. Throws Error(cancelled) and what reading and editing chunks throws.
    std::uint64_t finish(L2Cache& cache, std::size_t place, std::uint64_t memory_bytes, unsigned threads, Watch& watch,
                         double begin, double end);

private:
    struct Place {
        NodeId node;
        std::uint32_t index;
        bool operator<(const Place& o) const { return node != o.node ? node < o.node : index < o.index; }
    };
    struct Piece {
        PieceSums sums;
        Place first;  // place of its first point: makes the order of pieces independent of the threads
    };
    using Vote = SideVote;
    class Voter;

    UnitPieces join(const NeighbourhoodUnit& unit, const JoinedNeighbours& neighbours,
                    std::vector<std::array<float, 3>>& normals, std::vector<std::uint8_t>& two_surfaces) const;
    // One vote for each pair of pieces.
    static void add_up(std::vector<Vote>& votes);
    std::vector<Vote> collect_votes(L2Cache& cache, std::size_t place, std::uint64_t memory_bytes, unsigned threads,
                                    Watch& watch, double begin, double end) const;
    // Whether each piece is to be turned around.
    std::vector<bool> decide(std::vector<Vote> votes) const;

    const Grid grid_;
    const Vec3i origin_;  // origin of the sums
    std::mutex mutex_;    // guards the pieces and the border
    std::vector<Piece> pieces_;
    std::vector<Place> border_;
    ValueFile piece_of_;  // 1 + the number of each point's piece; 0: none; negative on two surfaces
};

}  // namespace pcm
