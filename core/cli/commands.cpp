#include "pcm/cli/commands.h"

#include "pcm/cli/operation_command.h"

namespace pcm::cli {

// Each in the source of its name.
Run add_detect(Options& options);
Run add_fit(Options& options);
Run add_measure(Options& options);
Run add_pick(Options& options);
Run add_primitives(Options& options);
Run add_profile(Options& options);
Run add_query(Options& options);
Run add_select(Options& options);
Run add_set(Options& options);
Run add_volume(Options& options);
void start_render(char** arguments);

const std::vector<Command>& commands()
{
    static const std::vector<Command> table = {
        operation_command("build"),
        operation_command("convert"),
        operation_command("info"),
        operation_command("verify"),
        operation_command("append"),
        operation_command("compact"),
        operation_command("delete"),
        operation_command("repair"),
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
        operation_command("transform"),
        operation_command("align"),
        operation_command("merge"),
        operation_command("voxel"),
        operation_command("subsample"),
        {"detect", "Detect the planes, cylinders and spheres of a tree, and label their points", add_detect},
        {"measure", "Measure at points: distance, height, angle, area, distance to a plane; lists of measures as files",
         add_measure},
        {"profile", "Profile of a tree along a line: the points in it, as CSV or DXF", add_profile},
        {"volume", "Volume between a tree's surface and a height, a plane or another tree: cut and fill", add_volume},
        {"primitives", "Show a list of primitives, or write it as DXF, as a script for AutoCAD, or as CSV",
         add_primitives},
        {"render", "Render trees to PNG, from a camera or along a camera path, without a window", nullptr,
         start_render},
        operation_command("generate"),
    };
    return table;
}

}  // namespace pcm::cli
