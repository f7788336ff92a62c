// The inputs of a conversion, which may be read more than once.
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

    // From the beginning, each time.
    std::unique_ptr<PointReader> open() const;
    // Files and trees: folders of files are expanded.
    const std::vector<std::filesystem::path>& paths() const { return paths_; }
    std::vector<std::string> names() const;

private:
    CloudOptions options_;
    std::vector<std::filesystem::path> paths_;
    std::vector<bool> is_tree_;
};

}  // namespace pcm
