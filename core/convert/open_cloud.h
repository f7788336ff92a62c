// The inputs of a conversion. They can be read more than once.
#pragma once

#include "pcm/convert/convert.h"
#include "pcm/io/pipe/merged_reader.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

class CloudSources {
public:
    CloudSources(const std::vector<std::filesystem::path>& inputs, const CloudOptions& options);

    // A new reader at the beginning of the cloud.
    std::unique_ptr<PointReader> open();
    // Files and trees: folders of files are expanded.
    const std::vector<std::filesystem::path>& paths() const { return paths_; }
    // The names of those that the last open() reads: all but the bad files of ReadOptions::skip_bad_files.
    const std::vector<std::string>& names() const { return names_; }

private:
    CloudOptions options_;
    std::vector<std::filesystem::path> paths_;
    MergedReader::Inputs inputs_;
    bool is_one_tree_ = false;
    std::vector<std::string> names_;
};

}  // namespace pcm
