// The inputs of a conversion. They can be read more than once.
#pragma once

#include "pcm/convert/convert.h"
#include "pcm/io/pipe/merged_reader.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

class TreeReader;

class CloudSources {
public:
    CloudSources(const std::vector<std::filesystem::path>& inputs, const CloudOptions& options);

    // A new reader at the beginning of the cloud.
    std::unique_ptr<PointReader> open();
    // The reader where all inputs are one tree; else null.
    std::unique_ptr<TreeReader> open_tree() const;
    // The names of those that the last open() reads: all but the bad files of ReadOptions::skip_bad_files.
    const std::vector<std::string>& names() const { return names_; }
    // Around all points of the trees, and around those of the files that a reader of open() has passed without
    // selecting one: complete once a reader has come to the end without a point. Source coordinates.
    Box3d bounds() const;
    // Whether `path` is one of them, however it is spelled. Folders of files are expanded.
    bool has(const std::filesystem::path& path) const;
    // What a user should know: inputs that stand for a whole tree, and trees that were named twice.
    const std::vector<std::string>& notes() const { return notes_; }

private:
    void add_tree(const std::filesystem::path& input);

    CloudOptions options_;
    std::vector<std::filesystem::path> paths_;
    std::vector<std::filesystem::path> trees_;
    MergedReader::Inputs inputs_;
    std::vector<std::string> names_;
    std::shared_ptr<Box3d> passed_ = std::make_shared<Box3d>();
    std::vector<std::string> notes_;
};

}  // namespace pcm
