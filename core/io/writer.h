// Writers turn batches of points into a file, in bounded memory: the counterpart of reader.h.
//
// Each format has a folder: las/, ply/, ...; formats.h is the table of them. create_writer() chooses by the extension.
#pragma once

#include "pcm/io/reader.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct Survey;

struct WriteOptions {
    // LAS and LAZ: the grid to write on; the source's own when absent. A source of doubles needs one: choose_grid()
    // finds the coarsest grid on which all of its points are exact.
    std::optional<Grid> grid;
    // Text: decimals of a coordinate. When absent, the fewest that read back as the same double.
    std::optional<unsigned> decimals;
    bool ascii = false;    // PLY and PCD: text instead of binary
    unsigned threads = 1;  // maximum number of encoding threads, where a format has them; 0: one per processor

    // LAS and LAZ: the minor version, 0 to 4. When absent, the source's, or the lowest that holds everything.
    std::optional<unsigned> las_version;
    // PLY and PCD: colours of 8 bits, rounded if need be, or as the cloud has them with 16. When absent, 8 bits for
    // other programs, and next to them the exact ones where 8 bits do not hold them.
    std::optional<unsigned> colour_bits;
    // PCD: positions as floats relative to a whole-numbered shift, in VIEWPOINT.
    bool float_positions = false;
    // What is known of the cloud's values: the answers to what the format asks (Format::questions). Without it, a
    // writer assumes the worst.
    std::shared_ptr<const Survey> survey;
};

// One thread. The file appears under its name only when finish() returns; until then the destructor leaves nothing
// behind.
class PointWriter {
public:
    virtual ~PointWriter() = default;

    // A batch of the shape given to create_writer(). Throws Error(no_space | io | invalid_argument); after that
    // the writer can only be destroyed.
    virtual void write(const PointBatch& batch) = 0;
    // Completes the header, syncs, renames. Nothing may be written afterwards. Throws an Error that is_done() when the
    // file is complete and in place, but may not survive a loss of power.
    virtual void finish() = 0;

    // Maximum difference between a written and a source coordinate, in source units; 0 when all digits were kept.
    virtual double position_error() const { return 0; }
    // What a user should know: attributes that the format cannot store, values that did not fit.
    virtual std::vector<std::string> notes() const { return {}; }
};

// `cloud` is the info() of the reader that the batches will come from: schema, position type, grid (batches are gridded
// exactly when it is present) and metadata. Its number of points and its box are only hints.
// Throws what check_writable_name() throws, Error(invalid_argument) for a cloud that the format
// cannot hold, and what opening a file can throw.
std::unique_ptr<PointWriter> create_writer(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options = {});

// Throws Error(unsupported) for a name that promises what no writer makes: for create_writer()'s callers that have work
// to do before they have a cloud.
void check_writable_name(const std::filesystem::path& path);

// Extensions of the formats that create_writer() knows, lower case, without the dot.
std::vector<std::string> writable_extensions();

}  // namespace pcm
