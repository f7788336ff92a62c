// Several files read as one cloud, one behind the other.
#pragma once

#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace pcm {

// What the merged cloud is:
//
// Attributes are merged by name: the cloud has those of every file, and where a file lacks one its points have zero.
// Kinds of one name that differ in type, components, scale or offset are kept apart: the first has the name, others are
// called NAME_TYPE, or NAME_TYPE_2, ... where that is taken. Positions pass through bit for bit: as integers where all
// files lie on one grid, else as doubles; info().near_grid is then the first file's grid, when the others have its
// scale and offsets whole steps away. Metadata are the union without repeats. notes() say what differs, however many
// files there are in a few lines.
//
// One file is open at a time: a survey may have more tiles than a process may have open files. All are opened once by
// the constructor, for their headers. One thread.
class MergedReader final : public PointReader {
public:
    // A part of the cloud: a file, or what else can be opened as a reader again and again. `path` names it in messages.
    struct Source {
        std::filesystem::path path;
        std::function<std::unique_ptr<PointReader>()> open;
    };

    // At least one; throws what opening throws, Error(invalid_argument) for none and Error(unsupported) when together
    // they have more than max_attributes.
    explicit MergedReader(std::vector<Source> sources);
    // Files as they are; folders stand for the files that expand_inputs() finds in them.
    MergedReader(const std::vector<std::filesystem::path>& inputs, const ReadOptions& options);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return seekable_; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

    const std::vector<Source>& sources() const { return sources_; }

private:
    // What is remembered of a file between its header and its points.
    struct Part {
        std::uint64_t points = 0;
        double weight = 1;      // its share of the work: bytes
        std::size_t shape = 0;  // in shapes_
        std::optional<Grid> grid;
        std::size_t notes = 0;  // of its header
    };
    // A schema that one file or many have, and the place of each of its attributes in the merged one.
    struct Shape {
        Schema schema;
        std::vector<std::size_t> places;
        std::vector<std::size_t> missing;  // attributes of the merged cloud that it lacks
        bool same = false;                 // as the merged one
    };
    class Notes;

    void look_at_headers();
    std::size_t shape_of(const FileInfo& info, const std::filesystem::path& path, Notes& notes);
    void take_metadata(const FileInfo& info, Notes& notes);
    void take_late(const FileInfo& info, const Part& part, const std::filesystem::path& path);
    void settle_positions(const std::vector<ScalarType>& types);
    void describe_missing(Notes& notes);
    PointReader& open(std::size_t part);

    std::vector<Source> sources_;
    FileInfo info_;
    bool seekable_ = true;
    std::vector<Part> parts_;
    std::vector<Shape> shapes_;
    double total_weight_ = 0;
    double weight_before_ = 0;  // of the parts that have been read to their ends
    std::uint64_t metadata_bytes_ = 0;

    std::size_t current_ = 0;
    std::unique_ptr<PointReader> open_;
    std::size_t open_part_ = 0;
    PointBatch part_batch_;
};

}  // namespace pcm
