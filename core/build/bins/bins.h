// What the first stage of a build leaves: the rows of a cloud in bins on disk, and what was found while reading it.
#pragma once

#include "pcm/build/bins/observed.h"
#include "pcm/build/bins/row.h"
#include "pcm/build/bins/scratch.h"
#include "pcm/build/bins/top_tree.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/metadata.h"
#include "pcm/io/reader.h"
#include "pcm/tree/source_rounding.h"

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace pcm {

inline constexpr const char* scratch_file_name = "scratch.tmp";

// The rows, and the cuts between the bins.
template <class Coord>
struct Bins {
    TopTree<Coord> top;
    std::shared_ptr<Scratch> scratch;
};
using AnyBins = std::variant<Bins<std::uint32_t>, Bins<std::uint64_t>>;

struct Ingested {
    Schema schema;
    Grid grid;
    RowLayout layout;
    ScalarType position_type = ScalarType::f64;  // type in the source
    Observed observed;
    std::uint64_t points_in = 0, points_skipped = 0;  // skipped: without a finite position
    Skipped skipped;                                  // bad lines and files
    // For readers of the tree to round to, where the grid does not hold all bits of the positions.
    DecimalPlaces decimals{no_decimals, no_decimals, no_decimals};
    std::vector<Metadata> metadata;
    std::vector<std::string> notes;
};

}  // namespace pcm
