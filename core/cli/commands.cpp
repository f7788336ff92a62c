#include "pcm/cli/commands.h"

#include "pcm/cli/operation_command.h"

namespace pcm::cli {

// Each in the source of its name.
Run add_align(Options& options);
Run add_append(Options& options);
Run add_build(Options& options);
Run add_compact(Options& options);
Run add_convert(Options& options);
Run add_delete(Options& options);
Run add_detect(Options& options);
Run add_fit(Options& options);
Run add_generate(Options& options);
Run add_info(Options& options);
Run add_measure(Options& options);
Run add_merge(Options& options);
Run add_pick(Options& options);
Run add_primitives(Options& options);
Run add_profile(Options& options);
Run add_query(Options& options);
Run add_repair(Options& options);
Run add_select(Options& options);
Run add_set(Options& options);
Run add_subsample(Options& options);
Run add_transform(Options& options);
Run add_verify(Options& options);
Run add_volume(Options& options);
Run add_voxel(Options& options);
void start_render(char** arguments);

const std::vector<Command>& commands()
{
    static const std::vector<Command> table = {
        {"build", "Build a point cloud tree from files", add_build},
        {"convert", "Convert files of any supported format, or trees, to a file of another format or to a tree",
         add_convert},
        {"info", "Show what a tree, or files of any supported format, contain", add_info},
        {"verify", "Check a tree: checksums, counts, boxes, and that every point is stored exactly once", add_verify},
        {"append", "Add the points of files to a tree", add_append},
        {"compact", "Rewrite a tree after appending and deleting: smaller, with evenly spaced levels", add_compact},
        {"delete", "Delete points of a tree", add_delete},
        {"repair", "Rebuild a tree's index from its chunks, without damaged chunks", add_repair},
        {"query", "Query a tree: points in a region, nearest neighbours, first hit of a ray", add_query},
        {"pick", "Pick the point that a view shows at a pixel, or that a ray meets, and list all its attributes",
         add_pick},
        {"select",
         "Select points of a tree by region, condition, brush or connectivity; count, save, extract, classify or "
         "delete them",
         add_select},
        {"fit",
         "Fit a plane, cylinder, sphere, cone or torus at a place of a tree, follow it through the cloud; export, "
         "extract or delete it",
         add_fit},
        {"set", "Set attributes of a tree's points, and add attributes, atomically", add_set},
        operation_command("radii"),
        operation_command("normals"),
        operation_command("outliers"),
        {"transform", "Translate, rotate or scale a tree into a new tree", add_transform},
        {"align", "Move a tree to another one by pairs of points, and report how well they agree", add_align},
        {"merge", "Merge trees into a new tree", add_merge},
        {"voxel", "Thin a cloud: one point for each voxel, the centroid of its points and of their attributes",
         add_voxel},
        {"subsample", "Thin a tree evenly, to a spacing or to a number of points", add_subsample},
        {"detect", "Detect the planes, cylinders and spheres of a tree, and label their points", add_detect},
        {"measure", "Measure at points: distance, height, angle, area, distance to a plane; lists of measures as files",
         add_measure},
        {"profile", "Profile of a tree along a line: the points in it, as CSV or DXF", add_profile},
        {"volume", "Volume between a tree's surface and a height, a plane or another tree: cut and fill", add_volume},
        {"primitives", "Show a list of primitives, or write it as DXF, as a script for AutoCAD, or as CSV",
         add_primitives},
        {"render", "Render trees to PNG, from a camera or along a camera path, without a window", nullptr,
         start_render},
        {"generate", "Generate a scan-like scene with exact ground truth, as LAS or LAZ", add_generate},
    };
    return table;
}

}  // namespace pcm::cli
