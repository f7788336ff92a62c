#include "pcm/cli/commands.h"

namespace pcm::cli {

// Each in the source of its name.
Run add_append(Options& options);
Run add_build(Options& options);
Run add_compact(Options& options);
Run add_convert(Options& options);
Run add_delete(Options& options);
Run add_generate(Options& options);
Run add_info(Options& options);
Run add_query(Options& options);
Run add_repair(Options& options);
Run add_set(Options& options);
Run add_transform(Options& options);
Run add_verify(Options& options);
void start_render(char** arguments);

const std::vector<Command>& commands()
{
    static const std::vector<Command> table = {
        {"build", "Build a point cloud tree from files", add_build},
        {"convert", "Write clouds of any format, or trees, as a file of another, or as a tree", add_convert},
        {"info", "Say what a point cloud tree, or cloud files of any format, hold", add_info},
        {"verify", "Check a tree: checksums, counts, boxes, and that every point is there once", add_verify},
        {"append", "Add files to a tree", add_append},
        {"compact", "Write a tree anew after appending and deleting: smaller, with even levels", add_compact},
        {"delete", "Delete points of a tree", add_delete},
        {"repair", "Make a tree's index anew from its chunks, without those that are damaged", add_repair},
        {"query", "Ask a tree: how many points are in a region, which are nearest to a point, what a ray meets first",
         add_query},
        {"set", "Set attributes of a tree's points, and add attributes; all at once or not at all", add_set},
        {"transform", "Move, turn or scale a tree, into a new one", add_transform},
        {"render", "Draw trees to PNG, from a camera or along a path, without a window", nullptr, start_render},
        {"generate", "Write a scan-like scene with exact ground truth as LAS or LAZ", add_generate},
    };
    return table;
}

}  // namespace pcm::cli
