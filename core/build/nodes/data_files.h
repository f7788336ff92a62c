// The data files of a tree while it is built.
#pragma once

#include "pcm/build/nodes/draft.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

// Chunks are appended in the order of the calls; those of the first levels wait in a file of their own until finish()
// puts them in front, parents first. One thread at a time.
class DataFiles {
public:
    // In `folder`, numbered from `first` on; `work` is where the front waits.
    DataFiles(const std::filesystem::path& folder, const std::filesystem::path& work, std::uint32_t first);

    // Writes a chunk and notes in the draft where it lies.
    void append(Draft& draft, const std::byte* bytes, std::size_t size);
    // Writes the front and syncs everything; the drafts in front get their final places.
    void finish();
    const std::vector<std::uint64_t>& bytes() const { return bytes_; }  // of each data file
    std::uint64_t appended() const { return appended_; }                // bytes, by this process

    // How much has been written, and the reverse: the files are cut off there. load() throws Error(truncated | ...)
    // when they have less. The drafts whose chunks were written are told by written(), in the order of append().
    void save(ByteWriter& out) const;
    void load(ByteReader& in);
    void written(Draft& draft);
    // Puts on disk what was appended until now; may be called while more is appended.
    std::function<void()> syncer() const;

private:
    void finish_file();
    std::filesystem::path folder_, front_path_;
    std::uint32_t first_;
    std::shared_ptr<File> front_, file_;
    std::uint64_t front_bytes_ = 0, appended_ = 0;
    std::vector<Draft*> fronted_;
    std::vector<std::uint64_t> bytes_;
};

}  // namespace pcm
