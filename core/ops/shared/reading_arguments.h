// Arguments of operations that read files.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/ops/operation.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

class ReadingArguments {
public:
    // skip_bad_lines, skip_bad_files, columns, separator, skip_lines, colour_range, largest_coordinate. `only`: a face,
    // where the other one reads no files.
    void declare(Arguments& arguments, std::optional<Face> only = std::nullopt);
    // ignore_crs, of operations that make one cloud of several.
    void declare_ignore_crs(Arguments& arguments, std::optional<Face> only = std::nullopt);
    // Throws Error(invalid_argument).
    ReadOptions get(unsigned threads) const;

private:
    std::string columns_, separator_;
    std::optional<std::uint64_t> skip_lines_;
    std::optional<double> colour_range_, largest_coordinate_;
    bool ignore_crs_ = false;
    bool skip_bad_lines_ = false, skip_bad_files_ = false;
};

// lines_skipped, files_skipped and files_incomplete.
void put_skipped(Result& result, const Skipped& skipped);
std::vector<ResultKey> with_skipped_keys(std::vector<ResultKey> keys);

// "las, laz, ply": what is read, and what is written.
std::string readable_text();
std::string writable_text();

}  // namespace pcm::ops
