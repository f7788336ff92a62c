// Several trees as one.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/cloud/affine.h"
#include "pcm/filter/result_tree.h"
#include "pcm/io/reader.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct MergeInput {
    std::filesystem::path tree;
    std::optional<Affine> map;  // where the tree is moved to, turned or scaled: io/pipe/transformed_reader.h
};

struct MergeOptions {
    bool ignore_crs = false;  // coordinate systems and GPS times that differ: note them, do not refuse
    bool source_id = false;   // add an attribute `source_id`: the number of the tree a point is from, from 1
    unsigned threads = 0;     // threads that read ahead; 0: one per processor
};

inline constexpr const char* source_id_name = "source_id";

// What the merged cloud is.
//
// Positions: where all trees are on one grid, integers on that grid. Where the grids fit together (filter/
// common_grid.h), integers on the finest of them: the same positions but for the rounding of q * scale + offset in
// double. Else doubles, exactly those of the trees. A tree that is turned has doubles.
//
// Attributes: those of all trees, by name; a tree that lacks one has 0 there. Different types of one name become one
// that holds them all (filter/common_schema.h).
//
// Metadata: those of all, without repetitions; the coordinate system is that of the first tree that states one. Trees
// of different coordinate systems, units or GPS times are refused (io/pipe/system_check.h), unless the difference is to
// be ignored.
//
// All of this is reported by the notes of the reader's info() and by the members here.
struct MergedTrees {
    std::unique_ptr<PointReader> points;  // one thread
    std::vector<std::string> names;       // names of the trees: of `source_id` 1, 2, ...
    std::optional<Grid> grid;             // common grid of integers
    // Maximum change of a coordinate so far by another grid, source units.
    std::shared_ptr<const double> rounding;
};

// Throws Error(invalid_argument) without inputs, and for systems that differ, naming both trees; what Tree::open and
// TransformedReader throw. A tree that is named twice at the same place is read once; a note reports that.
MergedTrees open_merged(const std::vector<MergeInput>& inputs, const MergeOptions& options = {});

struct MergeReport {
    BuildReport build;
    std::optional<Grid> grid;  // grid of integers; doubles when absent
    double rounding = 0;  // maximum change of a coordinate by another grid, or of doubles by the tree's; source units
    std::vector<std::string> trees;
    std::string system;  // the coordinate system of the result; empty: none is stated
};

// Merges into the new tree `result.target.copy`, which cannot be one of the inputs. `options.threads` has no meaning
// here. Throws what open_merged() and build_tree() throw, and Error(invalid_argument) for a result in place.
MergeReport merge_trees(const std::vector<MergeInput>& inputs, const MergeOptions& options,
                        const ResultOptions& result);

}  // namespace pcm
