// Reads clouds of any format and writes one of any format: `pcmlab convert` and the export in MeshLab.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/io/reader.h"
#include "pcm/io/writer.h"
#include "pcm/system/progress.h"
#include "pcm/tree/chunk_size.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct CloudOptions {
    std::optional<std::uint16_t> level;       // the level to read of trees; the whole cloud when absent
    std::optional<std::uint64_t> max_points;  // read the deepest level of the one tree with at most this many points
    Selection selection;
    ReadOptions read{0, {}};
};

// The selected points of files, trees and folders (expand_inputs()), as one cloud. Trees are read only where the box
// is. A file of a tree (index.pct, chunks-000.bpc) stands for the tree; a tree that is named twice is read once. Throws
// what readers, Tree::open and Selector throw, and Error(invalid_argument) for a level of an input that is not a tree.
std::unique_ptr<PointReader> open_cloud(const std::vector<std::filesystem::path>& inputs,
                                        const CloudOptions& options = {});

inline WriteOptions on_all_processors()
{
    WriteOptions options;
    options.threads = 0;
    return options;
}

struct ConvertOptions {
    CloudOptions cloud;
    WriteOptions write = on_all_processors();
    // LAS and LAZ, instead of write.grid: a grid of this step with an offset chosen for the cloud.
    std::optional<Vec3d> scale;
    // Trees.
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;
    std::uint32_t chunk_points = default_chunk_points;
    unsigned threads = 0;  // threads of a build; 0: one per processor

    bool overwrite = false;  // replace an existing output; never an input
    ProgressFunction progress;
};

struct ConvertReport {
    Outcome outcome;  // points selected and written; error: largest position error, source units
    // Selected, but dropped: the format needs finite positions, or they are beyond ReadOptions::largest_coordinate.
    std::uint64_t points_skipped = 0;
    Skipped skipped;                 // bad lines and files
    std::uint64_t bytes = 0;         // size of the output
    std::optional<Grid> grid;        // chosen for a cloud of doubles
    std::vector<std::string> notes;  // notes of the readers and the writer
};

// The output's extension chooses the format: "pct" builds a tree, others are written by create_writer(). When doubles
// are written as LAS or LAZ, the input is read twice, first to find a grid on which all positions are exact, if one
// exists. It is read twice, too, where the values decide what is written, until that is decided: whether 8 bits hold
// all colours, for PLY and PCD, for example (Format::questions). The output appears atomically under its name; an error
// or a cancel leaves nothing behind, and what fails after that is a warning of the outcome. Throws Error(exists) when
// the output exists and is not to be overwritten, Error(invalid_argument) when it is one of the inputs, an option has
// no meaning for its format, or the selection takes no point of a cloud that has some, what output_file() and
// output_tree() throw (system/output_path.h), Error(unsupported) for an unknown extension, Error(cancelled), and what
// readers, writers and build_tree throw.
ConvertReport convert(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                      const ConvertOptions& options = {});

// The same, with the inputs' points read through another reader, which gets that of the inputs and gives its points, or
// what was known of them before.
using ReadThrough = std::function<std::unique_ptr<PointReader>(std::unique_ptr<PointReader> inputs)>;
ConvertReport convert(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                      const ConvertOptions& options, const ReadThrough& through);
// Throws what convert() throws before it reads points.
void check_conversion(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                      const ConvertOptions& options);

// Writes any cloud to a file: each call of `open` returns a reader at the beginning of the (already selected) cloud. An
// existing file is replaced. It is called twice where convert() reads twice. The options `cloud` and those of trees
// have no meaning here.
ConvertReport write_cloud(const std::function<std::unique_ptr<PointReader>()>& open,
                          const std::filesystem::path& output, const ConvertOptions& options = {});

}  // namespace pcm
