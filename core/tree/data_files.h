// The data files of a tree while it is built.
#pragma once

#include "cloud/file.h"
#include "tree/node_builder.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// Chunks are appended in the order of the calls; those of the first levels wait in a file of their own until finish() puts them in
// front, parents first. One thread at a time.
class DataFiles {
public:
    // In `folder`, numbered from `first` on; `work` is where the front waits.
    DataFiles(const std::filesystem::path& folder, const std::filesystem::path& work, std::uint32_t first);
    explicit DataFiles(const std::filesystem::path& folder) : DataFiles(folder, folder, 0) {}

    // Writes a chunk and notes in the draft where it lies.
    void append(Draft& draft, const std::byte* bytes, std::size_t size);
    // Writes the front and syncs everything; the drafts in front get their final places.
    void finish();
    const std::vector<std::uint64_t>& bytes() const { return bytes_; }  // of each data file

private:
    void finish_file();
    std::filesystem::path folder_;
    std::uint32_t first_;
    File front_;
    std::uint64_t front_bytes_ = 0;
    std::vector<Draft*> fronted_;
    File file_;
    std::vector<std::uint64_t> bytes_;
};

}  // namespace pcm
