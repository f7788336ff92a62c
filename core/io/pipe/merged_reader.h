// Several files read as one cloud, in order.
#pragma once

#include "pcm/io/pipe/read_faults.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

class FileNotes;

// What the merged cloud is:
//
// Attributes are merged by name: the cloud has those of every file, and points of a file without an attribute have
// zero. Attributes of the same name that differ in type, components, scale or offset are kept apart: the first keeps
// the name, others are called NAME_TYPE, or NAME_TYPE_2, ... where that is taken. Positions are passed bit for bit: as
// integers where all files have the same grid, else as doubles; info().near_grid is then the first file's grid, if the
// other grids have its scale and offsets that differ by whole steps. Notes report differences in a few lines, however
// many files there are.
// Where headers promise that all points fit 32 bits on that grid, they can be asked for as integers on it.
//
// Where several files have scans (io/scans.h) the attribute `scan` numbers those of all files, from 1 in the order of
// the files, and so do the keys of their metadata: each number is a station of its own.
//
// Files of different coordinate systems, units or GPS times are refused (system_check.h), unless the difference is to
// be ignored. Metadata are the union without duplicates, but the records of the coordinate system are those of the
// first file that states one.
//
// ReadOptions::skip_bad_files: inputs that cannot be listed or opened are left out before anything is read. From a file
// that fails while it is read, the batches before the fault are kept. Notes name the first of both, info().skipped
// counts them; those that failed while they were read are complete at the end of the cloud.
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

    // What is known of inputs before they are opened.
    struct Inputs {
        std::vector<Source> sources;
        std::vector<std::string> notes;  // notes about folders
        bool skip_bad_files = false;
        bool ignore_crs = false;
        std::vector<Error> left_out;  // with skip_bad_files: inputs that are not there

        // Adds a file, or the files of a folder (expand_inputs()).
        void add(const std::filesystem::path& input, const ReadOptions& options);
    };

    // Throws what opening throws, Error(invalid_argument) without sources and for systems that differ, and
    // Error(unsupported) when all sources together have more than max_attributes.
    explicit MergedReader(std::vector<Source> sources, bool ignore_crs = false)
        : MergedReader(Inputs{std::move(sources), {}, false, ignore_crs, {}})
    {
    }
    explicit MergedReader(Inputs inputs);
    // Files, and folders as expand_inputs() expands them.
    MergedReader(const std::vector<std::filesystem::path>& inputs, const ReadOptions& options);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool has_records() const override { return has_records_; }
    bool read_records(RecordBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return seekable_; }
    void seek(std::uint64_t index) override;
    bool can_keep_integers() const override { return info_.near_grid && keeps_integers_; }
    void keep_integers(bool keep) override;
    double fraction_read() const override;

    // Without those that were left out.
    const std::vector<Source>& sources() const { return sources_; }
    // From now on the points of the sources [first, end) alone are read, from their beginning.
    void keep_sources(std::size_t first, std::size_t end);
    // Number of points of each, as far as the headers say.
    std::vector<std::uint64_t> points_of_sources() const;

private:
    // What is kept of a file between reading its header and its points.
    struct Part {
        std::uint64_t points = 0, points_before = 0;  // before: of all earlier parts
        double weight = 1, weight_before = 0;         // share of the work, in bytes
        std::size_t shape = 0;                        // in shapes_
        std::optional<Grid> grid;
        std::size_t notes = 0;  // number of notes about its header
        std::string format;
        ScalarType position_type = ScalarType::f64;
        bool points_known = true;
        bool has_records = false;
        std::uint32_t scans = 0, scans_before = 0;
        bool keeps_integers = false;  // whether its header promises that all fit on the first grid
    };
    // A schema of one or many files, and the place of each of its attributes in the merged schema.
    struct Shape {
        Schema schema;
        std::vector<std::size_t> places;
        std::vector<std::size_t> missing;  // attributes of the merged cloud that this schema lacks
        bool same = false;                 // equal to the merged schema
    };

    void look_at_headers(Inputs& inputs);
    void look_at_header(const Source& source, const PointReader& reader, FileNotes& notes);
    template <class Batch>
    bool read_next(Batch& batch, std::size_t max_points);
    bool read_part(PointBatch& batch, std::size_t max_points);
    bool read_part(RecordBatch& batch, std::size_t max_points);
    void put_scan_numbers(PointBatch& batch) const;
    void settle_records();
    void rewind();
    template <class... Points>
    void move_to_grid(std::size_t part, Points&... points);
    void give_up(const Error& error);
    void end_part();
    void finish();
    std::size_t shape_of(const FileInfo& info, const std::filesystem::path& path, FileNotes& notes);
    void take_metadata(const FileInfo& info, std::uint32_t scans_before, bool with_system, FileNotes& notes);
    void note_missing(const std::string& what, const std::vector<std::size_t>& parts, FileNotes& notes) const;
    void take_late(const FileInfo& info, const Part& part, const std::filesystem::path& path);
    void settle_positions();
    void describe_missing(FileNotes& notes);
    PointReader& open(std::size_t part);

    std::vector<Source> sources_;
    bool skip_bad_files_ = false;
    FileInfo info_;
    bool seekable_ = true, keeps_integers_ = false, boxes_known_ = true, has_records_ = false;
    std::vector<Part> parts_;
    std::vector<Shape> shapes_;
    std::uint32_t scans_ = 0;                // number in all files
    std::optional<std::size_t> scan_place_;  // place of their numbers in the merged schema
    double total_weight_ = 0;
    std::uint64_t metadata_bytes_ = 0;

    std::size_t current_ = 0, end_ = 0;  // the parts that are still read
    std::unique_ptr<PointReader> open_;
    std::size_t open_part_ = 0;
    std::uint64_t part_points_ = 0;  // read of the current part
    PointBatch part_batch_;
    ReadFaults faults_;
    bool finished_ = false;
};

}  // namespace pcm
