// Any cloud in, any format out: what `pcmlab convert` and the export of MeshLab call.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/io/reader.h"
#include "pcm/cloud/selection.h"
#include "pcm/io/writer.h"
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
    std::optional<std::uint16_t> level;       // of trees: the cloud at this level; the whole cloud when absent
    std::optional<std::uint64_t> max_points;  // of one tree: its deepest level with at most so many points
    Selection selection;
    ReadOptions read{0, {}};
};

// Files, trees, and folders of files as one cloud, of it what the options select. Trees are read only where the box is.
// Throws what readers, Tree::open and Selector throw, and Error(invalid_argument) for levels of what is not a tree.
std::unique_ptr<PointReader> open_cloud(const std::vector<std::filesystem::path>& inputs,
                                        const CloudOptions& options = {});

struct ConvertOptions {
    CloudOptions cloud;
    WriteOptions write{{}, {}, false, 0};
    // LAS and LAZ, beside write.grid: a grid of this step with an offset that suits the cloud.
    std::optional<Vec3d> scale;
    // Trees.
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;
    std::uint32_t chunk_points = default_chunk_points;
    unsigned threads = 0;  // of a build; 0: one a processor

    bool overwrite = false;  // replace the output if it is there; never an input
    ProgressFunction progress;
};

struct ConvertReport {
    Outcome outcome;                   // points selected and written; error: largest position error, source units
    std::uint64_t points_skipped = 0;  // selected, but without a finite position where the format needs one
    std::uint64_t bytes = 0;           // of the output
    std::optional<Grid> grid;          // chosen for a cloud of doubles
    std::vector<std::string> notes;    // of the readers and the writer
};

// The output's extension says the format: "pct" builds a tree, others are written by create_writer(). For LAS and LAZ
// out of doubles the input is read twice, first to find a grid on which all positions are exact, if there is one. The
// output appears under its name when it is whole; on an error or a cancel nothing is left of it. Throws Error(exists)
// when the output is there and is not to be overwritten, Error(invalid_argument) when it is one of the inputs or an
// option has no meaning for its format, Error(unsupported) for an unknown extension, Error(cancelled), and what
// readers, writers and build_tree throw.
ConvertReport convert(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                      const ConvertOptions& options = {});

// The same of any cloud into a file: `open` gives it from its beginning, each time it is called, with what is selected
// of it. A file that has the name is replaced. Of the options those of `cloud` and of trees have no meaning here.
ConvertReport write_cloud(const std::function<std::unique_ptr<PointReader>()>& open,
                          const std::filesystem::path& output, const ConvertOptions& options = {});

}  // namespace pcm
