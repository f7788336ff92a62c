#include "pcm/update/clone.h"

#include "pcm/build/build_folder.h"
#include "pcm/remote/open_bytes.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/url.h"
#include "pcm/tree/about.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/tree_index.h"

#include <vector>

namespace pcm {

namespace fs = std::filesystem;

namespace {

void copy_synced(const fs::path& from, const fs::path& to)
{
    const std::shared_ptr<const ByteSource> source = open_bytes(from);
    File copy(to, File::Mode::create_new);
    std::vector<std::byte> buffer(std::size_t(4) << 20);
    for (std::uint64_t at = 0;;) {
        const std::size_t bytes = source->read_some_at(buffer.data(), buffer.size(), at);
        if (bytes == 0) break;
        copy.write_at(buffer.data(), bytes, at);
        at += bytes;
    }
    copy.sync();
    copy.close();
}

bool has_about(const fs::path& folder)
{
    const fs::path about = folder / about_file_name;
    if (!is_url(folder)) return fs::exists(about);
    try {
        return open_bytes(about)->size() > 0;
    } catch (const Error& error) {
        if (error.code() == ErrorCode::not_found) return false;
        throw;
    }
}

}  // namespace

void clone_into(const fs::path& tree, const fs::path& output)
{
    const fs::path folder = Tree::open(tree)->folder();  // throws unless the index is valid
    const std::vector<std::byte> index = read_index(*open_bytes(folder / index_file_name));
    const std::vector<DataFile> data_files = decode_index(index, folder / index_file_name).data_files;
    for (std::size_t number = 0; number < data_files.size(); ++number) {
        if (data_files[number].bytes == 0) continue;
        const std::string name = data_file_name(static_cast<std::uint32_t>(number));
        std::error_code no_links;
        // Where the data file is a symbolic link, what it leads to: a copy of the link could lead elsewhere.
        const fs::path real = fs::canonical(folder / name, no_links);
        if (!no_links) fs::create_hard_link(real, output / name, no_links);
        if (no_links) copy_synced(folder / name, output / name);
    }
    if (has_about(folder)) copy_synced(folder / about_file_name, output / about_file_name);
    replace_file(output / index_file_name, index.data(), index.size());
    if (is_url(folder)) Tree::open(output)->refuse_other_data();  // the server may have got another tree meanwhile
}

void clone_tree(const fs::path& tree, const fs::path& output)
{
    Tree::open(tree);  // what is wrong with it comes first
    BuildFolder made(output, false);
    if (made.left_over()) made.clear();
    clone_into(tree, made.tree());
    made.publish();
}

}  // namespace pcm
