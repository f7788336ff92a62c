// Options of several commands: how text files are read.
#pragma once

#include "pcm/cli/common.h"
#include "pcm/io/reader.h"

#include <optional>
#include <string>

namespace pcm::cli {

class ReadingOptions {
public:
    // --columns, --separator, --skip-lines, --colour-range.
    void add_to(Options& options);
    // --ignore-crs, of commands that make one cloud out of several.
    void add_ignore_crs(Options& options);
    // Throws Error(invalid_argument).
    ReadOptions get(unsigned threads) const;

private:
    std::string columns_, separator_;
    std::optional<std::size_t> skip_lines_;
    std::optional<double> colour_range_;
    bool ignore_crs_ = false;
};

}  // namespace pcm::cli
