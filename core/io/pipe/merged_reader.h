// Several files read as one cloud, in order.
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
// Attributes are merged by name: the cloud has those of every file, and points of a file without an attribute have
// zero. Attributes of the same name that differ in type, components, scale or offset are kept apart: the first keeps
// the name, others are called NAME_TYPE, or NAME_TYPE_2, ... where that is taken. Positions are passed bit for bit: as
// integers where all files have the same grid, else as doubles; info().near_grid is then the first file's grid, if the
// other grids have its scale and offsets that differ by whole steps. Notes report differences in a few lines, however
// many files there are.
//
// Files of different coordinate systems, units or GPS times are refused (system_check.h), unless the difference is to
// be ignored. Metadata are the union without duplicates, but the records of the coordinate system are those of the
// first file that states one.
//
// One file is open at a time: a survey may have more tiles than a process may open. The constructor opens each file
// once, for its header. One thread.
class MergedReader final : public PointReader {
public:
    // A part of the cloud: a file, or anything that can repeatedly be opened as a reader. `path` names it in messages.
    struct Source {
        std::filesystem::path path;
        std::function<std::unique_ptr<PointReader>()> open;
    };

    // Throws what opening throws, Error(invalid_argument) without sources and for systems that differ, and
    // Error(unsupported) when all sources together have more than max_attributes.
    explicit MergedReader(std::vector<Source> sources, bool ignore_crs = false);
    // Files, and folders as expand_inputs() expands them.
    MergedReader(const std::vector<std::filesystem::path>& inputs, const ReadOptions& options);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return seekable_; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

    const std::vector<Source>& sources() const { return sources_; }

private:
    // What is kept of a file between reading its header and its points.
    struct Part {
        std::uint64_t points = 0;
        double weight = 1;      // its share of the work, in bytes
        std::size_t shape = 0;  // in shapes_
        std::optional<Grid> grid;
        std::size_t notes = 0;  // of its header
    };
    // A schema of one or many files, and the place of each of its attributes in the merged schema.
    struct Shape {
        Schema schema;
        std::vector<std::size_t> places;
        std::vector<std::size_t> missing;  // attributes of the merged cloud that this schema lacks
        bool same = false;                 // equal to the merged schema
    };
    class Notes;

    void look_at_headers(bool ignore_crs);
    std::size_t shape_of(const FileInfo& info, const std::filesystem::path& path, Notes& notes);
    void take_metadata(const FileInfo& info, bool with_system, Notes& notes);
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
    double weight_before_ = 0;  // of the parts that have been read completely
    std::uint64_t metadata_bytes_ = 0;

    std::size_t current_ = 0;
    std::unique_ptr<PointReader> open_;
    std::size_t open_part_ = 0;
    PointBatch part_batch_;
};

}  // namespace pcm
