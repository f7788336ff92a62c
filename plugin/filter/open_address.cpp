// Open Point Cloud Tree by Address: a layer of a tree on a server.
#include "pcm/ops/operation.h"
#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"
#include "pcm/system/url.h"
#include "plugin/filter/filter.h"

namespace pcm::host {

namespace {

void add_parameters(Parameters& parameters)
{
    parameters.add(
        {"Address", QString(), "Address",
         "The address of a point cloud tree: https://, http:// or s3://, a server, and the path of the "
         "folder with its index.pct, such as https://example.org/scans/site.pct. Keys for buckets come from "
         "the usual settings (AWS_ACCESS_KEY_ID, ~/.aws/credentials) and are never part of it. No default."});
}

void run(const FilterRun& run)
{
    const std::string address = run.parameters.text("Address").trimmed().toStdString();
    if (address.empty())
        throw Error(ErrorCode::invalid_argument, {}, "no address was given",
                    "give that of a tree, such as https://example.org/scans/site.pct");
    Url::parse(address);
    std::vector<std::string> lines;
    if (!run.scene.add_tree(tree_folder_of(address), nullptr, lines))
        throw Error(ErrorCode::invalid_argument, address, "the tree has no points");
    for (const std::string& line : lines) run.log(line);
    run.log("MeshLab does not open addresses that a project names: open this one again after opening the project.");
}

}  // namespace

Filter open_address()
{
    return {"Open Point Cloud Tree by Address",
            "Opens a <b>point cloud tree on a server</b> in a new layer, without downloading it: what the view needs "
            "is read while it is looked at, coarse points first, and kept on this machine for the next time. The "
            "server must send ranges of files, as web servers and object storage do. Nothing is written to it.",
            ops::menu::points | ops::menu::layers, add_parameters, run};
}

}  // namespace pcm::host
