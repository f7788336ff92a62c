// Options of several commands: how files are read.
#pragma once

#include "pcm/cli/common.h"
#include "pcm/io/reader.h"

#include <optional>
#include <string>

namespace pcm::cli {

class ReadingOptions {
public:
    // --skip-bad-lines, --skip-bad-files, --columns, --separator, --skip-lines, --colour-range, --largest-coordinate.
    void add_to(Options& options);
    // --ignore-crs, of commands that make one cloud out of several.
    void add_ignore_crs(Options& options);
    // Throws Error(invalid_argument).
    ReadOptions get(unsigned threads) const;

private:
    std::string columns_, separator_;
    std::optional<std::size_t> skip_lines_;
    std::optional<double> colour_range_, largest_coordinate_;
    bool ignore_crs_ = false;
    bool skip_bad_lines_ = false, skip_bad_files_ = false;
};

// lines_skipped, files_skipped and files_incomplete.
void put_skipped(Json& json, const Skipped& skipped);

}  // namespace pcm::cli
