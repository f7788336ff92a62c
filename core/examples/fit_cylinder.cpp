// The cylinder at a place of a tree, followed through the whole cloud, as a drawing:
//   fit_cylinder plant.pct 500042.95 4800020 96 tank.dxf
#include "pcm/cad/primitive_files.h"
#include "pcm/place/fit_at.h"

#include <cstdio>
#include <string>

int main(int argc, char** argv)
try {
    if (argc != 6) return std::fprintf(stderr, "usage: fit_cylinder TREE X Y Z DRAWING.dxf\n"), 2;
    const pcm::Vec3d place{std::stod(argv[2]), std::stod(argv[3]), std::stod(argv[4])};

    auto cloud = pcm::PointCloud::open(argv[1]);
    pcm::FitAtOptions options;
    options.fit.kind = pcm::ShapeKind::cylinder;
    pcm::FittedPrimitive found = pcm::fit_at(*cloud, {place}, {}, options);
    const pcm::ShapeFit& fit = found.primitive.fit;
    if (!fit.has_shape()) return std::fprintf(stderr, "no cylinder: %s\n", fit.message.c_str()), 1;
    if (fit.verdict == pcm::FitVerdict::doubtful) std::printf("doubtful: %s\n", fit.message.c_str());
    found.primitive.name = "Cylinder";
    pcm::write_primitives(argv[5], {found.primitive});
    std::printf("radius %.4f +- %.2g, %zu points\n", fit.shape.radius, fit.errors.radius,
                std::size_t(found.points.size()));
} catch (const std::exception& error) {
    return std::fprintf(stderr, "fit_cylinder: %s\n", error.what()), 1;
}
