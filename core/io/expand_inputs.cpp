#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/io/reader.h"
#include "pcm/system/text.h"
#include "pcm/system/tree_folder.h"
#include "pcm/system/url.h"

#include <algorithm>
#include <array>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t named_examples = 3;  // further ones are only counted

// What is left out of a folder, and why.
enum Reason { hidden, other_format, no_points, tree, link, unreadable, reasons };
constexpr std::array<std::array<const char*, 2>, reasons> reason_texts = {{
    {"hidden file or folder", "hidden files and folders"},
    {"file of another format", "files of other formats"},
    {"text file that is not a list of points", "text files that are not lists of points"},
    {"point cloud tree, to be named itself", "point cloud trees, to be named themselves"},
    {"link to a folder", "links to folders"},
    {"folder that cannot be read", "folders that cannot be read"},
}};

// A tree, and the folder in which one is built. Their files are parts of a cloud, not clouds.
bool belongs_to_tree(const fs::path& folder)
{
    const std::string name = lower_case(folder.filename().string());
    std::error_code ignored;
    return extension_of(folder) == "pct" || name.find(".pct.") != std::string::npos || is_tree_folder(folder) ||
           fs::is_regular_file(folder / index_file_name, ignored);
}

void refuse_tree(const fs::path& input, bool is_folder)
{
    const fs::path folder = tree_folder_of(input);
    if (is_tree_folder(folder) ||
        (is_folder && belongs_to_tree(input.filename().empty() ? input.parent_path() : input)))
        throw Error(ErrorCode::unsupported, input,
                    folder == input ? "this is a point cloud tree; files were expected"
                                    : "this is a file of the point cloud tree " + folder.string() +
                                          ", and holds only a part of the cloud",
                    "'pcmlab convert' copies trees, also into a tree, and 'pcmlab append' adds them to one");
}

class FolderWalk {
public:
    FolderWalk(const fs::path& top, bool skip_unreadable) : top_(top), skip_unreadable_(skip_unreadable) {}

    // The files of a folder in name order, then those of its sub-folders in name order.
    void walk(const fs::path& folder)
    {
        std::vector<fs::directory_entry> entries;
        std::error_code error;
        fs::directory_iterator entry(folder, error);
        for (; !error && entry != fs::directory_iterator(); entry.increment(error)) entries.push_back(*entry);
        if (error) {
            if (!skip_unreadable_ || folder == top_)
                throw Error::from_errno(error.value(), folder, "listing the folder");
            leave_out(unreadable, folder);
        }
        std::sort(entries.begin(), entries.end());
        std::vector<fs::path> files, folders;
        for (const fs::directory_entry& inside : entries) look_at(inside, files, folders);
        files_.insert(files_.end(), std::make_move_iterator(files.begin()), std::make_move_iterator(files.end()));
        for (const fs::path& inner : folders) walk(inner);
    }

    std::vector<fs::path>& files() { return files_; }

    // "2 hidden files and folders (._a.las, .git), 1 link to a folder (all)"; empty when nothing was left out.
    std::string left_out() const
    {
        std::string text;
        for (std::size_t r = 0; r < reasons; ++r) {
            const std::size_t count = counts_[r];
            if (count == 0) continue;
            text += (text.empty() ? "" : ", ") + grouped(count) + " " + reason_texts[r][count > 1] + " (";
            for (const std::string& name : names_[r]) text += (&name == &names_[r][0] ? "" : ", ") + name;
            text += (count > names_[r].size() ? ", ..." : "") + std::string(")");
        }
        return text;
    }

private:
    void leave_out(Reason reason, const fs::path& path)
    {
        ++counts_[reason];
        if (names_[reason].size() < named_examples)
            names_[reason].push_back(printable_name(path.lexically_relative(top_).string()));
    }

    void look_at(const fs::directory_entry& entry, std::vector<fs::path>& files, std::vector<fs::path>& folders)
    {
        const fs::path& path = entry.path();
        std::error_code ignored;
        const bool folder = entry.is_directory(ignored);
        if (path.filename().string().front() == '.') return leave_out(hidden, path);
        if (folder && belongs_to_tree(path)) return leave_out(tree, path);
        if (folder && entry.is_symlink(ignored)) return leave_out(link, path);  // it may lead around in a circle
        if (folder) return folders.push_back(path);
        const Format* const format = format_of_extension(extension_of(path));
        if (!format || !entry.is_regular_file(ignored)) return leave_out(other_format, path);
        if (format->has(common_extension) && !holds_points(path)) return leave_out(no_points, path);
        files.push_back(path);
    }

    static bool holds_points(const fs::path& path)
    {
        const auto& all = formats();
        try {
            return std::any_of(all.begin(), all.end(),
                               [&](const Format& format) { return format.looks_like && format.looks_like(path); });
        } catch (const Error&) {
            return true;  // opening it reports what is wrong
        }
    }

    const fs::path top_;
    const bool skip_unreadable_;
    std::vector<fs::path> files_;
    std::array<std::size_t, reasons> counts_{};
    std::array<std::vector<std::string>, reasons> names_;
};

}  // namespace

std::vector<fs::path> expand_inputs(const std::vector<fs::path>& inputs, std::vector<std::string>* notes,
                                    bool skip_unreadable)
{
    std::vector<fs::path> files;
    for (const fs::path& input : inputs) {
        if (is_url(input))
            throw Error(ErrorCode::unsupported, input, "files are not read from addresses; point cloud trees are",
                        "download the file, or build a tree of it where it is and put that on the server");
        std::error_code error;
        const fs::file_status status = fs::status(input, error);
        if (status.type() == fs::file_type::not_found)
            throw Error(ErrorCode::not_found, input, "no such file or folder");
        if (error) throw Error::from_errno(error.value(), input, "looking at it");
        refuse_tree(input, fs::is_directory(status));
        if (!fs::is_directory(status)) {
            files.push_back(input);
            continue;
        }
        FolderWalk folder(input, skip_unreadable);
        folder.walk(input);
        const std::string left_out = folder.left_out();
        if (folder.files().empty())
            throw Error(ErrorCode::not_found, input,
                        "the folder and its sub-folders hold no file with a readable extension" +
                            (left_out.empty() ? "" : "; left out: " + left_out),
                        readable_hint());
        if (notes && !left_out.empty()) notes->push_back(input.string() + ": left out of the folder: " + left_out);
        files.insert(files.end(), folder.files().begin(), folder.files().end());
    }
    return files;
}

}  // namespace pcm
