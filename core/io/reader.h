// Readers turn a file into batches of points, in bounded memory.
//
// Each format has a folder: las/, ply/, ...; formats.h is the table of them. open_reader() recognises the format by
// content first, by extension second. A reader belongs to one thread at a time. Headers are never trusted: promised
// counts are bounds to check against, not sizes to allocate.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/metadata.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/io/text/text_layout.h"
#include "pcm/system/error.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct RecordBatch;

// Thrown by a reader that was to keep integers (PointReader::keep_integers()) and has come to a point that cannot.
struct IntegersLost {};

// What was left out because of ReadOptions::skip_bad_lines and skip_bad_files, up to now.
struct Skipped {
    std::uint64_t lines = 0;
    std::uint64_t files = 0;             // files that could not be opened: none of their points
    std::uint64_t incomplete_files = 0;  // files read up to a fault only
};

struct FileInfo {
    std::string format;                          // "LAS 1.2, point format 3", "PLY binary little endian"
    std::uint64_t points = 0;                    // as the file states; the reader checks it
    bool points_known = true;                    // false: the file does not say, `points` is an estimate from its size
    Schema schema;                               // attributes other than the position, in source order and type
    ScalarType position_type = ScalarType::f64;  // i32 for gridded sources, otherwise f32 or f64
    std::optional<Grid> grid;                    // present when positions are integers on a grid
    std::optional<Grid> near_grid;               // grid of the integers that doubles were computed from, up to rounding
    double move_error = 0;                       // largest change of a coordinate so far by keep_integers()
    std::optional<Box3d> promised_box;           // from the header, not checked
    std::uint64_t points_left_out = 0;           // number so far beyond ReadOptions::largest_coordinate
    std::vector<Metadata> metadata;
    // What a user should know: "12 faces ignored", "VLR count is wrong". For people: no code depends on the words.
    std::vector<std::string> notes;
    Skipped skipped;
    // The layout that a text file of columns is read with, detected or as the user stated it.
    std::optional<TextLayout> text_layout;
};

class PointReader {
public:
    virtual ~PointReader() = default;

    // Notes, metadata and `skipped` may grow while points are read: they then include what only reading finds, and how
    // many points were dropped.
    virtual const FileInfo& info() const = 0;

    // Replaces `batch` by the next points, at most `max_points` (> 0). Returns false, with an empty batch, at the end.
    // Throws Error(truncated | bad_format | io), naming the byte or line, when the file is not as its header states.
    virtual bool read(PointBatch& batch, std::size_t max_points) = 0;

    // Whether read_records() may take the place of read() at any time: it gives the same points, on a grid, undecoded.
    virtual bool has_records() const { return false; }
    virtual bool read_records(RecordBatch& batch, std::size_t max_points);

    // Whether seek() is cheap; true for uncompressed binary formats with records of a fixed size. Such files state
    // their number of points.
    virtual bool seekable() const { return false; }
    // The next read() starts at point `index`, counted from 0 in file order. Only when seekable().
    virtual void seek(std::uint64_t index);

    // Whether positions, which come as doubles from integers on info().near_grid, can also come as integers on it, as
    // far as the headers of files show.
    virtual bool can_keep_integers() const { return false; }
    // Begins again at the first point, and gives integers on info().near_grid, which becomes info().grid; or doubles
    // again. read() and read_records() then throw IntegersLost for a point whose integers need more than 32
    // bits, and info().move_error is set. Only where integers can be kept.
    virtual void keep_integers(bool) {}

    // For progress: 0..1 of the file's bytes that read() has consumed.
    virtual double fraction_read() const = 0;
};

inline constexpr std::size_t default_batch_points = 65536;

struct ReadOptions {
    unsigned threads = 1;  // maximum number of decoding threads, where a format has them (LAZ); 0: one per processor
    TextLayout text;       // layout of text files; unset members are detected
    // For several files as one cloud: coordinate systems and GPS times that differ are noted instead of refused.
    bool ignore_crs = false;
    // Text, PTS and PTX: lines that are not points are counted and noted, not refused. Values that do not fit the type
    // found for their column are refused all the same.
    bool skip_bad_lines = false;
    // For several files (MergedReader): those that cannot be opened are left out, and of one that fails while it is
    // read the batches before the fault are kept; both are counted and noted. It is an error when no file is left.
    bool skip_bad_files = false;
    // Points with a coordinate above this or below its negative are left out, and counted (pipe/limited_reader.h): for
    // no-data values.
    std::optional<double> largest_coordinate = std::nullopt;
};

// Throws Error(not_found | permission | bad_format | truncated | unsupported).
std::unique_ptr<PointReader> open_reader(const std::filesystem::path& path, const ReadOptions& options = {});

// Extensions of the formats that open_reader() knows, lower case, without the dot.
std::vector<std::string> readable_extensions();

// Files are kept. A folder is replaced by the readable files in it, in name order, and then by those of its
// sub-folders, in name order too. Left out, and counted with examples in one of `notes` for each folder: hidden files
// and folders (.NAME), files of other formats, a .txt, .csv or .asc that does not hold points, point cloud trees (they
// may be of the same points), and links to folders. Throws Error(not_found) for a missing path and for a folder without
// any readable file, Error(unsupported) for the folder or a file of a point cloud tree, of which single files are only
// a part, and Error(permission) for a folder that cannot be listed, unless it is a sub-folder and `skip_unreadable`
// counts it too.
std::vector<std::filesystem::path> expand_inputs(const std::vector<std::filesystem::path>& inputs,
                                                 std::vector<std::string>* notes = nullptr,
                                                 bool skip_unreadable = false);

}  // namespace pcm
