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

// Where chunks lie in the data files, given one after the other.
class ChunkPlaces {
public:
    explicit ChunkPlaces(std::uint32_t first = 0) : first_(first) {}  // number of the first file

    // With the number of points of each level of the cloud: which chunks are in front.
    void choose_front(const std::vector<std::uint64_t>& points_of_levels);
    bool is_in_front(const Draft& draft) const { return draft.first_level <= front_level_; }
    // Sets the file and the offset of the next chunk, of `size` bytes, that is not in front.
    void place(Draft& draft, std::uint64_t size);
    const std::vector<std::uint64_t>& bytes() const { return bytes_; }
    std::vector<std::uint64_t>& bytes() { return bytes_; }

private:
    std::uint32_t first_;
    std::uint16_t front_level_ = 0;        // chunks that begin with this level or a coarser one are in the front
    std::vector<std::uint64_t> bytes_{0};  // size of each data file; the first is the front
};

// Puts the chunks of the front in their order: level by level, and neighbours in space one after another.
void sort_front(std::vector<Draft*>& front);

// Chunks are appended in the order of the calls. Those of the coarse levels go to a temporary file, from which finish()
// writes the first data file: level by level, and neighbours in space one after another, so that a view of the whole
// cloud, or of a part of it, is a few ranges of that file. One thread at a time.
class DataFiles {
public:
    // In `folder`, numbered from `first` on; the temporary file is in `work`.
    DataFiles(const std::filesystem::path& folder, const std::filesystem::path& work, std::uint32_t first);

    // Before append(), with the number of points of each level of the cloud.
    void choose_front(const std::vector<std::uint64_t>& points_of_levels) { places_.choose_front(points_of_levels); }
    // Writes a chunk and sets its extent in the draft.
    void append(Draft& draft, const std::byte* bytes, std::size_t size);
    // Writes the first data file and syncs everything; its drafts get their final extents.
    void finish();
    const std::vector<std::uint64_t>& bytes() const { return places_.bytes(); }  // size of each data file
    std::uint64_t appended() const { return appended_; }                         // bytes, by this process

    // The sizes of the files; load() truncates them to these sizes, and throws Error(truncated | ...) when they are
    // shorter. After load() the drafts whose chunks were written are passed to written(), in the order of append().
    void save(ByteWriter& out) const;
    void load(ByteReader& in);
    void written(Draft& draft);
    // Returns a function that syncs what was appended until now; it may run while more is appended.
    std::function<void()> syncer() const;

private:
    void finish_file();
    std::filesystem::path folder_, front_path_;
    std::uint32_t first_;
    ChunkPlaces places_;
    std::shared_ptr<File> front_, file_;
    std::uint64_t front_bytes_ = 0, appended_ = 0;
    std::vector<Draft*> fronted_;
};

}  // namespace pcm
