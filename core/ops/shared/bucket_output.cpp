#include "pcm/ops/shared/bucket_output.h"

#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/tree_folder.h"
#include "pcm/system/url.h"
#include "pcm/tree/tree.h"
#include "pcm/update/upload.h"

namespace pcm::ops {

namespace fs = std::filesystem;

namespace {

fs::path local_place(const std::string& address, const std::vector<std::string>& inputs)
{
    fs::path folder = fs::temp_directory_path();
    for (const std::string& input : inputs) {
        if (is_url(input)) continue;
        folder = tree_folder_of(fs::absolute(input));
        if (folder.filename().empty()) folder = folder.parent_path();
        folder = folder.parent_path();
        break;
    }
    return folder / (tree_folder_of(address).stem().string() + ".upload." + tree_extension);
}

}  // namespace

BucketOutput::BucketOutput(const std::string& output, const std::vector<std::string>& inputs, bool overwrite)
    : output_(output), place_(output), is_address_(is_url(output)), overwrite_(overwrite)
{
    if (!is_address_) return;
    if (is_point_file_name(tree_folder_of(output)))
        throw Error(ErrorCode::unsupported, output, "only trees are written to an address, not files",
                    "name the tree " + tree_folder_of(output).stem().string() + "." + tree_extension);
    refuse_upload(output, overwrite);
    place_ = local_place(output, inputs);
}

std::uint64_t BucketOutput::send(const fs::path& tree, const ProgressFunction& progress) const
{
    return upload_tree(tree, output_, overwrite_, progress);
}

void BucketOutput::send(const ProgressFunction& progress) const
{
    if (!is_address_) return;
    try {
        send(place_, progress);
    } catch (const Error& error) {
        throw Error(error.code(), {}, error.what(),
                    "the tree is complete in " + place_.string() + ": 'pcmlab convert " + place_.string() + " -o " +
                        output_ + "' sends it again");
    }
    fs::remove_all(place_);
}

}  // namespace pcm::ops
