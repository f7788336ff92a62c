#include "pcm/update/foreign_files.h"

#include "pcm/bpc/chunk_header.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <string>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// The data files' lengths and generations, as the index states them, or the commit record of the tree that about.pct
// describes.
std::vector<DataFile> recorded_files(const std::vector<FoundFile>& files, const std::optional<TreeIndex>& index,
                                     const std::optional<TreeInfo>& about)
{
    if (index) return index->data_files;
    for (const FoundFile& file : files)
        if (about && file.commit && file.commit->generation == about->generation &&
            file.commit->points == about->points && file.commit->content_hash == about->content_hash)
            return file.commit->data_files;
    return {};
}

// Whether nothing in the file is of this tree, though it is undamaged. A tree on the same grid and with the same
// attributes shows by the commit record at the file's end.
bool is_foreign(const FoundFile& file, const std::vector<DataFile>& recorded)
{
    if (file.chunks.empty()) return file.other_chunks > 0;
    if (!file.commit || file.number >= recorded.size()) return false;
    const std::vector<DataFile>& own = file.commit->data_files;
    return own.size() != file.number + std::size_t(1) || !(own.back() == recorded[file.number]);
}

// "a, b and c"
std::string listed(const std::vector<std::string>& names)
{
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
    return text;
}

}  // namespace

std::vector<fs::path> foreign_data_files(const fs::path& folder, const TreeInfo& info, std::size_t data_files)
{
    std::vector<fs::path> foreign;
    for (const FoundFile& found : list_data_files(folder)) {
        if (found.number < data_files) continue;
        try {
            const File file(found.path, File::Mode::read);
            const BpcHeader header = read_header(file, 0, file.size());
            if (!is_of(header, {info.schema, info.grid}) || header.identity->generation <= info.generation)
                foreign.push_back(found.path);
        } catch (const Error& error) {  // not a whole header: what an interruption leaves
            if (error.code() == ErrorCode::io || error.code() == ErrorCode::permission) throw;
        }
    }
    return foreign;
}

void refuse_foreign_files(const fs::path& folder, const std::vector<FoundFile>& files,
                          const std::optional<TreeIndex>& index, const std::optional<TreeInfo>& about)
{
    const std::vector<DataFile> recorded = recorded_files(files, index, about);
    std::vector<std::string> own, foreign;
    fs::path first;
    for (const FoundFile& file : files) {
        const bool is_named = file.number < recorded.size();
        if (!recorded.empty() && (!is_named || recorded[file.number].bytes == 0)) continue;  // not needed
        const std::string name = file.path.filename().string();
        if (is_foreign(file, recorded)) {
            if (foreign.empty()) first = file.path;
            foreign.push_back(name);
        } else if (!file.chunks.empty()) {
            own.push_back(name);
        }
    }
    if (foreign.empty()) return;
    const bool is_known = index || about;
    if (own.empty() && is_known)
        throw Error(ErrorCode::corrupt, folder / (index ? index_file_name : about_file_name),
                    "it belongs to another tree than the data files (" + listed(foreign) + ")",
                    std::string("put the tree's own ") + index_file_name + " and " + about_file_name +
                        " back, or move both out of the folder, and repair again");
    if (!is_known)
        throw Error(
            ErrorCode::corrupt, folder,
            "its data files belong to different trees: " + listed(own) + " to one, " + listed(foreign) + " to another",
            "move those that do not belong here out of the folder, and repair again");
    throw Error(
        ErrorCode::corrupt, first,
        foreign.size() == 1 ? "this data file belongs to another tree"
                            : "the data files " + listed(foreign) + " belong to another tree",
        "put the tree's own back, or move what does not belong here out of the folder to continue without it, and "
        "repair again");
}

}  // namespace pcm
