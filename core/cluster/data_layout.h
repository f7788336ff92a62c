// Where the chunks of a tree that many jobs built lie: in the jobs' files, and in the data files.
#pragma once

#include "pcm/build/nodes/data_files.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

class DataLayout {
public:
    // Bytes of a job's file, which follow those of the run before in a data file.
    struct Run {
        std::uint64_t source, offset, bytes;
    };

    DataLayout() = default;
    // With the number of points of each level of the cloud.
    explicit DataLayout(const std::vector<std::uint64_t>& points_of_levels) { places_.choose_front(points_of_levels); }

    // The next chunk in post-order, at draft.extent.offset of the file `source`. Sets its place in the data files; that
    // of one in front is known after finish().
    void add(Draft& draft, std::uint64_t source);
    void finish();

    const std::vector<std::vector<Run>>& files() const { return files_; }  // runs, keyed by number of the data file
    std::vector<std::uint64_t> bytes() const;                              // size of each

    void save(ByteWriter& out) const;
    static DataLayout load(ByteReader& in);

private:
    void append(std::size_t file, const Run& run);
    ChunkPlaces places_;
    std::vector<Draft*> front_;
    std::map<const Draft*, Run> sources_;  // drafts in front
    std::vector<std::vector<Run>> files_{1};
};

}  // namespace pcm
