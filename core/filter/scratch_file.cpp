#include "pcm/filter/scratch_file.h"

#include "pcm/system/part_file.h"
#include "pcm/system/tree_folder.h"

#include <system_error>

namespace pcm {

File scratch_file(const std::filesystem::path& folder)
{
    const auto path = folder / update_scratch_name;
    File file = File::without_name(path);
    if (file.is_open()) return file;
    std::error_code ignored;
    if (!is_tree_folder(folder)) {  // the folder for temporary files: others' may have any name
        const auto part = new_part_name(folder / "pcm-values");
        file = File(part, File::Mode::create_new);
        std::filesystem::remove(part, ignored);
        return file;
    }
    // In a folder that the next update removes.
    std::filesystem::create_directory(path);
    file = File(path / "values", File::Mode::create_or_truncate);
    std::filesystem::remove_all(path, ignored);
    return file;
}

}  // namespace pcm
