// Options of several commands: how text files are read.
#pragma once

#include "pcm/cli/common.h"
#include "pcm/io/reader.h"

#include <optional>
#include <string>

namespace pcm::cli {

class ReadingOptions {
public:
    // --columns, --separator, --skip-lines, --colour-range, --largest-coordinate.
    void add_to(Options& options);
    // Throws Error(invalid_argument).
    ReadOptions get(unsigned threads) const;

private:
    std::string columns_, separator_;
    std::optional<std::size_t> skip_lines_;
    std::optional<double> colour_range_, largest_coordinate_;
};

}  // namespace pcm::cli
