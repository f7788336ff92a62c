#include "pcm/update/upload.h"

#include "pcm/remote/bucket_object.h"
#include "pcm/remote/remote_object.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/tree_folder.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/about.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/tree_index.h"

#include <string>
#include <vector>

namespace pcm {

namespace fs = std::filesystem;

namespace {

struct Part {
    std::string name;
    File file;
    std::uint64_t bytes = 0;
};

struct Snapshot {
    std::vector<Part> parts;  // all but the index
    std::vector<std::byte> index;
    std::uint32_t data_files = 0;
};

// The files that one index names, opened: a change of the tree meanwhile leaves them as they are.
Snapshot snapshot_of(const fs::path& folder)
{
    const fs::path index = folder / index_file_name;
    for (;;) {
        Snapshot all;
        all.index = read_index(File(index, File::Mode::read));
        const std::vector<DataFile> data_files = decode_index(all.index, index).data_files;
        all.data_files = static_cast<std::uint32_t>(data_files.size());
        for (std::uint32_t number = 0; number < all.data_files; ++number) {
            const std::string name = data_file_name(number);
            if (data_files[number].bytes == 0) continue;
            all.parts.push_back({name, File(folder / name, File::Mode::read), data_files[number].bytes});
        }
        if (const fs::path about = folder / about_file_name; fs::exists(about)) {
            File file(about, File::Mode::read);
            const std::uint64_t bytes = file.size();
            all.parts.push_back({about_file_name, std::move(file), bytes});
        }
        if (read_index(File(index, File::Mode::read)) == all.index) return all;
    }
}

bool is_there(const fs::path& address)
{
    try {
        RemoteObject(address).ask();
        return true;
    } catch (const Error& error) {
        if (error.code() == ErrorCode::not_found) return false;
        throw;
    }
}

// What the replaced tree had more of. A server that has files of any name is not believed for ever.
void remove_data_files_from(std::uint32_t first, const fs::path& folder)
{
    constexpr std::uint32_t most_data_files = 100000;
    for (std::uint32_t number = first; number < most_data_files && is_there(folder / data_file_name(number)); ++number)
        BucketObject(folder / data_file_name(number)).remove();
}

void refuse_existing(const fs::path& index, const fs::path& address, bool overwrite)
{
    if (!overwrite && is_there(index))
        throw Error(ErrorCode::exists, address, "there is a tree at this address",
                    "choose another address, or overwrite it");
}

}  // namespace

void refuse_upload(const fs::path& address, bool overwrite)
{
    const fs::path index = tree_folder_of(address) / index_file_name;
    const BucketObject written(index);
    refuse_existing(index, address, overwrite);
    written.check_writable();
}

std::uint64_t upload_tree(const fs::path& tree, const fs::path& address, bool overwrite,
                          const ProgressFunction& progress)
{
    const fs::path from = Tree::open(tree)->folder(), to = tree_folder_of(address);  // throws unless the index is valid
    const BucketObject index(to / index_file_name);
    refuse_existing(to / index_file_name, address, overwrite);
    const Snapshot all = snapshot_of(from);
    std::uint64_t total = all.index.size(), before = 0;
    for (const Part& part : all.parts) total += part.bytes;
    Watch watch(progress);
    const auto report = [&](std::uint64_t sent) {
        watch.report("Sending", static_cast<double>(before + sent) / static_cast<double>(total));
    };
    if (overwrite) index.remove();
    for (const Part& part : all.parts) {
        report(0);
        BucketObject(to / part.name).write(part.file, part.bytes, report);
        before += part.bytes;
    }
    index.write(all.index);
    if (overwrite) remove_data_files_from(all.data_files, to);
    watch.finish("Sending");
    return total;
}

}  // namespace pcm
