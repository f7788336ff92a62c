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

struct WriteOptions {
    // LAS and LAZ: the grid to write on. When absent that of the source, where it has one. A source of doubles needs
    // one (choose_grid() finds the coarsest on which all of its points are exact).
    std::optional<Grid> grid;
    // Text: digits after the point of a coordinate. When absent the fewest that give back the same double.
    std::optional<unsigned> decimals;
    bool ascii = false;    // PLY and PCD: text instead of binary
    unsigned threads = 1;  // most threads to encode with, where a format can; 0: one a processor
};

// One thread. The file appears under its name only when finish() returns; until then the destructor leaves nothing
// behind.
class PointWriter {
public:
    virtual ~PointWriter() = default;

    // A batch of the shape that the writer was created for. Throws Error(no_space | io | invalid_argument); after that
    // the writer can only be destroyed.
    virtual void write(const PointBatch& batch) = 0;
    // Writes what is known only at the end, syncs, renames. Nothing may be written afterwards.
    virtual void finish() = 0;

    // Largest difference of a written position from its source on any axis, source units; 0 when all digits were kept.
    virtual double position_error() const { return 0; }
    // What a user should know: attributes that the format has no place for, values that did not fit.
    virtual std::vector<std::string> notes() const { return {}; }
};

// `cloud` is the info() of the reader that the batches will come from: schema, position type, grid (batches are gridded
// exactly when it is present) and metadata. Its number of points and its box are taken for hints.
// Throws Error(unsupported) for an extension that no writer has, Error(invalid_argument) for a cloud that the format
// cannot hold, and what opening a file can throw.
std::unique_ptr<PointWriter> create_writer(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options = {});

// Extensions of the formats that create_writer() knows, lower case, without the dot.
std::vector<std::string> writable_extensions();

}  // namespace pcm
