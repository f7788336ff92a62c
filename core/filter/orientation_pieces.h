// Points whose normals are joined to point to the same side of a surface.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/knn/unit_search.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Sets of numbers that are joined two by two, each with a side: +1, or -1 where it is turned around relative to its
// set.
class SidedSets {
public:
    explicit SidedSets(std::size_t count);
    struct Found {
        std::uint32_t set;  // one of its numbers
        int side;           // side of the number, relative to that one
    };
    Found find(std::uint32_t number);
    // Joins the sets of two numbers, so that `side` is that of one number relative to the other. Returns whether they
    // were in different sets; joined numbers are not changed.
    bool join(std::uint32_t a, std::uint32_t b, int side);

private:
    struct Number {
        std::uint32_t parent, size;
        std::int8_t side;  // relative to the parent
    };
    std::vector<Number> numbers_;
};

// Whether two sets agree: positive where neighbours in them point to one side, negative where they point to opposite
// sides.
struct SideVote {
    std::uint32_t a, b;  // numbers of the sets, a < b
    std::int64_t sum;    // sum of cosines, in thousandths
};

// Joins sets along a spanning tree that prefers clear votes, of either sign; among equally clear ones those of the
// lower numbers. The order of the votes makes no difference where each pair has one.
void join_by_votes(SidedSets& sets, std::vector<SideVote> votes);

// What decides the side of a whole piece: sums over its points, whose positions p are relative to one origin.
struct PieceSums {
    double count = 0, squares = 0, flux = 0;  // 1, p . p, n . p
    Vec3d positions{}, normals{};
    void add(const Vec3d& p, const Vec3d& n);
    void join(const PieceSums& other, int side);
    // Positive where the normals point outward or up, negative where they point inward or down: the more distinct of
    // the mean height of the normals and the mean of n . (p - centre) over the distance from the centre. Where neither
    // says anything, the sign of the first coordinate of the sum of normals that is not 0.
    double outward_or_up() const;
};

inline constexpr std::uint32_t no_piece = 0xffffffffu;

struct UnitPieces {
    std::vector<std::uint32_t> piece;  // piece of each point; no_piece where its normal is 0
    std::vector<PieceSums> sums;       // sums of each piece
};

// For each point of a unit its nearest neighbours in the unit. Points at one place have the same normals, and which of
// them a search lists is chance: the first of them stands for all.
class JoinedNeighbours {
public:
    static constexpr std::size_t most = 6;
    static constexpr std::uint32_t none = 0xffffffffu;

    void resize(std::size_t points);
    // Sets those of a point, out of its nearest neighbours, nearest first: their numbers, which are those of other
    // units from the number of points on, and squared distances.
    void set(std::uint32_t point, const std::uint32_t* numbers, const double* squared, std::size_t count);
    std::size_t size() const { return numbers_.size(); }
    // The neighbour number e % most of the point e / most; none where there are fewer.
    std::uint32_t operator[](std::size_t e) const
    {
        return shares_places_ && numbers_[e] != none ? first_[numbers_[e]] : numbers_[e];
    }
    // Whether a point has a neighbour; false also where points lie at one place.
    bool surely_lists(std::uint32_t point, std::uint32_t neighbour) const
    {
        if (shares_places_) return false;
        unsigned found = 0;
        for (std::size_t j = 0; j < most; ++j) found |= numbers_[std::size_t(point) * most + j] == neighbour;
        return found != 0;
    }

private:
    std::vector<std::uint32_t> numbers_;
    std::vector<std::uint32_t> first_;  // for each point the lowest number of those at its place
    bool shares_places_ = false;        // whether any two points lie at one place
};

// Joins the points of a unit with their nearest neighbours in the unit, pairs with nearly parallel normals first (a
// spanning tree of 1 - |ni . nj|, Hoppe et al. 1992, by classes of that weight), and turns normals around so that each
// piece is consistent, and points outward or up by itself. `origin` of the sums: in source units relative to that of
// `positions`.
//
// `two_surfaces` (for each point, 0 or 1): whether its neighbours lie on two surfaces (two_surfaces.h). It is made
// smooth: each point takes what most of its nearest neighbours and itself have. From such a point to one across the
// gap, which has almost the same normal but may be on the other side of a plate, nothing is joined.
UnitPieces join_pieces(const SearchPositions& positions, const JoinedNeighbours& neighbours, const Vec3d& origin,
                       std::vector<std::array<float, 3>>& normals, std::vector<std::uint8_t>& two_surfaces);

}  // namespace pcm
