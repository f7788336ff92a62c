// What goes wrong while many files are read one after the other.
#pragma once

#include "pcm/system/text.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

class ReadFaults {
public:
    static constexpr std::size_t named_faults = 10;  // further ones are only counted

    // The rest of a file cannot be read.
    void give_up(std::string text)
    {
        if (files_++ < named_faults) texts_.push_back(std::move(text));
    }
    // A file ends, of which `lines` were skipped.
    void end_file(std::uint64_t lines)
    {
        lines_ += lines;
        files_with_bad_lines_ += lines > 0;
    }

    std::uint64_t files() const { return files_; }  // given up
    std::uint64_t lines() const { return lines_; }  // skipped in files that have ended
    std::vector<std::string> notes() const
    {
        std::vector<std::string> notes = texts_;
        if (files_ > texts_.size())
            notes.push_back(grouped(files_ - texts_.size()) + " more files could be read in part only");
        if (files_with_bad_lines_ > 1)
            notes.push_back(grouped(lines_) + " bad lines were skipped in all files together");
        return notes;
    }

private:
    std::uint64_t files_ = 0, lines_ = 0, files_with_bad_lines_ = 0;
    std::vector<std::string> texts_;
};

}  // namespace pcm
