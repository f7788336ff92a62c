// Several output files that are written all or none.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>
#include <vector>

namespace pcm {

// While an object of this class lives, OutputFile::finish() on its thread does not put the file in place but hands it
// to the object, complete and synced:
//
//     OutputGroup group;
//     for (const auto& file : files) write_measures(list, file, options);
//     group.put_in_place();
//
// Objects do not overlap on a thread. The destructor drops the files unless they were put in place. A process that is
// killed leaves each file old or new; only when that happens within put_in_place() are some of them new.
class OutputGroup {
public:
    OutputGroup();
    ~OutputGroup();
    OutputGroup(const OutputGroup&) = delete;
    OutputGroup& operator=(const OutputGroup&) = delete;

    // All files get their names, or none of them does and what had the names before has them again. Once. Throws what
    // OutputFile::finish() throws: an Error that is_done() when all files are complete and in place.
    void put_in_place();

    // For OutputFile: the group of this thread, or null.
    static OutputGroup* current();
    // For OutputFile: `file`, which is put at `place`; `path` is what the user called that. `part` is the file's
    // present name, or empty. Throws Error(invalid_argument) for a place that the group has already; then the file is
    // still the caller's.
    void add(const std::filesystem::path& path, const std::filesystem::path& place, const std::filesystem::path& part,
             File& file);

private:
    struct Member {
        std::filesystem::path path, place;  // as given; where the file is put
        std::filesystem::path part;         // the file's present name; empty while it has none
        std::filesystem::path earlier;      // the present name of what had the name before; empty: nothing had it
        File file;
        bool placed = false;
    };
    void place(Member& member);
    void undo();

    std::vector<Member> members_;
};

}  // namespace pcm
